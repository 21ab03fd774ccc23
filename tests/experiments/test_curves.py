# SPDX-License-Identifier: Apache-2.0
"""Curves from traces: their bands contain the true curves, which are known in closed form, as often as promised."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import accumulate
from pathlib import Path

import pytest
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from as2fm_lsp.cli.main import run as call
from roaml.experiments.bands import BandKind
from roaml.experiments.curves import Curve, curve_plot, median_curves, traces_for, verdict_curves
from roaml.smc.model import ModelChecker
from roaml.smc.run import Options

RUNS = 300
CONFIDENCE = 0.9
LEAST_COVERED = 253
"""With a coverage of 0.9, at least this many of 300 runs are covered with a probability of 0.999."""
P = 0.2
STEPS = 12


def attempts() -> Json:
    """Each step succeeds with probability P; after STEPS steps without success, nothing is possible any more."""
    again = op("∧", op("<", "n", STEPS), op("=", "done", 0))
    tried = edge("l", way("l", P, done=1, n=op("+", "n", 1)), way("l", 1 - P, n=op("+", "n", 1)), guard=again)
    reward = {
        "op": "Emin",
        "exp": 1,
        "accumulate": ["steps"],
        "reach": op("∨", op("=", "done", 1), op("=", "n", STEPS)),
    }
    mean = {"op": "filter", "fun": "values", "values": reward, "states": {"op": "initial"}}
    properties = {"success": probability(op("F", op("=", "done", 1))), "steps": mean}
    return document(
        automaton("robot", "l", [tried]), variables=[variable("n"), variable("done")], properties=properties
    )


def walk() -> Json:
    """A counter that rises with probability P in each of STEPS steps."""
    more = op("<", "n", STEPS)
    step = edge("l", way("l", P, x=op("+", "x", 1), n=op("+", "n", 1)), way("l", 1 - P, n=op("+", "n", 1)), guard=more)
    properties = {"end": probability(op("F", op("=", "n", STEPS)))}
    return document(automaton("robot", "l", [step]), variables=[variable("n"), variable("x")], properties=properties)


def success_until(step: float) -> float:
    return 1 - (1 - P) ** math.floor(step)


def steps_until(step: float) -> float:
    return 1.0 if step >= STEPS else success_until(step)


def median_at(step: float) -> int:
    n = math.floor(step)
    chances = [math.comb(n, k) * P**k * (1 - P) ** (n - k) for k in range(n + 1)]
    return next(k for k, total in enumerate(accumulate(chances)) if total >= 0.5 - 1e-12)


def is_inside(curve: Curve, truth: Callable[[float], float], until: float = math.inf) -> list[bool]:
    return [p.low - 1e-12 <= truth(p.x) <= p.high + 1e-12 for p in curve.points if p.x <= until]


def options(seed: int, traces: int = 100) -> Options:
    return Options(confidence=CONFIDENCE, seed=seed, max_traces=traces)


@pytest.mark.parametrize(("name", "truth"), [("success", success_until), ("steps", steps_until)])
def test_distributions_are_covered(name: str, truth: Callable[[float], float]) -> None:
    checker = ModelChecker(model(attempts()))
    (property_,) = (p for p in checker.compiled_properties if p.question.name == name)
    whole, third = 0, 0
    for seed in range(RUNS):
        curve = verdict_curves(checker, property_, options(seed), None)[0]
        whole += all(is_inside(curve, truth))
        pointwise = verdict_curves(checker, property_, options(seed), None, BandKind.POINTWISE)[0]
        (at_three,) = (p for p in pointwise.points if p.x == 3)
        third += at_three.low <= truth(3) <= at_three.high
        assert [p.value for p in curve.points] == [p.value for p in pointwise.points]
    assert whole >= LEAST_COVERED
    assert third >= LEAST_COVERED


def test_medians_are_covered() -> None:
    checker = ModelChecker(model(walk()))
    whole, sixth = 0, 0
    for seed in range(RUNS):
        whole += all(is_inside(median_curves(checker, "x", options(seed, 40), None)[0], median_at))
        pointwise = median_curves(checker, "x", options(seed, 40), None, BandKind.POINTWISE)[0]
        sixth += is_inside(pointwise, median_at, until=7)[-1]
    assert whole >= LEAST_COVERED
    assert sixth >= LEAST_COVERED


def test_cut_traces_widen_the_band() -> None:
    """The true curve is inside although most traces are cut before they succeed."""
    checker = ModelChecker(model(attempts()))
    cut = Options(confidence=CONFIDENCE, max_traces=200, max_steps=3)
    (property_,) = (p for p in checker.compiled_properties if p.question.name == "success")
    (curve,) = verdict_curves(checker, property_, cut, None)
    assert curve.undecided > 50
    assert "traces were cut" in curve.band_words
    assert curve.points[-1].high == 1
    median, *_ = median_curves(checker, "n", cut, None)
    assert median.points[-1].high >= 3


def test_simultaneous_bands_are_wider_and_named() -> None:
    checker = ModelChecker(model(attempts()))
    property_ = checker.compiled_properties[0]
    widths = {}
    for band in BandKind:
        curve = verdict_curves(checker, property_, options(1), None, band)[0]
        widths[band] = max(p.high - p.low for p in curve.points)
        assert band.value in curve_plot("t", (curve,)).notes[0]
    assert widths[BandKind.SIMULTANEOUS] > widths[BandKind.POINTWISE]


def test_verdicts_of_a_property_are_dashed_lines_of_one_color() -> None:
    """A line of traces that fail ends where they are decided: `fails` alone would be read as "until then"."""
    checker = ModelChecker(model(attempts()))
    (property_,) = (p for p in checker.compiled_properties if p.question.name == "success")
    curves = verdict_curves(checker, property_, options(1), None)
    assert [curve.name for curve in curves] == ["success: decided, holds", "success: decided, fails"]
    first, second = curve_plot("t", curves).series
    assert (first.is_dashed, second.is_dashed) == (False, True)
    assert first.subject == second.subject == "success"


def test_the_number_of_traces() -> None:
    assert traces_for(Options(epsilon=0.05)) == math.ceil(math.log(40) / (2 * 0.05**2))
    assert traces_for(Options(epsilon=0.05, max_traces=100)) == 100


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    import json  # noqa: PLC0415

    monkeypatch.chdir(tmp_path)
    Path("walk.jani").write_text(json.dumps(walk()), encoding="utf-8")
    assert call(["verify", "walk.jani", "--plot", "curves.html", "--over-time", "x", "--band", "pointwise"]) == 0
    page = Path("curves.html").read_text(encoding="utf-8")
    assert "Probability that the property is decided by this time" in page
    assert "median of x" in page
    assert "the shaded band contains each value by itself with 0.95" in page
    assert call(["verify", "walk.jani", "--plot", "curves.svg", "--over-time", "y"]) == 2
    assert "there is no variable `y`" in capsys.readouterr().err
