# SPDX-License-Identifier: Apache-2.0
"""A package that exists several times: its files, and whether they agree."""

from __future__ import annotations

from pathlib import Path

from roaml.interfaces.registry import Registry
from roaml.interfaces.search import SearchPath
from roaml.text import SourceFile


def write(folder: Path, text: str, package: str = "parts") -> str:
    path = folder / package / "msg" / "Blob.msg"
    path.parent.mkdir(parents=True)
    path.write_text(text)
    return str(path)


def read(path: str) -> SourceFile:
    return SourceFile(path, Path(path).read_text())


def other(search: SearchPath, package: str = "parts") -> str | None:
    definition = Registry(search, read).other_definition("msg", package, "Blob")
    return definition.path if definition else None


def test_once(tmp_path: Path) -> None:
    write(tmp_path, "int32 x")
    assert other(SearchPath([str(tmp_path)])) is None


def test_twice_in_the_workspace(tmp_path: Path) -> None:
    write(tmp_path, "int32 x")
    deeper = write(tmp_path / "old", "int32 y")
    assert other(SearchPath([str(tmp_path)])) == deeper


def test_in_the_workspace_and_on_the_ros_path(tmp_path: Path) -> None:
    write(tmp_path / "one", "int32 x")
    second = write(tmp_path / "two", "int64 x")
    assert other(SearchPath([str(tmp_path / "one")], [str(tmp_path / "two")])) == second


def test_comments_make_no_difference(tmp_path: Path) -> None:
    write(tmp_path, "int32 x # here")
    write(tmp_path / "old", "# there\nint32   x\n")
    assert other(SearchPath([str(tmp_path)])) is None


def test_the_third_may_be_the_one_that_differs(tmp_path: Path) -> None:
    write(tmp_path, "int32 x")
    write(tmp_path / "a", "int32 x")
    third = write(tmp_path / "b", "int32 z")
    assert other(SearchPath([str(tmp_path)])) == third


def test_a_prefix_is_laid_over_another_on_purpose(tmp_path: Path) -> None:
    write(tmp_path / "over" / "share", "int32 x")
    write(tmp_path / "under" / "share", "int32 y")
    prefixes = [str(tmp_path / "over"), str(tmp_path / "under")]
    assert other(SearchPath([], [], prefixes)) is None


def test_a_workspace_against_its_installed_copy(tmp_path: Path) -> None:
    write(tmp_path / "workspace", "int32 x")
    installed = write(tmp_path / "prefix" / "share", "int32 y")
    assert other(SearchPath([str(tmp_path / "workspace")], [], [str(tmp_path / "prefix")])) == installed


def test_the_standard_packages_do_not_count(tmp_path: Path) -> None:
    path = tmp_path / "std_msgs" / "msg" / "Bool.msg"
    path.parent.mkdir(parents=True)
    path.write_text("int8 data")
    assert Registry(SearchPath([str(tmp_path)]), read).other_definition("msg", "std_msgs", "Bool") is None
