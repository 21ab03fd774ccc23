# SPDX-License-Identifier: Apache-2.0
"""A model on standard input: the path `-`, and `--stdin-filename`, the text of a file as an editor has it."""

from __future__ import annotations

import re
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


LONE_TREE = (
    """<root BTCPP_format="4"><BehaviorTree ID="Fetch"><Sequence><Find /><Grasp /></Sequence></BehaviorTree></root>"""
)


def test_a_dash_is_checked(check: Command, tmp_path: Path) -> None:
    """The text is a file of the working directory: the files that it names are found."""
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    done = check("-", "--severity", "error", stdin=clock.MAIN.encode())
    assert done.found == [("clock.ascxml", 9, "undeclared-variable")]
    machine = check("-", "--severity", "error", stdin=clock.WRONG_CLOCK.encode())
    assert machine.found == [("<stdin>.xml", 9, "undeclared-variable")]
    json = check("-", stdin=b'\n {"properties": [ {"name": 1} ]}')
    assert {row["file"] for row in json.rows} == {"<stdin>.jani"}
    named = check("-", "--stdin-filename", "new.ascxml", stdin=clock.WRONG_CLOCK.encode())
    assert named.found == [("new.ascxml", 9, "undeclared-variable")]


def test_a_dash_beside_other_paths(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    (tmp_path / "other.ascxml").write_text(clock.WRONG_CLOCK)
    done = check("-", "other.ascxml", "--severity", "error", stdin=clock.WRONG_CLOCK.encode())
    assert {row["file"] for row in done.rows} == {"<stdin>.xml", "other.ascxml"}


def test_standard_input_is_not_fixed(command: Command, tmp_path: Path) -> None:
    done = command("check", "-", "--fix", stdin=clock.WRONG_CLOCK.encode())
    assert done == (2, "", "as2fm-lsp: --fix changes files; it cannot be used with standard input\n")


def test_a_dash_is_verified(command: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    fewer = ("--max-traces", "5", "--method", "fixed", "--scheduler", "uniform", "--quiet")
    from_disk = command("verify", main, *fewer)
    system = command("verify", "-", *fewer, stdin=clock.MAIN.encode())
    assert without_time(system.out) == without_time(from_disk.out)
    assert system.status == 0
    model = command("translate", main, "-o", "-").out.encode()
    jani = command("verify", "-", *fewer, stdin=model)
    assert without_time(jani.out) == without_time(from_disk.out)
    tree = command("verify", "-", "--mock", "*: 1", "--quiet", stdin=LONE_TREE.encode())
    assert tree.out.startswith("succeeds: = 1 ")
    wrong = command("verify", "-", stdin=b"{")
    assert wrong.status == 1
    assert wrong.err.startswith("<stdin>.jani:1:")


def test_a_dash_is_drawn(command: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    drawn = command("draw", "-", stdin=clock.MAIN.encode())
    assert drawn.out.replace("&lt;stdin&gt;", "main") == command("draw", main, "-o", "-").out
    assert command("draw", "-", "-o", "clock.svg", stdin=clock.CLOCK.encode()).out.startswith("clock.svg: ")
    mocked = command("draw", "-", "--mock", "*: 0.5", stdin=LONE_TREE.encode())
    assert "Grasp" in mocked.out


def test_a_dash_is_translated_and_simulated(command: Command, tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    assert command("translate", "-", stdin=clock.MAIN.encode()).out == command("translate", main, "-o", "-").out
    steps = command("simulate", "-", "--steps", "5", stdin=clock.MAIN.encode())
    assert steps.out == command("simulate", main, "--steps", "5").out


def without_time(text: str) -> str:
    return re.sub(r", [\d.]+ s$", "", text, flags=re.MULTILINE)
