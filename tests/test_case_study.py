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
    assert run(["--check", "."]) == 0
    # The check finds the bug that the study shows, and nothing else.
    assert re.findall(r"(\S+?):\d+:\d+: warning: .* \[(.*)\]", capsys.readouterr().out) == [
        ("tree_with_bug.xml", "never-ticked")
    ]


def test_the_scaling_experiment(tmp_path: Path) -> None:
    script, plot = str(ROOT / "examples/scaling/run.py"), tmp_path / "scaling.svg"
    command = [sys.executable, script, "4", "300", "--behaverify", "", "--nusmv", "", "--plot", str(plot)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    rows = done.stdout.splitlines()[2:]
    assert [row.split(" | ")[0] for row in rows] == ["| 4 × 4", "| 300 × 300"]
    assert all("| 1 in [0.98" in row and "not installed" in row for row in rows)
    drawn = plot.read_text(encoding="utf-8")
    assert "as2fm-lsp verify" in drawn
    assert "CPU time (s)" in drawn


def test_the_figure_of_the_case_study(tmp_path: Path) -> None:
    """One command, without arguments, draws the property by the probability of losing the block."""
    folder = shutil.copytree(ROOT / "examples/case_study", tmp_path / "case_study")
    assert run(["experiment", str(folder / "loss.experiment.toml"), "--jobs", "1"]) == 0
    described = [
        re.findall("<desc>(.*)</desc>", file.read_text(encoding="utf-8"))
        for file in (folder / "loss.svg", ROOT / "docs/loss.svg")
    ]
    assert described[0] == described[1]
    assert "0.9 at 0.1, 0.8 at 0.2, 0.7 at 0.3" in described[0][0]
    assert "paper: 0.7 at 0.3." in described[0][0]
