# SPDX-License-Identifier: Apache-2.0
"""Models that are small only after reductions are answered exactly without `--exhaustive`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from loose_networks import networks
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way

from as2fm_lsp.cli.main import run
from as2fm_lsp.verification.known_results import short
from examples import examples
from roaml import api
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, StateLimits, explore
from roaml.explicit.values import NoValueError, values_of
from roaml.record import replace
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.smc.statistics import Bounds
from roaml.verification import small
from roaml.verification.exhaustive import alone
from roaml.verification.small import LIMITS, attempt, choices_of
from roaml.verification.suggestions import suggestions

TOLERANCE = 2e-8


def counters(choice: list[Json], parts: int = 7) -> Json:
    """10ⁿ states for each state of an automaton with the edges `choice`, from which it goes to `m` or `n`. The
    property asks whether x becomes 1."""
    count = edge("l", way("l", own=op("+", "own", 1)), guard=op("<", "own", 9))
    automata = [automaton(f"c{i}", "l", [count], [variable("own")]) for i in range(parts)]
    automata.append(automaton("d", "l m n", choice))
    return document(*automata, variables=[variable("x")], properties={"p": probability(op("F", op("=", "x", 1)))})


TOSS = [edge("l", way("m", 0.5, x=1), way("n", 0.5))]
CHOICE = [edge("l", way("m", x=1)), edge("l", "n")]


def overlap(one: Bounds, other: Bounds) -> bool:
    return max(one.lower, other.lower) <= min(one.upper, other.upper) + TOLERANCE


def test_values_after_reductions_are_those_of_all_states() -> None:
    known: list[bool] = []

    @given(networks())
    @settings(max_examples=examples(150), deadline=None)
    def check(written: Json) -> None:
        checker = ModelChecker(model(written))
        if checker.refused:
            return
        property_ = checker.compiled_properties[0]
        reduced_checker, reduced_property = alone(checker, property_)
        if not can_be_reduced(reduced_checker.program, reduced_property.goal):
            return
        try:
            whole = explore(reduced_checker, reduced_property, StateLimits(reduces=False))
            merged = explore(reduced_checker, reduced_property, StateLimits())
            reduced = explore(reduced_checker, reduced_property, StateLimits(), is_reduced=True)
            expected = values_of(whole)
        except (FaultError, LimitError, NoValueError):
            return
        if whole.problem is not None or merged.states <= reduced.states:
            return
        tried = attempt(checker, property_, replace(LIMITS, states=reduced.states))
        exact = tried.exact
        if exact is None:  # the value is not precise
            assert not tried.reason
            return
        assert exact is not None
        assert (exact.is_reduced, exact.states) == (True, reduced.states)
        assert overlap(exact.minimum, expected.minimum)
        assert overlap(exact.maximum, expected.maximum)
        if exact.uniform is not None:
            assert expected.uniform is not None
            assert overlap(exact.uniform, expected.uniform)
            assert choices_of(exact).agreement.endswith(" after reductions")
        else:
            assert choices_of(exact).differ
        known.append(exact.uniform is not None)

    check()
    assert any(known)
    assert not all(known)


def test_the_number_of_transitions_is_limited() -> None:
    counts = edge("l", way("l", 0.5, n=op("+", "n", 1)), way("m", 0.5, x=1), guard=op("<", "n", 100))
    written = counters([counts])
    written["variables"].append(variable("n"))
    checker = ModelChecker(model(written))
    (property_,) = checker.compiled_properties
    exact = attempt(checker, property_, LIMITS).exact
    assert exact is not None
    assert exact.is_reduced
    assert exact.states > 100
    assert attempt(checker, property_, replace(LIMITS, transitions=100)).exact is None


def count_to(end: int) -> list[Json]:
    """`end` states in a row, then the end. Every hundredth one has two successors."""
    is_hundredth = op("=", op("%", "n", 100), 0)
    following = op("+", "n", 1)
    return [
        edge("l", way("l", n=following), guard=op("∧", op("<", "n", end), op("¬", is_hundredth))),
        edge("l", way("l", 0.5, n=following), way("m", 0.5), guard=op("∧", op("<", "n", end), is_hundredth)),
        edge("l", way("m", x=1), guard=op("=", "n", end)),
    ]


@pytest.mark.parametrize(
    ("end", "parts", "searches", "is_reduced"),
    [
        (11, 2, ["all"], False),
        (101, 2, ["all"], False),
        (11, 7, ["all", "reduced"], True),
        (60_001, 1, ["all", "reduced"], True),
        (200_001, 1, ["all", "reduced"], None),
    ],
)
def test_choices_are_left_out_if_there_are_too_many_states(
    monkeypatch: pytest.MonkeyPatch, end: int, parts: int, searches: list[str], is_reduced: bool | None
) -> None:
    seen: list[str] = []

    def recorded(*arguments: Any, is_reduced: bool = False, **options: Any) -> Any:
        seen.append("reduced" if is_reduced else "all")
        return explore(*arguments, is_reduced=is_reduced, **options)

    monkeypatch.setattr(small, "explore", recorded)
    written = counters(count_to(end), parts)
    written["variables"].append(variable("n"))
    checker = ModelChecker(model(written))
    exact = attempt(checker, checker.compiled_properties[0], LIMITS).exact
    assert seen == searches
    assert (None if exact is None else exact.is_reduced) is is_reduced


def test_states_of_cycles_do_not_make_a_model_large() -> None:
    """A path of steps without end is followed up to a limit: the states in it are passed repeatedly."""
    turn = edge("s", way("s", c=op("%", op("+", "c", 1), 100)))
    written = document(
        automaton("busy", "s", [turn], [variable("c")]),
        automaton("worker", "l m", count_to(150)),
        variables=[variable("n"), variable("x")],
        properties={"p": probability(op("F", op("=", "x", 1)), "Pmax")},
    )
    checker = ModelChecker(model(written))
    exact = attempt(checker, checker.compiled_properties[0], LIMITS).exact
    assert exact is not None
    assert (exact.is_reduced, exact.states) == (False, 15_300)


def test_properties_that_cannot_be_reduced_are_left_to_traces() -> None:
    written = counters(TOSS)
    bounded = {**op("F", op("=", "x", 1)), "step-bounds": {"upper": 10_000}}
    written["properties"][0]["expression"] = probability(bounded)
    checker = ModelChecker(model(written))
    assert attempt(checker, checker.compiled_properties[0], LIMITS).exact is None


# ------------------------------------------------------------------ reports


def write(folder: Path, written: Json) -> str:
    file = folder / "model.jani"
    file.write_text(json.dumps(written), encoding="utf-8")
    return str(file)


def text_of(capsys: pytest.CaptureFixture[str], *arguments: str, status: int = 0) -> str:
    assert run(["verify", *arguments]) == status
    return capsys.readouterr().out


def row_of(capsys: pytest.CaptureFixture[str], *arguments: str, status: int = 0) -> dict[str, Any]:
    (row,) = json.loads(text_of(capsys, *arguments, "--format", "json", status=status))["results"]
    return dict(row)


def test_equal_extremes_are_the_value_for_all_schedulers(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = write(tmp_path, counters(TOSS))
    lines = text_of(capsys, file, "--expect", "p = 0.5", "--verbose").splitlines()
    assert lines[0].startswith("p: = 0.5 for all schedulers, exact, 4 states after reductions, ")
    assert lines[1] == "  `x = 1` holds at some time."
    assert lines[3].startswith("  ends of 200 random traces: ")
    assert lines[4] == "  expected = 0.5: met"
    assert lines[5:] == [
        "exact values, computed from all reachable states: minimum and maximum over all schedulers, value under "
        "uniform choices; reductions left out choices that do not change these values; use --method adaptive for "
        "estimates from traces"
    ]
    row = row_of(capsys, file)
    assert (row["method"], row["probability"], row["traces"]) == ("exact", 0.5, 200)
    assert (row["exact"]["uniform"], row["exact"]["reduced"]) == (0.5, True)
    assert "uniform" not in row
    uniform = text_of(capsys, file, "--scheduler", "uniform", "--verbose")
    assert uniform.startswith("p: = 0.5 for all schedulers, exact, ")
    closing = (
        "exact values, computed from all reachable states: minimum and maximum over all schedulers, which are equal"
    )
    assert f"\n{closing}; reductions" in uniform


def test_a_property_gets_what_others_have_left(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """Its own share does not suffice: a search for one property alone needs more than a quarter of the limit."""
    written = counters(count_to(500_001), 1)
    written["variables"].append(variable("n"))
    properties = {f"q{i}": probability(op("F", op("=", "n", i))) for i in range(1, 4)}
    # The last one asks about the same paths as the first one, so it is explored with it.
    properties["r"] = probability(op("F", op("=", "x", 1)), "Pmax")
    written["properties"] += document(properties=properties)["properties"]
    file = write(tmp_path, written)
    outcome = json.loads(text_of(capsys, file, "--max-transitions", "2400000", "--format", "json"))
    assert [row["method"] for row in outcome["results"]] == ["exact"] * 5
    outcome = json.loads(text_of(capsys, file, "--max-transitions", "1000000", "--format", "json"))
    assert [row["method"] for row in outcome["results"]] == ["adaptive", *["exact"] * 3, "adaptive"]


def test_uniform_values_beside_values_for_all_schedulers(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """The last line fits both: the value of `p` is only that under uniform choices."""
    choice = automaton("a", "s t u", [edge("s", way("t", x=1)), edge("s", way("u"))])
    properties = {"p": probability(op("F", op("=", "x", 1))), "q": probability(op("F", True))}
    file = write(tmp_path, document(choice, variables=[variable("x")], properties=properties))
    out = text_of(capsys, file, "--scheduler", "uniform", "--verbose")
    assert out.startswith("p: = 0.5 under uniform choices, exact, ")
    assert "\nq: = 1 for all schedulers, exact, " in out
    both = "value under uniform choices, which is that of all schedulers where a result says so"
    assert f"\nexact values, computed from all reachable states: {both}; use" in out
    out = text_of(capsys, file, "--scheduler", "uniform", "--property", "p", "--verbose")
    assert "\nexact values, computed from all reachable states: value under uniform choices; use" in out


def test_traces_estimate_the_uniform_value_between_different_extremes(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    file = write(tmp_path, counters(CHOICE))
    out = text_of(capsys, file, "--expect", "p >= 0.2", "--explain", "--verbose", status=1)
    lines = out.splitlines()
    assert lines[0].startswith("p: minimum 0, maximum 1, exact, 4 states after reductions, ")
    assert lines[2].startswith("  under uniform choices: 0.50")
    assert "] from 1" in lines[2]
    assert lines[4].startswith("  ends: goal decided ")
    assert lines[5] == "  expected ≥ 0.2: NOT MET: the minimum over all schedulers is 0"
    assert "states: minimum and maximum over all schedulers; reductions left out choices" in out
    assert "\nestimates: 0.95 confidence, seed 0; " in out
    assert "p failed in a trace after " in out
    assert "may differ" not in out
    row = row_of(capsys, file)
    assert (row["method"], row["probability"], row["exact"]["uniform"]) == ("exact", 0, None)
    assert row["traces"] > 1000
    estimate = row["uniform"]
    assert estimate["lower"] < 0.5 < estimate["upper"]
    assert (estimate["method"], estimate["interval"], estimate["complete"]) == ("adaptive", "Clopper-Pearson", True)
    assert row["minimum"]["found"] == row["maximum"]["found"] == "all states"


def test_only_uniform_choices_are_estimated(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = write(tmp_path, counters(CHOICE))
    row = row_of(capsys, file, "--scheduler", "uniform")
    assert (row["method"], row["complete"]) == ("adaptive", True)
    assert "exact" not in row


def test_options_about_traces_still_return_estimates(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    """They do not pay for a second search."""
    for choice in (CHOICE, TOSS):
        row = row_of(capsys, write(tmp_path, counters(choice)), "--seed", "3")
        assert (row["method"], row["seed"]) == ("adaptive", 3)
        assert "exact" not in row
        assert row["schedulers"]["tried"] > 0


def test_the_editor_shows_the_extreme_that_is_asked_for() -> None:
    (result,) = api.verify(model(counters(CHOICE)), exact_if_small=True)
    assert isinstance(result.outcome, api.Computed)
    assert result.outcome.has_uniform_estimate
    assert short(result) == "minimum 0, exact"
    assert result.answer is not None
    assert result.answer.is_complete
    assert suggestions(result) == ("<= 0",)
