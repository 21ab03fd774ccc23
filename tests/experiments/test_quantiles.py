# SPDX-License-Identifier: Apache-2.0
"""Quantiles of rewards: closed forms of the geometric distribution, ranks by SciPy, and the coverage of intervals."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path

import pytest
from scipy.stats import binom
from smc_models import automaton, document, edge, variable, way

from as2fm_lsp.cli.main import run
from roaml.experiments.quantiles import quantiles_of
from roaml.experiments.traces import TraceEnd
from roaml.smc.program import FALSE, TRUE, UNKNOWN


def ends(count: int, seed: int) -> list[TraceEnd]:
    """Traces that never arrive with the probability 0.2, and otherwise after a geometric number of steps."""
    chance = random.Random(seed)
    return [
        TraceEnd(FALSE, 0.0, 0.0)
        if chance.random() < 0.2
        else TraceEnd(TRUE, 0.0, 1.0 + math.floor(math.log(chance.random()) / math.log(0.7)))
        for _ in range(count)
    ]


def truth(share: float) -> float:
    """The quantile of the geometric distribution with 0.3."""
    return math.ceil(math.log(1 - share) / math.log(0.7) - 1e-12)


def test_coverage() -> None:
    """All intervals together are right in at least as many of 300 runs as the confidence of 0.9 promises; more than 48
    failures have a probability below 0.001."""
    shares = (0.5, 0.75, 0.9)
    failures = conditional_failures = 0
    for seed in range(300):
        sample = ends(300, seed)
        expected = [truth(share / 0.8) if share < 0.8 else math.inf for share in shares]
        for is_conditional, values in ((False, expected), (True, [truth(share) for share in shares])):
            quantiles = quantiles_of(sample, shares, 0.9, is_conditional=is_conditional)
            failed = any(not q.low <= value <= q.high for q, value in zip(quantiles, values, strict=True))
            failures += failed and not is_conditional
            conditional_failures += failed and is_conditional
    assert failures <= 48
    assert conditional_failures <= 48


@pytest.mark.parametrize("share", [0.05, 0.5, 0.99])
@pytest.mark.parametrize("count", [1, 10, 1000])
def test_ranks(count: int, share: float) -> None:
    """The ends are the order statistics that the binomial distribution of SciPy determines."""
    sample = [TraceEnd(TRUE, 0.0, float(rank)) for rank in range(1, count + 1)]
    (quantile,) = quantiles_of(sample, [share], 0.95, is_conditional=False)
    low = max((r for r in range(1, count + 1) if binom.cdf(r - 1, count, share) <= 0.025), default=-math.inf)
    high = min((r for r in range(1, count + 1) if binom.sf(r - 1, count, share) <= 0.025), default=math.inf)
    assert (quantile.low, quantile.high) == (low, high)
    assert quantile.value == math.ceil(share * count - 1e-9)


def test_cut_traces_may_have_any_reward() -> None:
    known = [TraceEnd(TRUE, 0.0, float(rank)) for rank in range(1, 901)]
    whole = quantiles_of(known + [TraceEnd(TRUE, 0.0, 1000.0)] * 100, [0.5], 0.95, is_conditional=False)[0]
    low = quantiles_of([TraceEnd(TRUE, 0.0, 0.0)] * 100 + known, [0.5], 0.95, is_conditional=False)[0]
    cut = quantiles_of(known + [TraceEnd(UNKNOWN, 0.0, 5.0)] * 100, [0.5], 0.95, is_conditional=False)[0]
    assert (cut.low, cut.high) == (low.low, whole.high)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    steps = edge("run", way("good", 0.3, done=1), way("run", 0.7))
    robot = automaton("robot", "run good", [steps])
    path = tmp_path / "model.jani"
    path.write_text(json.dumps(document(robot, variables=[variable("done")])), encoding="utf-8")
    asked = ["verify", str(path), "--property", 'R{"steps"}=? [ F done=1 ]', "--quantiles", "0.5,0.9"]
    assert run(asked) == 0
    printed = capsys.readouterr().out
    assert (
        "\n  50 % of the traces: at most about 2 (an estimate; the true limit is from 2 to 3); from 10,000 traces with "
        in printed
    )
    assert "\n  90 % of the traces: at most 7; from 10,000 traces with uniform choices\n" in printed
    assert run([*asked, "--format", "json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["results"]
    assert [(q["share"], q["value"]) for q in row["quantiles"]] == [(0.5, truth(0.5)), (0.9, truth(0.9))]
    assert run([*asked[:-1], "1.5"]) == 2
    assert "expected shares greater than 0 and less than 1" in capsys.readouterr().err


def test_an_interruption_of_the_quantiles_keeps_the_values(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The traces of quantiles can take far longer than exact values."""
    steps = edge("run", way("good", 0.5, done=1), way("run", 0.5))
    path = tmp_path / "model.jani"
    model = document(automaton("robot", "run good", [steps]), variables=[variable("done")])
    path.write_text(json.dumps(model), encoding="utf-8")

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("roaml.experiments.quantiles.reward_quantiles", interrupted)
    assert run(["verify", str(path), "--property", 'R{"steps"}=? [ F done=1 ]', "--quantiles", "0.5"]) > 3
    done = capsys.readouterr()
    assert "(expected value): = 2 for all schedulers, exact" in done.out
    assert "quantiles are missing, because their traces were interrupted" in done.err
