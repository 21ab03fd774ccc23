# SPDX-License-Identifier: Apache-2.0
"""The search for definition files, in all common layouts of workspaces."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from roaml.interfaces import SearchPath
from roaml.interfaces import search as search_module
from roaml.interfaces.search import MAX_DEPTH

Write = Callable[..., None]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes empty files below `tmp_path`; a file is given by its path with slashes."""

    def write(*files: str) -> None:
        for file in files:
            path = tmp_path / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text("")

    return write


def test_layouts_of_a_ros_path(tmp_path: Path, write: Write) -> None:
    write("d/my_msgs/msg/A.msg", "d/my_msgs/srv/B.srv", "d/my_msgs/action/C.action")
    package = tmp_path / "d" / "my_msgs"
    for folder in (package, package.parent, tmp_path):
        search = SearchPath(ros_paths=[str(folder)])
        assert search.locate("my_msgs", "msg", "A") == str(package / "msg" / "A.msg")
        assert search.packages()["my_msgs"] == {"msg": ("A",), "srv": ("B",), "action": ("C",)}


def test_ament_prefix(tmp_path: Path, write: Write) -> None:
    write("share/ament_index/resource_index/packages/my_msgs", "share/my_msgs/msg/A.msg", "share/my_msgs/package.xml")
    write("include/other_msgs/msg/B.msg")
    path = str(tmp_path / "share" / "my_msgs" / "msg" / "A.msg")
    for search in (SearchPath(ament_prefixes=[str(tmp_path)]), SearchPath(ros_paths=[str(tmp_path)])):
        assert search.locate("my_msgs", "msg", "A") == path
        assert "my_msgs" in search.packages()
        assert "other_msgs" not in search.packages()


def test_isolated_install_space_as_ros_path(tmp_path: Path, write: Write) -> None:
    write("install/my_msgs/share/my_msgs/msg/A.msg")
    assert SearchPath(ros_paths=[str(tmp_path / "install")]).locate("my_msgs", "msg", "A")
    assert SearchPath(ament_prefixes=[str(tmp_path / "install" / "my_msgs")]).locate("my_msgs", "msg", "A")


def test_name_of_a_package(tmp_path: Path, write: Write) -> None:
    write("checkout/msg/A.msg", "second/msg/B.msg", "plain_msgs/msg/C.msg")
    (tmp_path / "checkout" / "package.xml").write_text(
        "<package><!-- <name>old_msgs</name> -->\n<name> my_msgs </name>\n<author>x</author></package>"
    )
    (tmp_path / "second" / "package.xml").write_bytes(b"\xff\xfe not XML at all")
    search = SearchPath(workspace=[str(tmp_path)])
    ours = {name: kinds["msg"] for name, kinds in search.packages().items() if kinds["msg"] in (("A",), ("B",), ("C",))}
    assert ours == {"my_msgs": ("A",), "second": ("B",), "plain_msgs": ("C",)}


def test_order_of_places(tmp_path: Path, write: Write) -> None:
    write("ws/std_msgs/msg/Int32.msg", "extra/std_msgs/msg/Int32.msg", "extra/std_msgs/msg/Int64.msg")
    write("ros/share/std_msgs/msg/Int64.msg", "ros/share/std_msgs/msg/Bool.msg", "ros/share/std_msgs/msg/New.msg")
    search = SearchPath([str(tmp_path / "ws")], [str(tmp_path / "extra")], [str(tmp_path / "ros")])
    places = {name: search.locate("std_msgs", "msg", name) for name in ("Int32", "Int64", "Bool", "Int16")}
    assert places["Int32"] == str(tmp_path / "ws/std_msgs/msg/Int32.msg")
    assert places["Int64"] == str(tmp_path / "extra/std_msgs/msg/Int64.msg")
    assert places["Bool"] == str(tmp_path / "ros/share/std_msgs/msg/Bool.msg")
    assert str(places["Int16"]).endswith(os.path.join("interfaces", "standard", "std_msgs", "msg", "Int16.msg"))
    assert {"Int16", "Int32", "New"} <= set(search.packages()["std_msgs"]["msg"])


def test_nearer_folders_and_earlier_places_win(tmp_path: Path, write: Write) -> None:
    write("a/b/c/my_msgs/msg/A.msg", "a/my_msgs/msg/A.msg", "z/my_msgs/msg/A.msg", "z/my_msgs/msg/B.msg")
    search = SearchPath([str(tmp_path)])
    assert search.locate("my_msgs", "msg", "A") == str(tmp_path / "a/my_msgs/msg/A.msg")
    assert search.locate("my_msgs", "msg", "B") == str(tmp_path / "z/my_msgs/msg/B.msg")
    two = SearchPath([str(tmp_path / "z"), str(tmp_path / "a")])
    assert two.locate("my_msgs", "msg", "A") == str(tmp_path / "z/my_msgs/msg/A.msg")


@pytest.mark.parametrize(
    "folder", ["build", "install", "log", "node_modules", "__pycache__", ".venv", ".git", ".hidden"]
)
def test_folders_not_entered(tmp_path: Path, write: Write, folder: str) -> None:
    write(f"ws/{folder}/my_msgs/msg/A.msg")
    assert SearchPath([str(tmp_path / "ws")]).locate("my_msgs", "msg", "A") is None
    assert SearchPath(ros_paths=[str(tmp_path / "ws" / folder)]).locate("my_msgs", "msg", "A")


def test_depth(tmp_path: Path, write: Write) -> None:
    parents = "/".join("abcdefghi"[: MAX_DEPTH - 1])
    write(f"{parents}/near_msgs/msg/A.msg", f"{parents}/x/far_msgs/msg/A.msg")
    search = SearchPath([str(tmp_path)])
    assert search.locate("near_msgs", "msg", "A")
    assert search.locate("far_msgs", "msg", "A") is None


def test_number_of_folders(tmp_path: Path, write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    write("a_msgs/msg/A.msg", "b_msgs/msg/A.msg")
    monkeypatch.setattr(search_module, "MAX_FOLDERS", 2)
    search = SearchPath([str(tmp_path)])
    assert search.locate("a_msgs", "msg", "A")
    assert search.locate("b_msgs", "msg", "A") is None
    assert search.looked_in()[0] == f"the workspace `{tmp_path}` (its first 2 folders)"


def test_folders_of_the_running_system_are_not_looked_into(
    tmp_path: Path, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write("proc/a_msgs/msg/A.msg", "b_msgs/msg/A.msg")
    monkeypatch.setattr(search_module, "SYSTEM_FOLDERS", frozenset({str(tmp_path / "proc")}))
    assert {*SearchPath([str(tmp_path)]).packages()} == {*SearchPath().packages(), "b_msgs"}


def test_links(tmp_path: Path, write: Write) -> None:
    write("elsewhere/linked_msgs/msg/A.msg", "ws/src/my_msgs/msg/B.msg")
    os.symlink(tmp_path / "elsewhere" / "linked_msgs", tmp_path / "ws" / "src" / "linked_msgs")
    os.symlink(tmp_path / "ws", tmp_path / "ws" / "src" / "loop")
    os.symlink(tmp_path / "nowhere", tmp_path / "ws" / "src" / "broken")
    os.symlink(tmp_path / "nowhere", tmp_path / "ws" / "src" / "my_msgs" / "msg" / "Broken.msg")
    search = SearchPath([str(tmp_path / "ws")])
    assert search.locate("linked_msgs", "msg", "A") == str(tmp_path / "ws/src/linked_msgs/msg/A.msg")
    assert search.packages()["my_msgs"]["msg"] == ("B",)


def test_other_files_are_no_definitions(tmp_path: Path, write: Write) -> None:
    write(
        "m/msg/A.msg",
        "m/msg/B.srv",
        "m/msg/readme.md",
        "m/msg/lower.msg",
        "m/msg/A_Request.msg",
        "m/msg/.msg",
        "m/msg/D.msg/x",
    )
    write("n/msg/readme.md", "n/src/E.msg")
    packages = SearchPath([str(tmp_path)]).packages()
    assert packages["m"] == {"msg": ("A",), "srv": (), "action": ()}
    assert "n" not in packages


def test_unreadable_folders_are_ignored(tmp_path: Path, write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    write("locked/a_msgs/msg/A.msg", "open/b_msgs/msg/B.msg", "open/b_msgs/package.xml", "file")
    scandir = os.scandir

    def guarded(path: str):  # type: ignore[no-untyped-def]
        if "locked" in path:
            raise PermissionError(path)
        return scandir(path)

    monkeypatch.setattr(os, "scandir", guarded)
    search = SearchPath([str(tmp_path), str(tmp_path / "gone"), str(tmp_path / "file")], ament_prefixes=["/no/where"])
    assert search.locate("a_msgs", "msg", "A") is None
    assert search.locate("b_msgs", "msg", "B")


def test_names_lead_nowhere_else(tmp_path: Path, write: Write) -> None:
    write("prefix/share/a/msg/A.msg", "prefix/b/msg/B.msg")
    search = SearchPath(ament_prefixes=[str(tmp_path / "prefix")])
    assert search.locate("a", "msg", "A")
    for package in ("../b", "", ".", "a/../a", str(tmp_path / "prefix" / "share" / "a")):
        assert search.locate(package, "msg", "A") is None
        assert search.locate(package, "msg", "B") is None
    assert search.locate("a", "msg", "../msg/A") is None


def test_refresh(tmp_path: Path, write: Write) -> None:
    write("ws/my_msgs/msg/A.msg", "prefix/share/his_msgs/msg/A.msg")
    search = SearchPath([str(tmp_path / "ws")], ament_prefixes=[str(tmp_path / "prefix")])
    assert search.packages()["my_msgs"]["msg"] == search.packages()["his_msgs"]["msg"] == ("A",)
    write("ws/my_msgs/msg/B.msg", "prefix/share/his_msgs/msg/B.msg", "prefix/share/her_msgs/msg/A.msg")
    (tmp_path / "ws/my_msgs/msg/A.msg").unlink()
    assert search.locate("my_msgs", "msg", "B") is None
    search.refresh()
    assert search.packages()["my_msgs"]["msg"] == ("B",)
    assert search.packages()["his_msgs"]["msg"] == ("A", "B")
    assert search.locate("my_msgs", "msg", "A") is None
    assert search.locate("her_msgs", "msg", "A")


def test_places_in_words(tmp_path: Path) -> None:
    search = SearchPath([str(tmp_path)], [str(tmp_path / "gone"), ""], [str(tmp_path), str(tmp_path)])
    assert search.looked_in() == (
        f"the workspace `{tmp_path}`",
        f"`{tmp_path / 'gone'}` (the folder does not exist) from `--ros-path`",
        f"`{tmp_path}` from `AMENT_PREFIX_PATH`",
        "the standard packages included in this tool",
    )


def test_asking_for_one_type_lists_few_folders(tmp_path: Path, write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    write(*(f"share/p{number}_msgs/msg/A.msg" for number in range(100)))
    listed: list[str] = []
    scandir = os.scandir

    def counted(path: str):  # type: ignore[no-untyped-def]
        listed.append(path)
        return scandir(path)

    monkeypatch.setattr(os, "scandir", counted)
    search = SearchPath(ament_prefixes=[str(tmp_path)])
    for _ in range(3):
        assert search.locate("p7_msgs", "msg", "A")
    assert len(listed) <= 4
