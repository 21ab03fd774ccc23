# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp compare`: versions from folders and from git, formats, and the exit status."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml.figures.svg import CHANGE_STYLES
from roaml.figures.themes import style_sheet

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two versions of the assembly robot: `new` loses the block less often, and tries five times."""
    for name in ("old", "new"):
        shutil.copytree(EXAMPLES / "assembly_robot", tmp_path / name)
    change(tmp_path / "new/arm.ascxml", 'prob="0.5"', 'prob="0.7"')
    change(tmp_path / "new/arm.ascxml", 'rate_hz="1"', 'rate_hz="2"')
    change(tmp_path / "new/tree.xml", 'num_attempts="20"', 'num_attempts="5"')
    monkeypatch.chdir(tmp_path)
    return tmp_path


def change(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def called(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    capsys.readouterr()
    status = run(["compare", *arguments])
    printed = capsys.readouterr()
    return status, printed.out, printed.err


def test_a_change(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status, text, _ = called(capsys, "old/main.xml", "new/main.xml", "--property", "block_dropped")
    assert status == 1
    for line in (
        "~ node `RetryUntilSuccessful`: − num_attempts = 20; + num_attempts = 5",
        "− transition `moving` → `moving` by chance: 0.5 / way := 2",
        '~ `ros_time_rate step` in `arm.ascxml`: `<ros_time_rate name="step" rate_hz="1">` → '
        '`<ros_time_rate name="step" rate_hz="2">`',
        "~ `tree.xml`",
    ):
        assert f"  {line}\n" in text
    assert "block_dropped  0.5  0.3  −0.2        changed  –" in text
    assert "main.xml`" not in text, "an unchanged file is not listed"


def test_formats(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Markdown links the pictures, HTML contains them, JSON contains all numbers."""
    asked = ("old/main.xml", "new/main.xml", "--property=block_dropped")
    (robot / "out").mkdir()
    status, _, _ = called(capsys, *asked, "--format=markdown", "--output=out/change.md", "--pictures=out/pictures")
    assert status == 1
    markdown = (robot / "out/change.md").read_text(encoding="utf-8")
    assert "| `block_dropped` | 0.5 | 0.3 | −0.2 | **changed** | – |" in markdown
    assert "![state machine Arm: 1 added, 1 removed](pictures/Arm.svg)" in markdown
    root = ET.parse(robot / "out/pictures/Arm.svg").getroot()
    assert "@media (prefers-color-scheme: dark)" in "".join(root.itertext())
    texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert "− 0.5" in texts
    assert "+ 0.7" in texts
    _, html, _ = called(capsys, *asked, "--format=html")
    assert html.count("<svg") == 2
    after = html.rpartition("</svg>")[2]  # rules of the same weight hold if they are the last ones
    rules = style_sheet("high-contrast", CHANGE_STYLES)
    assert f"@media (prefers-contrast: more) and (prefers-color-scheme: dark) {{\n{rules}" in after
    assert "<tr class='changed'><td>block_dropped</td>" in html
    assert "<th>expected</th>" not in html, "there is no expectation"
    assert "<code>arm.ascxml</code>" in html
    assert "`" not in re.sub("<svg.*?</svg>", "", html, flags=re.DOTALL)
    report = json.loads(called(capsys, *asked, "--format=json")[1])
    (value,) = report["properties"]
    assert (value["result"], value["difference"]) == ("changed", pytest.approx(-0.2))
    assert [picture["title"] for picture in report["pictures"]] == ["behavior tree", "state machine Arm"]


def test_uniform_choices_have_no_unknown_minimum(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The report says that the minimum is not known only if it was asked for."""
    asked = ("old/main.xml", "new/main.xml", "--property=block_dropped", "--method=fixed", "--max-traces=50")
    unknown = "(the minimum and maximum over all schedulers are undecided)"
    text = called(capsys, *asked)[1]
    assert f"estimates from traces with uniform choices {unknown}: the intervals" in text
    text = called(capsys, *asked, "--scheduler=uniform")[1]
    assert "estimates from traces with uniform choices: the intervals" in text


def test_the_same(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Comments and layout are not differences."""
    change(robot / "old/arm.ascxml", "<datamodel>", "<!-- what it knows -->\n\n    <datamodel>")
    shutil.copytree(robot / "old", robot / "copy")
    change(robot / "copy/arm.ascxml", "<!-- what it knows -->", "<!-- its memory -->")
    status, text, _ = called(capsys, "old/main.xml", "copy/main.xml", "--property=block_dropped", "--fail-on=any")
    assert "the structure is the same" in text
    assert "block_dropped  0.5  0.5  0           same    –" in text
    assert status == 0


def test_models_without_a_structure_are_not_called_the_same(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The structure of JANI models is not compared."""
    for version in ("old", "new"):
        assert run(["translate", f"{version}/main.xml", "-o", f"{version}.jani"]) == 0
    capsys.readouterr()
    for format_ in ("text", "markdown", "html"):
        text = called(capsys, "old.jani", "new.jani", "--property=block_dropped", f"--format={format_}")[1]
        assert "structure was not compared" in text
        assert "structure is the same" not in text
    text = called(capsys, "old.jani", "new.jani", "--property=block_dropped", "--format=json")[1]
    assert json.loads(text)["structure_compared"] is False


@pytest.mark.parametrize(
    ("expected", "fail_on", "status"),
    [(">= 0.4", "expectation", 1), (">= 0.2", "expectation", 0), (">= 0.2", "value", 1), (">= 0.6", "expectation", 0)],
)
def test_exit_status(robot: Path, capsys: pytest.CaptureFixture[str], expected: str, fail_on: str, status: int) -> None:
    """An expectation that the old version missed, too, is not a regression."""
    for folder in ("old", "new"):
        (robot / folder / "as2fm.toml").write_text(f'[verify.expect]\nblock_dropped = "{expected}"\n', encoding="utf-8")
    asked = ("old/main.xml", "new/main.xml", "--property=block_dropped", f"--fail-on={fail_on}")
    found, text, _ = called(capsys, *asked)
    assert found == status
    assert ("expectation missed" in text) is (expected == ">= 0.4")
    assert ("met → NOT MET" in text) is (expected == ">= 0.4")


def git(folder: Path, *arguments: str) -> None:
    own = ["-c", "user.name=x", "-c", "user.email=x@example.org", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", *own, *arguments], cwd=folder, check=True, capture_output=True)


def test_revisions(robot: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """`REVISION:PATH` is a file with all files beside it, as they were; the working tree and the index stay as they
    are."""
    git(robot, "init", "-q")
    git(robot, "add", "old")
    git(robot, "commit", "-q", "-m", "the robot")
    change(robot / "old/arm.ascxml", 'prob="0.5"', 'prob="0.7"')
    (robot / "old/note.txt").write_text("staged", encoding="utf-8")
    git(robot, "add", "old/note.txt")
    before = subprocess.run(["git", "status", "--porcelain"], cwd=robot, check=True, capture_output=True).stdout
    asked = ("--property=block_dropped",)
    status, text, _ = called(capsys, "HEAD:old/main.xml", *asked)
    assert status == 1
    assert text.startswith("HEAD:old/main.xml → old/main.xml\n")
    assert "block_dropped  0.5  0.3  −0.2" in text
    monkeypatch.chdir(robot / "old")
    for name in ("HEAD:./main.xml", "HEAD:main.xml", "HEAD:old/main.xml"):
        assert "block_dropped  0.5  0.3  −0.2" in called(capsys, name, "main.xml", *asked)[1]
    assert called(capsys, "HEAD:./main.xml", "HEAD:./main.xml", "--structure", "--fail-on=any")[0] == 0
    assert before == subprocess.run(["git", "status", "--porcelain"], cwd=robot, check=True, capture_output=True).stdout


def test_errors(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    git(robot, "init", "-q")
    git(robot, "add", "old")
    git(robot, "commit", "-q", "-m", "the robot")
    assert called(capsys, "old/main.xml")[2].endswith("name the new version, too: as2fm-lsp compare old/main.xml NEW\n")
    assert "git knows no revision `HEAT`" in called(capsys, "HEAT:old/main.xml", "old/main.xml")[2]
    assert "the revision `HEAD` has no file `new/main.xml`" in called(capsys, "HEAD:new/main.xml", "old/main.xml")[2]
    asked = ("HEAD:old/main.xml", "new/main.xml", "--property=none")
    status, _, error = called(capsys, *asked)
    assert status == 2
    assert "no property `none`" in error
    change(robot / "old/arm.ascxml", 'target="moving"', 'target="moved"')
    git(robot, "commit", "-a", "-q", "-m", "a mistake")
    assert called(capsys, "new/main.xml", "HEAD:old/main.xml", "--property=block_dropped")[0] == 1


@pytest.mark.parametrize(
    ("expected", "fail_on", "status"),
    [(">= 0.2", "value", 0), (">= 0.4", "expectation", 1), (">= 0.2", "any", 1)],
)
def test_a_repair(robot: Path, capsys: pytest.CaptureFixture[str], expected: str, fail_on: str, status: int) -> None:
    """A version that repairs errors fails only by what is asked of itself."""
    change(robot / "old/arm.ascxml", 'target="moving"', 'target="moved"')
    (robot / "new/as2fm.toml").write_text(f'[verify.expect]\nblock_dropped = "{expected}"\n', encoding="utf-8")
    asked = ("--property=block_dropped", f"--fail-on={fail_on}")
    found, text, error = called(capsys, "old/main.xml", "new/main.xml", *asked)
    assert found == status
    assert "old/arm.ascxml:" in error
    assert "`old/main.xml` has no values: it has errors" in text
    assert "block_dropped  unknown  0.3  –           no value before" in text


def test_mocked_trees(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A retry raises the probability of success from p to 1 - (1 - p)³."""
    mocks = ("--mock", "A: 0.9", "--mock", "B: 0.5")
    trees = {
        "one": "<Sequence><A/><B/></Sequence>",
        "two": '<Sequence><A/><RetryUntilSuccessful num_attempts="3"><B/></RetryUntilSuccessful></Sequence>',
    }
    for name, content in trees.items():
        text = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{content}</BehaviorTree></root>'
        (robot / f"{name}.xml").write_text(text, encoding="utf-8")
    status, text, _ = called(capsys, "one.xml", "two.xml", *mocks, "--format=json")
    assert status == 1
    report = json.loads(text)
    succeeds = next(value for value in report["properties"] if value["name"] == "succeeds")
    assert succeeds["difference"] == pytest.approx(0.9 * (1 - 0.5**3) - 0.45, abs=1e-9)
    (picture,) = report["pictures"]
    assert picture["changes"] == [{"change": "added", "text": "node `RetryUntilSuccessful`"}]
