# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp draw`: what is drawn, where it is written, and what is said when there is nothing to draw."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from lxml import etree

from as2fm_lsp.cli.main import run

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(EXAMPLES / "assembly_robot", tmp_path / "robot")
    monkeypatch.chdir(tmp_path)
    return tmp_path / "robot"


def texts(svg: str) -> str:
    """The texts of an SVG file, which is well-formed."""
    root = etree.fromstring(svg.encode())
    return " ".join(element.text or "" for element in root.iter("{http://www.w3.org/2000/svg}text"))


def drawn(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert run(["draw", *arguments, "-o", "-"]) == 0
    return capsys.readouterr().out


def test_kinds(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file is drawn as what it contains; options choose another part of its system."""
    arm = drawn(capsys, "robot/arm.ascxml")
    assert "still /arm/command 1. [_msg.data == 1] / holding := true" in texts(arm)
    assert "RetryUntilSuccessful 1001" in texts(drawn(capsys, "robot/tree.xml"))
    graph = drawn(capsys, "robot/main.xml")
    assert "/arm/command std_msgs/UInt8" in texts(graph)
    assert drawn(capsys, "robot/main.xml", "--graph") == graph
    assert drawn(capsys, "robot/main.xml", "--machine", "Arm") == arm
    assert "num_attempts = 20" in texts(drawn(capsys, "robot/main.xml", "--tree"))


def test_a_part_of_the_ros_graph(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    part = texts(drawn(capsys, "robot/main.xml", "--around", "/block/placed"))
    assert "/block/placed" in part
    assert "/arm/command" not in part
    assert "/arm/command" in texts(drawn(capsys, "robot/main.xml", "--around", "Arm"))
    assert drawn(capsys, "robot/main.xml", "--matching", "topic block/PLACED") == drawn(
        capsys, "robot/main.xml", "--around", "/block/placed"
    )


def test_files(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["draw", "robot/main.xml"]) == 0
    assert capsys.readouterr().out.startswith("robot/main.ros.svg: ")
    assert (robot / "main.ros.svg").read_text(encoding="utf-8") == drawn(capsys, "robot/main.xml")
    assert run(["draw", "robot/main.xml", "--machine", "Arm", "-o", "arm.svg"]) == 0
    assert Path("arm.svg").is_file()


def test_themes_and_directions(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Files contain the colors themselves, different ones in each theme, and the same drawing."""
    themes = ("light", "dark", "high-contrast", "high-contrast-light")
    files = [drawn(capsys, "robot/arm.ascxml", "--theme", theme) for theme in themes]
    assert len(set(files)) == len(files)
    assert not any("var(" in file for file in files)
    assert len({file.partition('<g class="scene">')[2] for file in files}) == 1
    sizes = [
        etree.fromstring(drawn(capsys, "robot/arm.ascxml", "--direction", way).encode()) for way in ("down", "right")
    ]
    down, right = (float(root.get("width", 0)) / float(root.get("height", 1)) for root in sizes)
    assert down < 1 < right


def test_an_outline_is_for_trees(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    whole, outline = (drawn(capsys, "robot/main.xml", "--tree", *form) for form in ((), ("--outline",)))
    assert whole.count('class="node ') == outline.count('class="node ') > 1
    assert outline != whole
    rows = [float(y) for y in re.findall(r'class="title strong" x="[^"]*" y="([^"]*)"', outline)]
    assert rows == sorted(set(rows))
    assert run(["draw", "robot/arm.ascxml", "--outline"]) == 2
    assert "only behavior trees can be drawn as an outline; draw the tree of the system" in capsys.readouterr().err


def test_broken_models_are_drawn(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arm = robot / "arm.ascxml"
    text = arm.read_text(encoding="utf-8")
    arm.write_text(text[: text.index('<state id="moving"') + 30], encoding="utf-8")
    assert "still" in texts(drawn(capsys, "robot/arm.ascxml"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("robot/main.xml", "--machine", "Arn"),
            "robot/main.xml: there is no state machine `Arn`; did you mean `Arm`?",
        ),
        (
            ("robot/main.xml", "--around", "Arn"),
            "robot/main.xml: the ROS graph contains no `Arn`; did you mean `Arm`?",
        ),
        (("robot/main.xml", "--matching", "zzz"), "robot/main.xml: nothing in the ROS graph matches `zzz`"),
        (("robot/main.xml", "--tree", "--around", "Arm"), "only a part of a ROS graph can be drawn"),
        (("robot/arm.ascxml", "--tree"), ""),
        (("robot/properties.jani",), "robot/properties.jani: the file is not a system; name the system file"),
        (("robot/none.xml",), "robot/none.xml: "),
        (("robot/main.xml", "-o", "no/folder/a.svg"), "no/folder/a.svg: No such file or directory"),
        (("robot/main.xml", "--tree", "--graph"), "not allowed with argument"),
    ],
)
def test_nothing_to_draw(
    robot: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], message: str
) -> None:
    alone = robot / "arm.ascxml"
    for file in robot.rglob("*.xml") if arguments[0] == "robot/arm.ascxml" else ():
        file.unlink()
    assert alone.exists()
    assert run(["draw", *arguments]) == 2
    assert (message or "the file contains no behavior tree") in capsys.readouterr().err


def test_mocks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(EXAMPLES / "fetch_tree", tmp_path / "fetch_tree")
    path = str(tmp_path / "fetch_tree" / "fetch.xml")
    assert "mock: 0.9 in 8 s" in texts(drawn(capsys, path)), "the file beside the tree"
    given = texts(drawn(capsys, path, "--mock", "*: 0.5 in 3 s"))
    assert given.count("mock: 0.5 in 3 s") == 5
    assert "in 8 s" not in given
    other = tmp_path / "other.mocks"
    other.write_text("CloseGripper: 0.25\n", encoding="utf-8")
    listed = texts(drawn(capsys, path, "--mocks", str(other)))
    assert (listed.count("mock:"), listed.count("mock: 0.25")) == (1, 1)


def test_mocks_that_cannot_be_drawn(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, message in (
        (("robot/main.xml", "--mock", "*: 0.5"), "draw the tree of the system"),
        (("robot/tree.xml", "--mock", "0.5"), "is not a mock"),
        (("robot/tree.xml", "--mocks", "none.mocks"), "none.mocks"),
    ):
        assert run(["draw", *arguments, "-o", "-"]) == 2
        assert message in capsys.readouterr().err


def test_the_page_shows_what_is_printed(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = (EXAMPLES.parent / "docs/pictures.md").read_text(encoding="utf-8")
    ((command, shown),) = re.findall(r"^\$ as2fm-lsp (.*)\n(.*\n)```$", page, re.MULTILINE)
    Path("examples").mkdir()
    robot.rename("examples/assembly_robot")
    assert run(command.split()) == 0
    assert shown in "".join(capsys.readouterr())
