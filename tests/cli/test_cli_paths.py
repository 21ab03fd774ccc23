# SPDX-License-Identifier: Apache-2.0
"""Arguments of the check: systems, single files, folders, and paths that are none of these."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest
from command import Command

import clock
from fixture import split_files

PACKAGE_XML = "<package format='3'><name>robot</name></package>"
FOREIGN = {
    "package.xml": PACKAGE_XML,
    "robot.urdf.xml": "<robot name='r'><link name='l'/></robot>",
    "start.launch.xml": "<launch><node pkg='a' exec='b'/></launch>",
    "page.xml": "<html><body>",
    "broken.xml": "<a><b",
    "empty.xml": "",
    "data.json": '{"a": [1, 2',
    "settings.json": "{}",
    "noise.xml": "\0\1\2",
}


def test_a_system_is_checked_with_its_files_and_nothing_else(check: Command, command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "other.ascxml").write_text(clock.WRONG_CLOCK)
    assert check("main.xml").rows == []
    assert command("--check", "main.xml").out == "3 files checked: no diagnostics\n"
    assert check(".").found == [("other.ascxml", 9, "undeclared-variable")]


def test_files_of_other_tools_are_passed_over_in_folders(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    for name, text in FOREIGN.items():
        (tmp_path / name).write_text(text)
    assert command("--check", ".") == (0, "3 files checked: no diagnostics\n", "")


@pytest.mark.parametrize("name", sorted(name for name in FOREIGN if name.endswith(".xml")))
def test_files_of_other_tools_are_an_error_when_named(check: Command, tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(FOREIGN[name])
    done = check(name)
    assert done.status == 1
    assert set(done.codes) <= {"unknown-document", "xml-syntax"}


def test_other_json_is_an_error_when_named(check: Command, tmp_path: Path) -> None:
    for name in ("data.json", "settings.json"):
        (tmp_path / name).write_text(FOREIGN[name])
        assert check(name).status == 1, name


def test_a_single_file_is_checked_in_the_systems_around_it(check: Command, tmp_path: Path) -> None:
    """The system is searched for in the enclosing repository, wherever its file is."""
    unheard = {"clock": clock.UNHEARD_CLOCK}
    (tmp_path / "repository" / ".git").mkdir(parents=True)
    models = tmp_path / "repository" / "models"
    clock.write(models / "nodes", **unheard)
    (models / "nodes" / "main.xml").unlink()
    (tmp_path / "repository" / "systems").mkdir()
    text = clock.MAIN.replace('src="', 'src="../models/nodes/')
    (tmp_path / "repository" / "systems" / "main.xml").write_text(text)
    assert check(models / "nodes" / "clock.ascxml").codes == ["topic-without-subscriber"]
    assert check(models / "nodes").rows == [], "a folder holds its own systems only"


def test_without_a_repository_its_folder_is_looked_into(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path / "a", clock=clock.UNHEARD_CLOCK)
    assert check("a/clock.ascxml").codes == ["topic-without-subscriber"]


def test_only_findings_in_named_files_are_reported(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    assert check("properties.jani").rows == []
    assert check("clock.ascxml").codes == ["undeclared-variable"]


def test_files_named_twice_are_reported_once(check: Command, command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    once = check("clock.ascxml")
    for paths in (
        ["clock.ascxml", "clock.ascxml"],
        ["clock.ascxml", "./clock.ascxml", tmp_path / "clock.ascxml"],
        ["main.xml", "clock.ascxml", "main.xml", "."],
        [".", "clock.ascxml"],
        [".", tmp_path, "./"],
    ):
        assert check(*paths).rows == once.rows, paths
    assert command("--check", "main.xml", ".", "main.xml").out.endswith("\n3 files checked: 1 error\n")


def test_a_file_of_several_systems_is_reported_once(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    (tmp_path / "second.xml").write_text(clock.MAIN)
    assert check(".").codes == ["undeclared-variable"]
    assert check("main.xml", "second.xml").codes == ["undeclared-variable"]


def test_the_order_is_that_of_the_command_line(check: Command, tmp_path: Path) -> None:
    for name in ("b", "a", "c"):
        (tmp_path / f"{name}.ascxml").write_text(clock.WRONG_CLOCK)
    named = [row["file"] for row in check("b.ascxml", "c.ascxml", "a.ascxml").rows]
    assert named == ["b.ascxml", "c.ascxml", "a.ascxml"]
    assert [row["file"] for row in check(".").rows] == ["a.ascxml", "b.ascxml", "c.ascxml"]


@pytest.mark.parametrize("name", ["with space", "ünï-字-🤖", "100%", "a,b;c", "'q\"", "-x", "#h?x", "{b}[1]*"])
def test_names_of_any_kind(check: Command, tmp_path: Path, name: str) -> None:
    clock.write(tmp_path / name, clock=clock.WRONG_CLOCK)
    (tmp_path / name / "main.xml").rename(tmp_path / name / f"{name}.xml")
    for path in (tmp_path / name / f"{name}.xml", f"./{name}", f"./{name}/clock.ascxml"):
        assert check(path).found == [(os.path.join(name, "clock.ascxml"), 9, "undeclared-variable")]


def test_inputs_with_names_of_any_kind(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    (tmp_path / "clock.ascxml").rename(tmp_path / "ü & <字>.ascxml")
    text = clock.MAIN.replace("clock.ascxml", "ü &amp; &lt;&#23383;&gt;.ascxml")
    (tmp_path / "main.xml").write_text(text)
    assert check("main.xml").found == [("ü & <字>.ascxml", 9, "undeclared-variable")]


# ------------------------------------------------- what is no regular file


def test_devices_and_pipes_are_never_opened(check: Command, command: Command, tmp_path: Path) -> None:
    """Opening a pipe would wait for ever."""
    clock.write(tmp_path)
    for name in ("pipe.xml", "pipe.ascxml", "pipe.jani", "pipe.msg"):
        os.mkfifo(tmp_path / name)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(os.path.relpath(tmp_path / "socket.xml"))
        assert command("--check", ".").out == "3 files checked: no diagnostics\n"
        for name in ("pipe.xml", "pipe.ascxml", "socket.xml", "/dev/null"):
            done = check(name)
            assert done.status == 2
            assert done.err.endswith(": it is not a regular file\n")
            (tmp_path / "main.xml").write_text(clock.MAIN.replace("clock.ascxml", name))
            assert ("main.xml", 6, "missing-file") in check("main.xml").found


def test_an_empty_folder_is_clean(command: Command, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert command("--check", "empty") == (0, "0 files checked: no diagnostics\n", "")


@pytest.mark.parametrize("name", ["missing", "main.xml/x", "x" * 300, "loop"])
def test_missing_files(check: Command, tmp_path: Path, name: str) -> None:
    clock.write(tmp_path)
    (tmp_path / "loop").symlink_to("loop")
    done = check("main.xml", name)
    assert (done.status, done.out) == (2, "")
    assert done.err.endswith("there is no such file or folder\n")


def test_unreadable_files(check: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock.write(tmp_path)

    opened = os.open

    def locked(path: str, *arguments: int, **options: int) -> int:
        if str(path).endswith("clock.ascxml"):
            raise PermissionError(13, "Permission denied")
        return opened(path, *arguments, **options)

    monkeypatch.setattr(os, "open", locked)
    done = check("clock.ascxml")
    assert (done.status, done.err) == (2, f"as2fm-lsp: {tmp_path / 'clock.ascxml'}: it cannot be read\n")
    done = check("main.xml")
    assert done.found[0] == ("main.xml", 6, "missing-file")
    assert done.status == 1


def test_links_are_followed_once(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path / "real", clock=clock.WRONG_CLOCK)
    (tmp_path / "real" / "up").symlink_to("..")
    (tmp_path / "real" / "dangling.ascxml").symlink_to("nowhere")
    (tmp_path / "linked").symlink_to("real")
    assert check(".").codes == ["undeclared-variable"]
    assert check("linked").found == [("linked/clock.ascxml", 9, "undeclared-variable")]


# -------------------------------------------------------------- src, include


@pytest.mark.parametrize(
    ("src", "code"),
    [
        ("missing.ascxml", "missing-file"),
        ("folder", "missing-file"),
        (".", "missing-file"),
        ("/dev/zero", "missing-file"),
        ("/dev/stdin", "missing-file"),
        ("pipe", "missing-file"),
        ("../outside/secret", "wrong-file-kind"),
        ("../outside/properties.jani", "wrong-file-kind"),
        ("a&#0;b", "missing-file"),
        ("file:///etc/hostname", "missing-file"),
        ("http://localhost:1/x.ascxml", "missing-file"),
        ("main.xml", "wrong-file-kind"),
        ("x" * 5000, "missing-file"),
    ],
)
def test_src_may_point_anywhere(check: Command, tmp_path: Path, src: str, code: str) -> None:
    (tmp_path / "outside").mkdir()
    (tmp_path / "outside" / "secret").write_text("password: <hunter2>")
    clock.write(tmp_path / "outside")
    clock.write(tmp_path / "system", main=clock.MAIN.replace("clock.ascxml", src))
    (tmp_path / "system" / "folder").mkdir()
    os.mkfifo(tmp_path / "system" / "pipe")
    done = check("system/main.xml")
    assert done.status == 1
    assert ("system/main.xml", 6, code) in done.found
    assert "hunter2" not in done.out, "what is none of our files is not shown"


def test_an_empty_src(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, main=clock.MAIN.replace("clock.ascxml", ""))
    done = check("main.xml")
    assert done.status == 1
    assert {row["file"] for row in done.rows} == {"main.xml"}


def test_a_machine_outside_of_the_folder_is_part_of_its_system(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path / "shared", clock=clock.WRONG_CLOCK)
    clock.write(tmp_path / "system", main=clock.MAIN.replace("clock.ascxml", "../shared/clock.ascxml"))
    for named in ("system", "system/main.xml"):
        assert ("shared/clock.ascxml", 9, "undeclared-variable") in check(named).found


TREES = """\
-- a.xml --
<root BTCPP_format="4" main_tree_to_execute="A">
    <include path="b.xml" />
    <BehaviorTree ID="A"><SubTree ID="B" /></BehaviorTree>
</root>
-- b.xml --
<root BTCPP_format="4">
    <include path="a.xml" />
    <BehaviorTree ID="B"><AlwaysSuccess /></BehaviorTree>
</root>
-- self.xml --
<root BTCPP_format="4">
    <include path="self.xml" />
    <BehaviorTree ID="C"><AlwaysSuccess /></BehaviorTree>
</root>
"""


def test_cyclic_includes(check: Command, tmp_path: Path) -> None:
    for name, text in split_files(TREES).items():
        (tmp_path / name).write_text(text)
    done = check("a.xml", "b.xml", "self.xml")
    cycles = [(row["file"], row["line"], row["message"].partition(": ")[2]) for row in done.rows]
    assert ("a.xml", 2, "it includes this file itself") in cycles
    assert ("b.xml", 2, "it includes this file itself") in cycles
    assert ("self.xml", 2, "it is this file") in cycles


def test_a_tree_that_is_included_twice_is_there_once(check: Command, tmp_path: Path) -> None:
    files = split_files(TREES)
    (tmp_path / "a.xml").write_text(files["a.xml"].replace("<include", '<include path="b.xml" />\n<include'))
    (tmp_path / "b.xml").write_text(files["b.xml"].replace('<include path="a.xml" />', ""))
    assert check("a.xml").rows == []


# ---------------------------------------------------------------- ROS types

TYPED = """\
-- machine.ascxml --
<ascxml name="M" version="1.0" initial="s">
    <ros_topic_publisher name="p" topic="/t" type="my_robot_msgs/Speed" />
    <ros_time_rate name="r" rate_hz="1" />
    <state id="s">
        <ros_rate_callback name="r" target="s">
            <ros_topic_publish name="p"><field name="value" expr="1.0" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
-- there/my_robot_msgs/msg/Speed.msg --
float64 value
"""


def test_ros_path(check: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, text in split_files(TYPED).items():
        path = tmp_path / ("inside" if name.endswith("ascxml") else ".") / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (tmp_path / "inside" / ".git").mkdir()
    done = check("inside")
    assert done.codes == ["unknown-ros-type"]
    assert str(tmp_path / "inside") in done.rows[0]["message"], "it says where it has looked"
    assert check("inside", "--ros-path", "there").rows == []
    assert check("inside", "--ros-path", "nowhere", "--ros-path", "there").rows == []
    assert (
        "nowhere` (the folder does not exist) from `--ros-path`"
        in check("inside", "--ros-path", "nowhere").rows[0]["message"]
    )
    assert check(".").rows == [], "the workspace itself is looked into"
    share = tmp_path / "install" / "share"
    share.mkdir(parents=True)
    (tmp_path / "there" / "my_robot_msgs").rename(share / "my_robot_msgs")
    assert check("inside").codes == ["unknown-ros-type"]
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.pathsep.join(["", str(tmp_path / "install"), "/nowhere"]))
    assert check("inside").rows == []


# ------------------------------------------------------------------ large files


def test_a_large_file_has_one_clear_diagnostic(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    padding = "<!-- " + "x" * 2_100_000 + " -->\n"
    (tmp_path / "clock.ascxml").write_text(clock.WRONG_CLOCK + padding)
    done = check("clock.ascxml")
    assert done.found == [("clock.ascxml", 1, "file-too-large")]
    assert "the limit is 2,000,000" in done.rows[0]["message"]
    done = check("main.xml", "--severity", "warning")
    assert done.found == [
        ("main.xml", 6, "missing-file"),
        ("clock.ascxml", 1, "file-too-large"),
    ], "what depends on it is not told"
    with (tmp_path / "clock.ascxml").open("wb") as file:
        file.truncate(40 * 1024 * 1024)
    done = check("clock.ascxml")
    assert (done.status, done.err.endswith("it is larger than 32 MB\n")) == (2, True)
