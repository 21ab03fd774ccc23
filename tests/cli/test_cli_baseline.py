# SPDX-License-Identifier: Apache-2.0
"""`--baseline`: findings of the baseline are not reported."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command import Command

import clock

TWO = clock.WRONG_CLOCK.replace("count + 1", "conut + 1")


def test_written_then_applied(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=TWO)
    first = check(".", "--baseline", "known.json")
    assert (first.status, first.rows) == (0, [])
    assert first.err == "as2fm-lsp: wrote known.json with 2 known diagnostics\n"
    table = json.loads((tmp_path / "known.json").read_text())
    assert table["version"] == 1
    assert [(row["file"], row["code"], row["count"]) for row in table["known"].values()] == [
        ("clock.ascxml", "undeclared-variable", 1)
    ] * 2
    again = check(".", "--baseline", "known.json")
    assert (again.status, again.rows, again.err) == (0, [], "")
    assert check(".").status == 1, "without it everything is told"


def test_the_file_is_the_same_each_time(check: Command, tmp_path: Path) -> None:
    """Equal findings give equal files, so that a baseline can be kept under version control."""
    clock.write(tmp_path, clock=TWO)
    check(".", "--baseline", "one.json")
    check(".", "--baseline", "two.json")
    assert (tmp_path / "one.json").read_bytes() == (tmp_path / "two.json").read_bytes()


def test_moved_lines_stay_known_and_new_findings_are_reported(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    check(".", "--baseline", "known.json")
    clock.write(tmp_path, clock="<!-- a\n\n\ncomment -->\n" + clock.WRONG_CLOCK.replace("    ", "\t"))
    assert check(".", "--baseline", "known.json").rows == []
    clock.write(tmp_path, clock=clock.WRONG_CLOCK.replace('expr="count"', 'expr="conut"'))
    done = check(".", "--baseline", "known.json")
    assert (done.status, done.found) == (1, [("clock.ascxml", 10, "undeclared-variable")])


def test_one_more_equal_finding_is_reported(check: Command, tmp_path: Path) -> None:
    wrong = '            <assign location="coutn" expr="(count + 1) % 10" />\n'
    assert wrong in clock.WRONG_CLOCK
    clock.write(tmp_path, clock=clock.WRONG_CLOCK.replace(wrong, wrong * 2))
    check(".", "--baseline", "known.json")
    assert check(".", "--baseline", "known.json").rows == []
    clock.write(tmp_path, clock=clock.WRONG_CLOCK.replace(wrong, wrong * 3))
    assert check(".", "--baseline", "known.json").found == [("clock.ascxml", 11, "undeclared-variable")]


def test_it_holds_wherever_the_tool_is_called_from(
    check: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock.write(tmp_path / "models" / "clock", clock=TWO)
    check("models", "--baseline", "known.json")
    monkeypatch.chdir(tmp_path / "models")
    assert check("clock/main.xml", "--baseline", "../known.json").rows == []
    assert check(tmp_path, "--baseline", tmp_path / "known.json").rows == []


def test_an_empty_baseline_is_a_baseline(check: Command, tmp_path: Path) -> None:
    clock.write(tmp_path)
    assert check(".", "--baseline", "known.json").status == 0
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    assert check(".", "--baseline", "known.json").codes == ["undeclared-variable"]


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"[]",
        b"null",
        b'{"version": 1}',
        b'{"version": 1, "known": []}',
        b'{"version": 1, "known": {"a": 1}}',
        b'{"version": 1, "known": {"a": {"count": "many"}}}',
        b'{"version": 1, "known": {"a": {"count": 1e999}}}',
        b"\xff\xfe\x00",
        b"[" * 100_000,
    ],
)
def test_a_broken_baseline_is_wrong_use_and_stays(check: Command, tmp_path: Path, content: bytes) -> None:
    clock.write(tmp_path)
    (tmp_path / "known.json").write_bytes(content)
    done = check(".", "--baseline", "known.json")
    assert done.status == 2
    assert done.err == "as2fm-lsp: known.json: not a baseline; remove it to write a new one\n"
    assert (tmp_path / "known.json").read_bytes() == content


@pytest.mark.parametrize("target", ["missing/known.json", ".", ""])
def test_a_baseline_that_cannot_be_written_or_read(check: Command, tmp_path: Path, target: str) -> None:
    clock.write(tmp_path, clock=TWO)
    done = check(".", "--baseline", target)
    assert (done.status, done.out) == (2, "")
    assert done.err.startswith(f"as2fm-lsp: {target}: ")


TREE = '<root BTCPP_format="4"><BehaviorTree ID="A"><Repeat><AlwaysSuccess/></Repeat></BehaviorTree></root>'


def test_former_codes_of_rules(check: Command, tmp_path: Path) -> None:
    """A `Repeat` without `num_cycles`, known with the code that the rule had before."""
    (tmp_path / "tree.xml").write_text(TREE)
    assert [row["code"] for row in check("tree.xml").rows] == ["missing-port"]
    known = {"0" * 32: {"file": "tree.xml", "code": "missing-node-port", "count": 1}}
    (tmp_path / "known.json").write_text(json.dumps({"version": 1, "known": known}))
    assert check("tree.xml", "--baseline", "known.json").rows == []
    assert check("tree.xml", "--ignore", "missing-node-port").rows == []
    (tmp_path / "as2fm.toml").write_text('ignore = ["missing-node-port"]')
    assert check("tree.xml").rows == []
    (tmp_path / "as2fm.toml").write_text('severity.missing-node-port = "hint"')
    assert check("tree.xml").status == 0
    (tmp_path / "as2fm.toml").unlink()
    (tmp_path / "tree.xml").write_text(TREE.replace("<Repeat>", "<!-- as2fm: ignore[missing-node-port] --><Repeat>"))
    assert check("tree.xml").rows == []
