# SPDX-License-Identifier: Apache-2.0
"""The page about simulation: its program runs, and its tables list the existing commands."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest

from as2fm_lsp.cli.interactive import HELP
from as2fm_lsp.cli.main import run

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/simulation.md").read_text(encoding="utf-8")


def test_the_program_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    (program,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    exec(program, {})
    out = capsys.readouterr().out
    assert out.startswith("Arm moving {'holding': True, 'way': 0}\n")
    assert "Sequence (bt_1000) ticks RetryUntilSuccessful" in out


def test_the_table_has_the_commands_of_the_help() -> None:
    table = PAGE[PAGE.index("| input |") : PAGE.index("After going back")]
    in_help = set(re.findall(r"(?:^  |   )([a-z])(?:[ ,]|$)", HELP, re.MULTILINE))
    assert in_help == set(re.findall(r"`([a-z])(?:[` ])", table))


def test_the_page_shows_what_is_printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The run of the console, up to the line `…`, and the choices at step 40."""
    monkeypatch.chdir(ROOT)
    match = re.search(r"^\$ cd (.*)\n\$ as2fm-lsp (.*)\n((?:.*\n)*?)…$", PAGE, re.MULTILINE)
    assert match
    folder, command, shown = match.groups()
    monkeypatch.chdir(folder)
    assert run(command.split()) == 0
    assert capsys.readouterr().out.startswith(shown)
    (choices,) = re.findall(r"^```text\n(step.*?)>\n```$", PAGE, re.MULTILINE | re.DOTALL)
    monkeypatch.setattr("sys.stdin", io.StringIO("g 40\n"))
    assert run([*command.split(), "--interactive"]) == 0
    assert choices in capsys.readouterr().out
