# SPDX-License-Identifier: Apache-2.0
"""The case study has the results in `docs/case-study.md`, and the script of the scaling experiment runs."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from test_readme import without_time

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "docs/case-study.md").read_text(encoding="utf-8")
_COMMAND = re.compile(r"^\$ as2fm-lsp (.*)\n((?:(?!\$|```).*\n)*)", re.MULTILINE)


def test_its_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(ROOT / "examples/case_study", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    commands = _COMMAND.findall(TEXT)
    assert len(commands) == 5
    for command, printed in commands:
        assert run(shlex.split(command)) == 0
        assert without_time(capsys.readouterr().out) == without_time(printed)
    assert len(list((tmp_path / "scxml").iterdir())) == 14
    assert run(["--check", ".", "--warnings-as-errors"]) == 0


def test_the_scaling_experiment(tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "examples/scaling/run.py"), "3", "4", "--behaverify", "", "--nusmv", ""]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    rows = done.stdout.splitlines()[2:]
    assert [row.split(" | ")[0] for row in rows] == ["| 3 × 3", "| 4 × 4"]
    assert all("| 1 in [0.98" in row and "not installed" in row for row in rows)
