# SPDX-License-Identifier: Apache-2.0
"""The command as a separate process, for behavior that only a real process has."""

from __future__ import annotations

import json
import os
import pty
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

import clock
from timeouts import TIMEOUT_S

INSTALLED = (str(Path(sys.executable).parent / "as2fm-lsp"),)
MODULE = (sys.executable, "-m", "as2fm_lsp")


def call(
    *arguments: str,
    cwd: Path,
    program: Sequence[str] = INSTALLED,
    stdin: bytes = b"",
    stdout: int = subprocess.PIPE,
    environment: dict[str, str] | None = None,
) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [*program, *arguments],
        cwd=cwd,
        input=stdin,
        stdout=stdout,
        stderr=subprocess.PIPE,
        env={**os.environ, **(environment or {})},
        check=False,
        timeout=TIMEOUT_S,
    )


@pytest.mark.parametrize("program", [INSTALLED, MODULE], ids=["installed", "module"])
def test_statuses(tmp_path: Path, program: Sequence[str]) -> None:
    clock.write(tmp_path)
    assert call("--check", "main.xml", cwd=tmp_path, program=program).returncode == 0
    (tmp_path / "clock.ascxml").write_text(clock.WRONG_CLOCK)
    assert call("--check", "main.xml", cwd=tmp_path, program=program).returncode == 1
    assert call("--frobnicate", cwd=tmp_path, program=program).returncode == 2


def test_stdin(tmp_path: Path) -> None:
    clock.write(tmp_path)
    data = clock.WRONG_CLOCK.encode() + b"<!-- \xff -->"
    done = call("--check", "--format", "json", "--stdin-filename", "clock.ascxml", cwd=tmp_path, stdin=data)
    assert (done.returncode, done.stderr) == (1, b"")
    codes = [row["code"] for row in json.loads(done.stdout)]
    assert codes == ["undeclared-variable", "undecodable-text"]


@pytest.mark.parametrize(
    "environment",
    [
        {"PYTHONIOENCODING": "ascii"},
        {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"},
        {"PYTHONIOENCODING": "cp1252"},
    ],
    ids=["ascii", "C", "cp1252"],
)
def test_a_terminal_that_is_not_unicode(tmp_path: Path, environment: dict[str, str]) -> None:
    """Characters that the terminal does not support are escaped. Output for programs is always UTF-8."""
    clock.write(tmp_path, clock=clock.CLOCK.replace("(count + 1)", "(字数 + 1)"))
    done = call("--check", "main.xml", cwd=tmp_path, environment=environment)
    assert (done.returncode, done.stderr) == (1, b"")
    assert rb"`\u5b57\u6570`" in done.stdout
    done = call("--check", "main.xml", "--format", "json", cwd=tmp_path, environment=environment)
    assert "`字数`" in json.loads(done.stdout.decode("utf-8"))[0]["message"]
    assert call("--explain", "unknown-element", cwd=tmp_path, environment=environment).returncode == 0


def test_a_reader_that_has_seen_enough(tmp_path: Path) -> None:
    """A reader that closes the pipe, as in `as2fm-lsp --check . | head -1`: no message, and the exit status of a
    shell."""
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = call("--check", "main.xml", cwd=tmp_path, stdout=writing)
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (141, b"")


def test_colors_on_a_terminal(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    ours, theirs = pty.openpty()
    try:
        environment = {"TERM": "xterm", "NO_COLOR": ""}
        done = call("--check", "main.xml", cwd=tmp_path, stdout=theirs, environment=environment)
        shown = os.read(ours, 10_000)
    finally:
        os.close(ours)
        os.close(theirs)
    assert done.returncode == 1
    assert b"\x1b[31merror\x1b[0m" in shown


def test_nothing_is_left_behind(tmp_path: Path) -> None:
    """The command writes no cache and no log."""
    clock.write(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    call("--check", ".", cwd=tmp_path)
    assert sorted(tmp_path.rglob("*")) == before
