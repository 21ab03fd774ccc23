# SPDX-License-Identifier: Apache-2.0
"""`--stdin-filename`: the text of a file as an editor has it."""

from __future__ import annotations

from pathlib import Path

from command import Command

import clock
from as2fm_lsp.cli.main import run


def test_inside_a_system(check: Command, tmp_path: Path) -> None:
    """The text is checked as a part of its system, whose other files are read from the disk."""
    clock.write(tmp_path)
    (tmp_path / ".git").mkdir()
    unheard = check("--stdin-filename", "clock.ascxml", stdin=clock.UNHEARD_CLOCK.encode())
    assert unheard.found == [("clock.ascxml", 7, "topic-without-subscriber")]
    assert check("--stdin-filename", "clock.ascxml", stdin=clock.CLOCK.encode()).rows == []
    assert (tmp_path / "clock.ascxml").read_text() == clock.CLOCK, "the file is left alone"


def test_the_rest_of_the_system_sees_the_text(check: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    renamed = clock.CLOCK.replace('topic="/ticks"', 'topic="/tocks"').encode()
    done = check(main, "--stdin-filename", "clock.ascxml", stdin=renamed)
    assert ("properties.jani", 3, "unknown-property-variable") in done.found


def test_a_system_file(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    text = clock.MAIN.replace('"properties.jani"', '"nowhere.jani"').encode()
    done = check("--stdin-filename", "main.xml", "--severity", "error", stdin=text)
    assert done.found == [("main.xml", 9, "missing-file"), ("clock.ascxml", 9, "undeclared-variable")]


def test_a_file_that_does_not_exist(check: Command, tmp_path: Path) -> None:
    done = check("--stdin-filename", "new.ascxml", stdin=clock.WRONG_CLOCK.encode())
    assert done.found == [("new.ascxml", 9, "undeclared-variable")]
    done = check("--stdin-filename", "new/main.xml", stdin=clock.MAIN.encode())
    assert done.codes == ["missing-file", "missing-file"]


def test_it_is_read_as_a_file_is(check: Command, tmp_path: Path) -> None:
    """The text may have any line ends, a byte order mark, another encoding, and bytes that are not text."""
    (tmp_path / ".git").mkdir()
    for data in (
        clock.WRONG_CLOCK.replace("\n", "\r\n").encode(),
        b"\xef\xbb\xbf" + clock.WRONG_CLOCK.encode(),
        clock.WRONG_CLOCK.encode("utf-16"),
        clock.WRONG_CLOCK.replace("</ascxml>", "<!-- caf\xe9 --></ascxml>").encode("latin-1"),
        b"\x00\xff<",
        b"",
    ):
        (tmp_path / "machine.ascxml").write_bytes(data)
        from_disk = check("machine.ascxml")
        from_stdin = check("--stdin-filename", "machine.ascxml", stdin=data)
        assert from_stdin == from_disk
        assert from_disk.rows


def test_other_files_may_be_named_besides(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "other.ascxml").write_text(clock.WRONG_CLOCK)
    done = check("other.ascxml", "--stdin-filename", "clock.ascxml", stdin=clock.WRONG_CLOCK.encode())
    assert [row["file"] for row in done.rows] == ["other.ascxml", "clock.ascxml"]
    assert run(["--check", "other.ascxml"]) == 1
