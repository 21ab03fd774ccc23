# SPDX-License-Identifier: Apache-2.0
"""Derivatives of exact probabilities, compared with closed forms and with differences of exact values."""

from __future__ import annotations

import pytest
from hypothesis import given
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way
from smc_random import networks
from test_grid import parametric, with_constants

from roaml.api.experimenting import ParametricJani
from roaml.experiments.derivatives import NoDerivativeError, derivative
from roaml.experiments.grid import ExperimentOptions, Grid, shared_points
from roaml.experiments.sweeps import sweeps_of


def gambler() -> Json:
    """A counter from 2 that rises with probability p, falls with probability p q, and stays otherwise, up to 5."""
    inner = op("∧", op(">", "x", 0), op("<", "x", 5))
    up = way("l", "p", x=op("+", "x", 1))
    down = way("l", op("*", "p", "q"), x=op("-", "x", 1))
    rest = way("l", op("-", op("-", 1, "p"), op("*", "p", "q")))
    written = document(
        automaton("m", "l", [edge("l", up, down, rest, guard=inner)]),
        variables=[variable("x", "int", 2)],
        properties={
            "won": probability(op("F", op("=", "x", 5))),
            "safe": probability(op("G", op(">", "x", 0)), "Pmax"),
        },
    )
    return with_constants(written, p="real", q="real")


def test_a_closed_form() -> None:
    """The probability to win is (1 - q²) / (1 - q⁵): it does not depend on p."""
    grid = Grid(
        ParametricJani(model(gambler()), ""),
        sweeps_of(["p=0.2,0.3,0.4", "q=0.5,0.7,0.8"]),
        ("won",),
        ExperimentOptions(),
    )
    space = grid._parametric("won", grid.settings)
    assert space is not None
    for setting in grid.settings:
        q = float(dict(setting)["q"])
        found = derivative(space, setting, ["p", "q"])
        assert found.value == pytest.approx((1 - q**2) / (1 - q**5), abs=1e-9)
        slope = (-2 * q * (1 - q**5) + 5 * q**4 * (1 - q**2)) / (1 - q**5) ** 2
        assert dict(found.slopes)["q"] == pytest.approx(slope, abs=1e-6)
        assert dict(found.slopes)["p"] == pytest.approx(0, abs=1e-6)
    space = grid._parametric("safe", grid.settings)
    assert space is not None
    safe = derivative(space, grid.settings[0], ["q"])
    won = derivative(grid._parametric("won", grid.settings), grid.settings[0], ["q"])  # type: ignore[arg-type]
    assert safe.slopes[0][1] == pytest.approx(won.slopes[0][1], abs=1e-6)


def test_no_derivative_is_a_negative_zero() -> None:
    """A property that holds or fails, whatever the parameter is, also if it is negated."""
    written = gambler()
    written["properties"] = document(properties={"low": probability(op("G", op("<", "x", 9)))})["properties"]
    grid = Grid(
        ParametricJani(model(written), ""),
        sweeps_of(["p=0.2,0.3", "q=0.5"]),
        ("low",),
        ExperimentOptions(has_slopes=True),
    )
    assert [str(slope) for point in grid.points() for _, slope in point.slopes] == ["0.0", "0.0"]


@given(networks())
def test_differences_of_exact_values(written: Json) -> None:
    grid = Grid(
        ParametricJani(model(parametric(written)), ""),
        sweeps_of(["p=0.3,0.5,0.7", "q=0.4,0.6"]),
        ("p",),
        ExperimentOptions(),
    )
    space = grid._parametric("p", grid.settings)
    if space is None:
        return
    setting = (("p", "0.45"), ("q", "0.55"))
    try:
        found = derivative(space, setting, ["p", "q"])
    except NoDerivativeError:
        return
    for name, slope in found.slopes:
        values = []
        for shift in (-2e-3, -1e-3, 1e-3, 2e-3):
            moved = tuple((key, repr(float(value) + shift) if key == name else value) for key, value in setting)
            (point,) = shared_points(space, [moved], grid.options)
            values.append(point.maximum or 0.0)
        # The difference of fourth order.
        difference = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / 12e-3
        assert slope == pytest.approx(difference, abs=1e-6, rel=1e-6)


def test_schedulers_that_differ() -> None:
    written = gambler()
    written["automata"][0]["edges"].append(edge("l", way("l", x=0), guard=op("=", "x", 2)))
    grid = Grid(
        ParametricJani(model(written), ""), sweeps_of(["p=0.2,0.3,0.4", "q=0.5"]), ("won",), ExperimentOptions()
    )
    space = grid._parametric("won", grid.settings)
    assert space is not None
    with pytest.raises(NoDerivativeError, match="schedulers have different values"):
        derivative(space, grid.settings[0], ["p"])


def test_points_without_derivatives_state_the_reason() -> None:
    options = ExperimentOptions(has_slopes=True)
    grid = Grid(ParametricJani(model(gambler()), ""), sweeps_of(["p=0.2,0.3", "q=0,0.5"]), ("won",), options)
    points = {point.setting: point for point in grid.points()}
    inner = points[("p", "0.2"), ("q", "0.5")]
    assert dict(inner.slopes)["p"] == pytest.approx(0, abs=1e-6)
    assert len(inner.slopes) == 2
    border = points[("p", "0.2"), ("q", "0")]
    assert (border.slopes, border.value) == ((), pytest.approx(1))
    assert "a probability is 0 or 1 here" in border.note
    grid = Grid(ParametricJani(model(gambler()), ""), sweeps_of(["p=0.2", "q=0.5"]), ("won",), options)
    (alone,) = grid.points()
    assert (
        alone.note
        == "no derivative: no parameter has several values; give the one to derive by at least two, such as 0.3,0.31"
    )
