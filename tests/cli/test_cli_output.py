# SPDX-License-Identifier: Apache-2.0
"""Output: files are written completely or not at all, and names and texts of any kind can be printed."""

from __future__ import annotations

import json
import os
import stat
import tempfile
import threading
from pathlib import Path

import pytest
from command import Command

import clock
from as2fm_lsp.atomic_write import write_file


def test_output(command: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    printed = command("--check", ".", "--format", "json")
    done = command("--check", ".", "--format", "json", "--output", "report.json")
    assert done == (1, "", "")
    assert (tmp_path / "report.json").read_text() == printed.out
    assert not [name for name in os.listdir(tmp_path) if name.startswith(".")], "nothing temporary is left"
    assert command("--check", ".", "--statistics", "--output", "report.json").status == 1
    assert (tmp_path / "report.json").read_text() == "     1 error        undeclared-variable\n"


def test_a_new_file_has_the_usual_mode_and_an_old_one_keeps_its_own(tmp_path: Path) -> None:
    ordinary = tmp_path / "ordinary"
    ordinary.write_text("")
    write_file(str(tmp_path / "new"), "text")
    assert (tmp_path / "new").stat().st_mode == ordinary.stat().st_mode
    ordinary.chmod(0o640)
    write_file(str(ordinary), "text")
    assert stat.S_IMODE(ordinary.stat().st_mode) == 0o640


def test_an_existing_file_survives_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "report.txt"
    path.write_text("precious")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="No space left"):
        write_file(str(path), "half")
    assert path.read_text() == "precious"
    assert os.listdir(tmp_path) == ["report.txt"], "nothing temporary is left"


@pytest.mark.parametrize("target", ["missing/report.txt", ".", "clock.ascxml/report.txt", ""])
def test_an_unwritable_output_is_a_usage_error(command: Command, tmp_path: Path, target: str) -> None:
    clock.write(tmp_path)
    before = sorted(os.listdir(tmp_path))
    done = command("--check", "main.xml", "--output", target)
    assert done.status == 2
    assert done.err.startswith(f"as2fm-lsp: {target}: ")
    assert sorted(os.listdir(tmp_path)) == before


def test_a_full_disk_is_reported(command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock.write(tmp_path)

    def fail(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tempfile, "mkstemp", fail)
    done = command("--check", "main.xml", "--output", "report.txt")
    assert (done.status, done.err) == (2, "as2fm-lsp: report.txt: No space left on device\n")


def test_a_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "target").write_text("old")
    (tmp_path / "link").symlink_to("target")
    write_file(str(tmp_path / "link"), "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "new"
    (tmp_path / "dangling").symlink_to("fresh")
    write_file(str(tmp_path / "dangling"), "new")
    assert (tmp_path / "fresh").read_text() == "new"


def test_a_pipe_is_written_to_and_not_replaced(command: Command, tmp_path: Path) -> None:
    """A pipe is written to and not replaced, as `--output /dev/stdout` requires."""
    clock.write(tmp_path)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    assert command("--check", "main.xml", "--output", "pipe").status == 0
    reader.join(10)
    assert read == ["3 files checked: no diagnostics\n"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


NO_TEXT = os.fsdecode(b"caf\xe9")
"""A file name in another encoding than the system's."""


@pytest.mark.parametrize("name", ["text", "json", "github", "gitlab", "sarif", "junit"])
def test_names_that_are_no_text(command: Command, tmp_path: Path, name: str) -> None:
    (tmp_path / f"{NO_TEXT}.ascxml").write_text(clock.WRONG_CLOCK)
    done = command("--check", ".", "--format", name, "--select", "unknown-element,undeclared-variable")
    assert done.status == 1
    assert "caf" in done.out
    written = command("--check", ".", "--format", name, "--select", "undeclared-variable", "--output", "out")
    assert written.status == 1
    assert (tmp_path / "out").read_text(encoding="utf-8") == done.out
    if name == "json":
        assert json.loads(done.out)[0]["file"] == f"{NO_TEXT}.ascxml"
