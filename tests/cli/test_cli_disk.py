# SPDX-License-Identifier: Apache-2.0
"""Disks and pipes that are full, and processes that are killed: messages, and files that remain."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest
from command import Command

import clock
import prefork
from as2fm_lsp.atomic_write import PREFIX, write_file

INSTALLED = str(Path(sys.executable).parent / "as2fm-lsp")


def call(
    folder: Path, *arguments: str, program: Sequence[str], out: str = os.devnull, size: int = -1, **more: str
) -> tuple[int, str]:
    """Status and standard error of a command that writes to `out` and, if `size` is given, no longer files."""

    def limit() -> None:
        if size >= 0:
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    with open(out, "wb") as stdout:
        done = subprocess.run(
            [*program, *arguments],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=stdout,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            preexec_fn=limit,
            # Modules that are compiled now would be stored as files that are too short.
            env={**os.environ, "PYTHONUNBUFFERED": "", "PYTHONDONTWRITEBYTECODE": "1" if size >= 0 else "", **more},
        )
    return done.returncode, done.stderr


PRINTING = (
    ("--check", "main.xml"),
    ("--check", "main.xml", "--format", "json"),
    ("--explain", "unknown-type"),
    ("--help",),
    ("--version",),
    ("format", "."),
    ("format", ".", "--diff"),
    ("init", "robot"),
    ("migrate", "."),
    ("translate", "main.xml"),
    ("translate", "main.xml", "-o", "-"),
    ("verify", "main.xml", "--max-traces", "100"),
    ("verify", "main.xml", "--max-traces", "100", "--format", "junit"),
    ("verify", "--help"),
)
NO_SPACE = (2, "as2fm-lsp: standard output: No space left on device\n")


@pytest.mark.parametrize("arguments", PRINTING, ids=" ".join)
@pytest.mark.parametrize("unbuffered", ["", "1"], ids=["buffered", "unbuffered"])
def test_standard_output_that_is_full(tmp_path: Path, arguments: tuple[str, ...], unbuffered: str) -> None:
    clock.write(tmp_path)
    outcome = call(tmp_path, *arguments, program=prefork.command(), out="/dev/full", PYTHONUNBUFFERED=unbuffered)
    assert outcome == NO_SPACE


@pytest.mark.parametrize("arguments", [PRINTING[0], ("--help",)], ids=" ".join)
@pytest.mark.parametrize("unbuffered", ["", "1"], ids=["buffered", "unbuffered"])
def test_standard_output_that_is_full_at_the_end_of_the_interpreter(
    tmp_path: Path, arguments: tuple[str, ...], unbuffered: str
) -> None:
    """The same with a process that Python itself starts and ends."""
    clock.write(tmp_path)
    outcome = call(tmp_path, *arguments, program=(INSTALLED,), out="/dev/full", PYTHONUNBUFFERED=unbuffered)
    assert outcome == NO_SPACE


@pytest.mark.parametrize(("arguments", "status"), [(("--check", "main.xml"), 1), (("verfy", "x"), 2)], ids=["1", "2"])
@pytest.mark.parametrize("unbuffered", ["", "1"], ids=["buffered", "unbuffered"])
@pytest.mark.parametrize("where", [">/dev/null 2>/dev/full", ">&-", "2>&-", ">&- 2>&-"])
def test_streams_that_are_full_or_closed_change_no_status(
    tmp_path: Path, arguments: tuple[str, ...], status: int, unbuffered: str, where: str
) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    command = f'exec "$0" "$@" {where}'
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    shell = ["sh", "-c", command, INSTALLED, *arguments]
    done = subprocess.run(shell, cwd=tmp_path, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == status
    assert "Traceback" not in done.stderr


MIGRATED = clock.CLOCK.replace("ascxml", "scxml")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--check", "main.xml", "--output", "report.sarif", "--format", "sarif"), "report.sarif"),
        (("--check", ".", "--fix"), "old/clock.scxml"),
        (("--check", ".", "--baseline", "known.json"), "known.json"),
        (("format", "."), "clock.ascxml"),
        (("init", "robot"), "robot/"),
        (("migrate", "old/main.xml"), "old/clock.ascxml"),
        (("translate", "main.xml"), "main.jani"),
        (("translate", "main.xml", "--map", "map.json", "-o", "-"), "map.json"),
        (("translate", "main.xml", "--dot", "dot"), "dot/machine-Clock.dot"),
        (("translate", "main.xml", "--scxml-dir", "scxml"), "scxml/"),
        (("verify", "main.xml", "--traces", "traces", "--max-traces", "100"), "traces/"),
        (("verify", "main.xml", "--resume", "state.json", "--max-traces", "100"), "state.json"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_a_disk_that_is_full(tmp_path: Path, arguments: tuple[str, ...], named: str) -> None:
    """The file is named, each file is as it was, and nothing else is left."""
    unmended = clock.CLOCK.replace('id="count"', 'id=" count"').replace(' version="1.0"', '   version="1.0"')
    clock.write(tmp_path, clock=unmended if "--fix" in arguments else clock.CLOCK.replace("<state", "\n <state", 1))
    clock.write(tmp_path / "old", main=clock.MAIN.replace("clock.ascxml", "clock.scxml"))
    (tmp_path / "old/clock.ascxml").rename(tmp_path / "old/clock.scxml")
    (tmp_path / "old/clock.scxml").write_text(MIGRATED)
    before = files(tmp_path)
    status, err = call(tmp_path, *arguments, program=prefork.command(), size=16)
    assert (status, files(tmp_path)) == (2, before)
    (line,) = err.splitlines()
    assert line.startswith(f"as2fm-lsp: {named}")
    assert line.endswith(": File too large")


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# ------------------------------------------------------------------------ killed

WRITES = """
import sys
from as2fm_lsp.atomic_write import write_file

def pieces():
    yield "half"
    print("writing", flush=True)
    sys.stdin.read()

write_file(sys.argv[1], pieces())
"""


@contextmanager
def writing(path: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that has written half of a file, and waits."""
    command = [sys.executable, "-c", WRITES, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        assert running.stdout.readline() == "writing\n"
        try:
            yield running
        finally:
            running.kill()


def left(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if path.name.startswith(PREFIX))


@pytest.mark.parametrize(
    "arguments",
    [
        ("--check", "main.xml", "--output", "report.txt"),
        ("format", "."),
        ("init", "."),
        ("translate", "main.xml"),
        ("verify", "main.xml", "--max-traces", "100", "--resume", "state.json"),
    ],
    ids=lambda value: value[0],
)
def test_files_of_a_killed_process_are_removed_by_the_next(
    command: Command, tmp_path: Path, arguments: tuple[str, ...]
) -> None:
    if arguments[0] != "init":
        clock.write(tmp_path)
    (tmp_path / ".as2fm-baseline.json").write_text("{}")
    with writing(tmp_path / "main.jani") as process:
        process.kill()
        assert process.wait() == -signal.SIGKILL
    assert len(left(tmp_path)) == 1
    assert not (tmp_path / "main.jani").exists()
    assert command(*arguments).status == 0
    assert left(tmp_path) == []
    assert (tmp_path / ".as2fm-baseline.json").exists()


def test_files_that_are_being_written_stay(tmp_path: Path) -> None:
    with writing(tmp_path / "one") as process:
        write_file(str(tmp_path / "two"), "two")
        assert len(left(tmp_path)) == 1
        process.communicate("")
    assert files(tmp_path) == {"one": b"half", "two": b"two"}


def test_a_folder_that_cannot_be_locked_is_written_to(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on some network drives; what is left there stays."""

    def fail(*_: object) -> None:
        raise OSError(37, "No locks available")

    (tmp_path / f"{PREFIX}x").write_text("")
    monkeypatch.setattr("fcntl.flock", fail)
    write_file(str(tmp_path / "one"), "one")
    assert files(tmp_path) == {"one": b"one", f"{PREFIX}x": b""}


def test_a_file_that_is_swept_away_before_it_is_locked_is_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fcntl  # noqa: PLC0415 - what the function is taken from

    real, seen = fcntl.flock, []

    def slow(handle: int, operation: int) -> None:
        if not seen:
            seen.extend(left(tmp_path))
            seen[0].unlink()
        real(handle, operation)

    monkeypatch.setattr(fcntl, "flock", slow)
    write_file(str(tmp_path / "one"), "one")
    assert len(seen) == 1
    assert files(tmp_path) == {"one": b"one"}
