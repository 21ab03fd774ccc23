# SPDX-License-Identifier: Apache-2.0
"""The values at the points of a grid, compared with those of Storm, with separate searches, and with the values under
other numbers of processes."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way
from smc_random import networks
from storm import exact as storm_exact

from roaml import api
from roaml.api.experimenting import ParametricJani
from roaml.experiments.grid import ExperimentOptions, Grid, shared_points
from roaml.experiments.points import ExperimentPoint, PointKind, Schedulers
from roaml.experiments.results import ExperimentResult
from roaml.experiments.sweeps import sweeps_of
from roaml.smc.run import EstimationMethod, Options


def with_constants(written: Json, **types: str) -> Json:
    return {**written, "constants": [{"name": name, "type": type_} for name, type_ in types.items()]}


def retry() -> Json:
    """A robot tries up to `tries` times; each attempt succeeds with probability p, and a success is lost with
    probability q. It may also wait for a while, or give up, so schedulers differ."""
    attempt = [
        way("try", op("*", "p", op("-", 1, "q")), n=op("+", "n", 1), done=1),
        way("try", op("*", "p", "q"), n=op("+", "n", 1)),
        way("try", op("-", 1, "p"), n=op("+", "n", 1)),
    ]
    more = op("∧", op("<", "n", "tries"), op("=", "done", 0))
    edges = [edge("try", *attempt, guard=more), edge("try", way("idle"), guard=op(">", "n", 1))]
    robot = automaton("robot", "try idle", edges, [])
    properties = {
        "least": probability(op("F", op("=", "done", 1))),
        "most": probability(op("F", op("=", "done", 1)), "Pmax"),
        "never": probability(op("G", op("=", "done", 0)), "Pmax"),
    }
    written = document(robot, variables=[variable("n"), variable("done")], properties=properties)
    return with_constants(written, p="real", q="real", tries="int")


def write(folder: Path, written: Json) -> str:
    path = folder / "model.jani"
    path.write_text(json.dumps(written), encoding="utf-8")
    return str(path)


def values(result: ExperimentResult) -> dict[tuple[str, ...], float]:
    return {(point.name, *(value for _, value in point.setting)): point.value for point in result.points}


def separate(path: str, result: ExperimentResult) -> list[ExperimentPoint]:
    """The points of a result, each computed alone."""
    points = []
    for point in result.points:
        sweeps = {name: [value] for name, value in point.setting}
        points += api.experiment(path, sweeps, [point.name], result.options).points
    return points


def test_values_agree_with_closed_forms_and_with_storm(tmp_path: Path) -> None:
    path = write(tmp_path, retry())
    result = api.experiment(path, ["p=0.1:0.2:0.9", "q=0,0.05,1/3", "tries=3"])
    assert len(result.points) == 5 * 3 * 3
    for point in result.points:
        setting = dict(point.setting)
        p, q = (float(api_number(setting[name])) for name in ("p", "q"))
        least, most = 1 - (1 - p * (1 - q)) ** 2, 1 - (1 - p * (1 - q)) ** 3
        expected = {"least": least, "most": most, "never": 1 - least}[point.name]
        assert point.value == pytest.approx(expected, abs=1e-9), point
        assert point.kind is PointKind.EXACT
        assert point.schedulers is (Schedulers.MINIMUM if point.name == "least" else Schedulers.MAXIMUM)
    fixed = {"p": 0.3, "q": 0.05, "tries": 3}
    known = json.loads(json.dumps(retry()))
    for constant in known["constants"]:
        constant["value"] = fixed[constant["name"]]
    storm = storm_exact(model(known), "least")
    assert result.point("least", p="0.3", q="0.05").minimum == pytest.approx(storm.least, abs=1e-6)
    assert result.point("least", p="0.3", q="0.05").maximum == pytest.approx(storm.greatest, abs=1e-6)


def api_number(text: str) -> Any:
    numerator, _, denominator = text.partition("/")
    return float(numerator) / float(denominator or 1)


def parametric(written: Json) -> Json:
    """A random network whose probabilities are p and 1 - p, or the product of two constants and the rest."""
    text = json.dumps(written)
    number = 0
    while '"exp": 0.25' in text:
        first, second = (("p", op("-", 1, "p")), (op("*", "p", "q"), op("-", 1, op("*", "p", "q"))))[number % 2]
        text = text.replace('"exp": 0.25', f'"exp": {json.dumps(first)}', 1)
        text = text.replace('"exp": 0.75', f'"exp": {json.dumps(second)}', 1)
        number += 1
    return with_constants(json.loads(text), p="real", q="real")


@given(networks())
def test_shared_states_have_the_values_of_separate_searches(written: Json) -> None:
    subject = ParametricJani(model(parametric(written)), "")
    grid = Grid(subject, sweeps_of(["p=0.2,0.5,0.9", "q=0.1,0.5"]), ("p",), ExperimentOptions())
    space = grid._parametric("p", grid.settings)
    if space is None:
        return
    together = list(shared_points(space, grid.settings, grid.options))
    assert [point.setting for point in together] == grid.settings
    for point in together:
        alone = Grid(subject, sweeps_of([f"{n}={v}" for n, v in point.setting]), ("p",), grid.options)
        (other,) = alone.points()
        assert point.minimum == pytest.approx(other.minimum, abs=1e-9)
        assert point.maximum == pytest.approx(other.maximum, abs=1e-9)
        assert point.states == other.states


def test_many_random_networks_share_their_states() -> None:
    """The test above does not compare nothing: the states of some networks are shared."""
    shared = []

    @given(networks())
    def collect(written: Json) -> None:
        subject = ParametricJani(model(parametric(written)), "")
        grid = Grid(subject, sweeps_of(["p=0.2,0.5,0.9", "q=0.1,0.5"]), ("p",), ExperimentOptions())
        space = grid._parametric("p", grid.settings)
        shared.append(space is not None and bool(space.numbers))

    collect()
    assert sum(shared) >= 10


def test_probabilities_of_0_and_1_have_states_of_their_own(tmp_path: Path) -> None:
    """For p = 0, the robot never succeeds, and for p = 1 it never fails: these points are explored alone."""
    path = write(tmp_path, retry())
    result = api.experiment(path, ["p=0:0.25:1", "q=0.5", "tries=2"], ["most"])
    assert [point.value for point in result.points] == pytest.approx([0, 0.234375, 0.4375, 0.609375, 0.75])
    assert [point.value for point in result.points] == [point.value for point in separate(path, result)]


def test_a_constant_in_a_guard_is_not_shared(tmp_path: Path) -> None:
    path = write(tmp_path, retry())
    result = api.experiment(path, ["p=0.5", "q=0", "tries=1:4"], ["most"])
    assert [point.value for point in result.points] == pytest.approx([0.5, 0.75, 0.875, 0.9375])
    written = retry()
    written["automata"][0]["edges"][1]["guard"] = {"exp": op(">", "n", op("*", 10, "p"))}
    subject = ParametricJani(model(written), "")
    assert subject.chances({"p": (0.1, 0.9)}, (("q", "0"), ("tries", "3"))) is None
    assert subject.chances({"q": (0.1, 0.9)}, (("p", "0.5"), ("tries", "3"))) is not None


def test_estimates_do_not_depend_on_processes_or_interruptions(tmp_path: Path) -> None:
    path = write(tmp_path, retry())
    sampling = Options(method=EstimationMethod.FIXED, max_traces=500)
    options = ExperimentOptions(sampling, exact=False)
    sweeps = ["p=0.1:0.2:0.9", "q=0.1", "tries=3"]
    alone = api.experiment(path, sweeps, ["most"], options)
    assert {point.kind for point in alone.points} == {PointKind.ESTIMATE}
    assert api.experiment(path, sweeps, ["most"], options, jobs=2).points == alone.points
    with ThreadPoolExecutor(2) as executor:
        assert api.experiment(path, sweeps, ["most"], options, jobs=2, executor=executor).points == alone.points
    new: list[ExperimentPoint] = []
    continued = api.experiment(
        path, sweeps, ["most"], options, known=alone.points[1:4], watch=lambda point, *_: new.append(point)
    )
    assert continued.points == alone.points
    assert len(new) == 2
    # Common random numbers: more probable successes succeed in the same traces, and in further ones.
    ordered = [point.value for point in alone.points]
    assert ordered == sorted(ordered)


def test_points_without_a_value_state_the_reason(tmp_path: Path) -> None:
    written = retry()
    written["properties"].append({"name": "nested", "expression": probability(op("F", op("X", op("=", "n", 1))))})
    path = write(tmp_path, written)
    result = api.experiment(path, ["p=0.5", "q=0", "tries=2,3"], ["nested"])
    assert {point.kind for point in result.points} == {PointKind.UNKNOWN}
    assert all(point.note for point in result.points)
    small = ExperimentOptions(is_exhaustive=True, max_states=2)
    result = api.experiment(path, ["p=0.5", "q=0", "tries=2,3"], ["most"], small)
    assert all("max-states" in point.note for point in result.points)


@pytest.mark.parametrize(
    ("sweeps", "error"),
    [
        (["p=0.5", "q=0", "tires=2"], "there is no constant `tires`"),
        (["p=0.5", "q=0", "tries=0.5"], "must be a whole number"),
    ],
)
def test_wrong_parameters(tmp_path: Path, sweeps: list[str], error: str) -> None:
    with pytest.raises(api.ConstantError) as raised:
        api.experiment(write(tmp_path, retry()), sweeps)
    assert error in str(raised.value)
