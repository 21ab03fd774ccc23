# SPDX-License-Identifier: Apache-2.0
"""Options of `verify` that make further traces end also on models whose traces never end: the limit on the steps of all
traces together decides how many there are."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from smc_models import automaton, document, edge, op, variable, way

from as2fm_lsp.cli.main import run
from roaml.smc import affordable as module
from roaml.smc.affordable import affordable
from roaml.smc.lss import LEAST_SCHEDULERS, affordable_schedulers

TRACE_STEPS = 1_000
MAX_STEPS = 200_000


@pytest.fixture
def endless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A model that counts for ever, by one or by two, and a limit of 200 traces of 1,000 steps."""
    monkeypatch.setattr(module, "MAX_STEPS", MAX_STEPS)
    monkeypatch.setattr("roaml.experiments.curves.MEDIAN_STEPS", MAX_STEPS)
    counts = [edge("run", way("run", 1, x=op("+", "x", number))) for number in (1, 2)]
    path = tmp_path / "model.jani"
    path.write_text(
        json.dumps(document(automaton("robot", "run", counts), variables=[variable("x")])), encoding="utf-8"
    )
    return str(path)


def test_quantiles_of_endless_traces(endless: str, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["verify", endless, "--property", 'R{"steps"}=? [ F x<0 ]', "--quantiles", "0.5", "--max-states", "50"]
    asked += ["--max-steps", str(TRACE_STEPS)]
    assert run(asked) in (0, 1)
    assert (
        "50 % of the traces: no limit is known, because all were cut after 1,000 steps; from 200 traces with uniform "
        "choices (200 instead of 10,000 traces, because they are long; set max_traces for more)\n"
    ) in capsys.readouterr().out
    run([*asked, "--max-traces", "300"])
    assert "cut after 1,000 steps; from 300 traces with uniform choices\n" in capsys.readouterr().out


def test_plots_of_endless_traces(endless: str, tmp_path: Path) -> None:
    plot = tmp_path / "plot.html"
    asked = ["verify", endless, "--property", "P=? [ F x=700 ]", "--property", 'R{"steps"}=? [ F x=700 ]']
    asked += ["--max-states", "50", "--max-steps", str(TRACE_STEPS), "--plot", str(plot), "--over-time", "x"]
    assert run(asked) in (0, 1)
    written = [path.read_text(encoding="utf-8") for path in sorted(tmp_path.glob("plot*.html"))]
    for wanted in ("1,000", "4,612"):  # for the median, and for the width of a band
        assert any(f" instead of {wanted} traces, because they are long; set max_traces" in text for text in written)


def test_the_search_for_schedulers_of_endless_traces(endless: str, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["verify", endless, "--property", "P=? [ F x<0 ]", "--scheduler", "lss", "--max-steps", str(TRACE_STEPS)]
    assert run(asked) in (0, 1)
    tried = affordable_schedulers(324, TRACE_STEPS)
    assert f"{tried:,} schedulers were tried" in capsys.readouterr().out


def test_the_number_of_schedulers(monkeypatch: pytest.MonkeyPatch) -> None:
    """All of them if traces are short, and at least a few."""
    monkeypatch.setattr(module, "MAX_STEPS", MAX_STEPS)
    assert affordable_schedulers(324, 1.0) == 324
    assert affordable_schedulers(324, 1e9) == LEAST_SCHEDULERS
    assert affordable_schedulers(2, 1e9) == 2
    numbers = [affordable_schedulers(324, length) for length in (0.0, 1.0, 10.0, 100.0, 1_000.0, 10_000.0)]
    assert numbers == sorted(numbers, reverse=True)
    assert len(set(numbers)) > 3


def test_the_number_of_traces_depends_on_further_traces_only() -> None:
    asked: list[int] = []

    def steps_of(trace: int) -> int:
        asked.append(trace)
        return 10 * (trace - 999)

    chosen = affordable(1_000, 5, steps_of, 600)
    assert (chosen.traces, asked) == (600 // 30, [1_000, 1_001, 1_002, 1_003, 1_004])
    assert chosen.remark == "20 instead of 1,000 traces, because they are long; set max_traces for more"
    assert affordable(1_000, 50, steps_of, 600).traces == 50
    assert affordable(10, 5, lambda _: 0, 600).remark == ""
