# SPDX-License-Identifier: Apache-2.0
"""Pipes, devices and very large files as inputs, and links that lead out of the workspace."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from command import Done

import clock
import prefork
from roaml.project.files import MAX_CHARACTERS
from timeouts import TIMEOUT_S


def run(folder: Path, *arguments: str) -> Done:
    """Run the command as a separate process, which can be ended if it hangs."""
    command = [*prefork.command(), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    return Done(done.returncode, done.stdout, done.stderr)


def pipe(path: Path) -> None:
    os.mkfifo(path)


def device(path: Path) -> None:
    path.symlink_to("/dev/zero")


def folder(path: Path) -> None:
    path.mkdir()


@pytest.mark.parametrize(
    ("make", "words"), [(pipe, "not a regular file"), (device, "not a regular file"), (folder, "folder")]
)
@pytest.mark.parametrize(
    "arguments",
    [("--check", "main.xml"), ("translate", "main.xml"), ("verify", "main.xml"), ("format", "--check", "main.xml")],
    ids=lambda arguments: arguments[0],
)
def test_configuration(tmp_path: Path, make, words: str, arguments: tuple[str, ...]) -> None:  # type: ignore[no-untyped-def]
    clock.write(tmp_path)
    make(tmp_path / "as2fm.toml")
    done = run(tmp_path, *arguments)
    assert done.status == 2
    assert f"{tmp_path / 'as2fm.toml'}: it is" in done.err
    assert words in done.err


@pytest.mark.parametrize("make", [pipe, device])
@pytest.mark.parametrize("name", ["pyproject.toml", "package.xml", "more.xml", "more.ascxml", "more.jani", "msg/A.msg"])
def test_special_files_beside_a_system(tmp_path: Path, make, name: str) -> None:  # type: ignore[no-untyped-def]
    clock.write(tmp_path)
    (tmp_path / "msg").mkdir()
    make(tmp_path / name)
    done = run(tmp_path, "--check", ".")
    assert done.status == 0, done.err


@pytest.mark.parametrize("make", [pipe, device])
@pytest.mark.parametrize(
    "arguments",
    [
        ("--check", "main.xml", "--baseline", "it"),
        ("verify", "main.xml", "--seed", "1", "--resume", "it"),
        ("verify", "it"),
        ("translate", "it"),
        ("--check", "it"),
    ],
    ids=lambda arguments: " ".join(arguments[:-1]),
)
def test_named_files(tmp_path: Path, make, arguments: tuple[str, ...]) -> None:  # type: ignore[no-untyped-def]
    clock.write(tmp_path)
    make(tmp_path / "it")
    done = run(tmp_path, *arguments)
    assert done.status == 2
    assert "it is not a regular file" in done.err
    assert "Traceback" not in done.err


UNREADABLE = ("/proc/kmsg", "/proc/self/mem", "/dev/zero", "/")
"""Paths of files without text. The first is a regular file whose content is `None` while the kernel writes nothing, or
that must not be read; reading the second one fails."""


@pytest.mark.parametrize("path", UNREADABLE)
@pytest.mark.parametrize("replaced", ["clock.ascxml", "properties.jani"])
def test_files_that_a_system_names(tmp_path: Path, path: str, replaced: str) -> None:
    clock.write(tmp_path, main=clock.MAIN.replace(replaced, path))
    for arguments in (("--check", "."), ("--check", "main.xml"), ("translate",), ("verify",), ("simulate",)):
        done = run(tmp_path, *arguments, *(() if arguments[0] == "--check" else ("main.xml",)))
        assert done.status == 1, done.err
        assert f"error: `{path}` " in done.out + done.err, arguments
        assert "Traceback" not in done.err


@pytest.mark.parametrize("path", UNREADABLE)
def test_files_that_a_tree_includes(tmp_path: Path, path: str) -> None:
    tree = '<BehaviorTree ID="Main"><AlwaysSuccess/></BehaviorTree>'
    (tmp_path / "tree.xml").write_text(f'<root BTCPP_format="4"><include path="{path}"/>{tree}</root>')
    for arguments in (
        ("--check", "."),
        ("--check", "tree.xml"),
        ("verify", "tree.xml"),
        ("draw", "tree.xml", "--tree"),
    ):
        done = run(tmp_path, *arguments)
        assert "Traceback" not in done.err
        assert ("missing-include" in done.out + done.err) == (arguments[0] != "draw"), done


def test_a_large_configuration(tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "as2fm.toml").write_text("#" * (MAX_CHARACTERS + 1))
    done = run(tmp_path, "--check", "main.xml")
    assert (done.status, "as2fm.toml:1:1: error: the file is too large" in done.out) == (1, True)
    done = run(tmp_path, "verify", "main.xml")
    assert done.status == 2
    assert f"{tmp_path / 'as2fm.toml'}: the file is too large" in done.err


def test_a_configuration_of_brackets(tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "as2fm.toml").write_text(f"roots = {'[' * 5000}{']' * 5000}")
    done = run(tmp_path, "--check", "main.xml")
    assert (done.status, "[toml-syntax]" in done.out) == (1, True)
    assert run(tmp_path, "verify", "main.xml").status == 2


# ----------------------------------------------------------------------- links


@pytest.fixture
def linked(tmp_path: Path) -> Path:
    """A workspace whose machine is a link to a file outside of it."""
    clock.write(tmp_path / "ws")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "ws" / "clock.ascxml").rename(tmp_path / "elsewhere" / "clock.ascxml")
    (tmp_path / "ws" / "clock.ascxml").symlink_to("../elsewhere/clock.ascxml")
    return tmp_path / "ws"


def test_a_link_out_of_the_workspace(linked: Path) -> None:
    for what in (".", "main.xml"):
        done = run(linked, "--check", what)
        assert "it is a link to a file outside of the workspace" in done.out
        assert done.status == 1


def test_a_link_to_a_further_root(linked: Path) -> None:
    (linked / "as2fm.toml").write_text('roots = [".", "../elsewhere"]')
    assert run(linked, "--check", "main.xml").status == 0


def test_a_link_that_is_named(linked: Path) -> None:
    """A link that is named is followed."""
    (linked.parent / "main.xml").symlink_to("ws/main.xml")
    (linked / "clock.ascxml").unlink()
    (linked / "clock.ascxml").write_bytes((linked.parent / "elsewhere" / "clock.ascxml").read_bytes())
    assert "clock.ascxml" in run(linked.parent, "--check", "main.xml").out
    assert run(linked.parent, "--check", "elsewhere/clock.ascxml").status == 0


def test_a_folder_that_is_linked_out_of_the_workspace(linked: Path) -> None:
    (linked / "more").symlink_to("../elsewhere")
    (linked.parent / "elsewhere" / "other.xml").write_text("<roaml />")
    assert "other.xml" not in run(linked, "--check", ".").out


def test_packages_are_links_after_a_symlink_install(tmp_path: Path) -> None:
    """`colcon build --symlink-install` makes links from `install` into the sources of packages."""
    source = tmp_path / "src" / "robot_interfaces" / "msg"
    source.mkdir(parents=True)
    (source / "Level.msg").write_text("uint8 data\n")
    share = tmp_path / "install" / "share" / "robot_interfaces" / "msg"
    share.mkdir(parents=True)
    (share / "Level.msg").symlink_to(source / "Level.msg")
    clock.write(tmp_path / "ws", clock=clock.CLOCK.replace("std_msgs/UInt8", "robot_interfaces/Level"))
    assert "robot_interfaces/Level" in (tmp_path / "ws" / "clock.ascxml").read_text()
    done = run(tmp_path / "ws", "--check", "main.xml", "--ros-path", str(tmp_path / "install" / "share"))
    assert "unknown-ros-type" not in done.out
