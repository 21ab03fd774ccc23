# SPDX-License-Identifier: Apache-2.0
"""The search that leaves choices out has the same minimum, maximum, verdicts, faults and stuck states as the search
through all states, on random networks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from compared_spaces import ALL, both, check, is_smaller
from hypothesis import given, settings
from hypothesis import strategies as st
from loose_networks import STUCK_AUTOMATON, STUCK_LOCATION, messages, networks
from smc_models import Json, automaton, document, edge, model, op, probability, variable, way
from smc_random import networks as entangled_networks

from as2fm_lsp.cli.main import run
from as2fm_lsp.verification import exact_report
from examples import examples
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.plain import plain_kernel, plain_search
from roaml.explicit.space import StateLimits, explore
from roaml.explicit.values import values_of
from roaml.smc.end import End
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.verification.exhaustive import UndecidedError, exact_values
from roaml.verification.results import Exact

MARKS = {(STUCK_AUTOMATON, STUCK_LOCATION): End.STUCK}


def question_of(written: Json, *, is_stuck: bool = False) -> tuple[ModelChecker, CompiledProperty]:
    checker = ModelChecker(model(written), marks=MARKS, includes_stuck=True)
    return checker, checker.compiled_properties[-1 if is_stuck else 0]


def test_reduced_spaces_have_the_same_answers() -> None:
    smaller: list[bool] = []

    @given(networks(), st.booleans())
    @settings(max_examples=examples(300), deadline=None)
    def run(written: Json, is_stuck: bool) -> None:
        spaces = both(*question_of(written, is_stuck=is_stuck))
        if spaces is not None:
            check(*spaces)
            smaller.append(is_smaller(*spaces))

    run()
    assert sum(smaller) > len(smaller) / 2
    assert len(smaller) > examples(300) / 2


def test_together_with_dead_variables() -> None:
    """Compared with a search that leaves nothing out and resets nothing."""
    smaller: list[bool] = []

    @given(messages(), st.booleans())
    @settings(max_examples=examples(60), deadline=None)
    def run(written: Json, is_stuck: bool) -> None:
        checker, property_ = question_of(written, is_stuck=is_stuck)
        compiled = checker.compiled(property_)
        if can_be_reduced(compiled.program, compiled.goal):
            whole = explore(checker, property_, StateLimits(reduces=False))
            check(whole, explore(checker, property_, ALL))
            reduced = explore(checker, property_, ALL, is_reduced=True)
            check(whole, reduced)
            smaller.append(is_smaller(whole, reduced))

    run()
    assert sum(smaller) > len(smaller) / 2


def test_reduced_spaces_take_the_same_ways() -> None:
    """The check of systems relies on this (`roaml.project.exploration`)."""
    smaller: list[bool] = []

    @given(st.one_of(networks(), messages()))
    @settings(max_examples=examples(300), deadline=None)
    def run(written: Json) -> None:
        spaces = both(*question_of(written, is_stuck=True))
        if spaces is not None and all(space.problem is None for space in spaces):
            whole, reduced = (bytes(memoryview(space.search.taken)) for space in spaces)
            assert reduced == whole
            smaller.append(is_smaller(*spaces))

    run()
    assert sum(smaller) > len(smaller) / 2


def test_reduced_spaces_have_the_same_faults() -> None:
    faulty: list[bool] = []

    @given(networks(has_faults=True))
    @settings(max_examples=examples(150), deadline=None)
    def run(written: Json) -> None:
        spaces = both(*question_of(written))
        if spaces is not None:
            check(*spaces)
            faulty.append(spaces[0].problem is not None)

    run()
    assert sum(faulty) > len(faulty) / 8


@given(entangled_networks())
@settings(max_examples=examples(60), deadline=None)
def test_automata_with_many_shared_variables(written: Json) -> None:
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)


@given(networks())
@settings(max_examples=examples(20), deadline=None)
def test_both_searches_leave_out_the_same(written: Json) -> None:
    ours = both(*question_of(written))
    if ours is None:
        return
    plain = both(*question_of(written), modules=(plain_kernel(), plain_search()))
    assert plain is not None
    for one, other in zip(ours, plain, strict=True):
        assert one.states == other.states
        for state in range(one.states):
            assert one.search.key(state) == other.search.key(state)
            assert one.search.choices_of(state) == other.search.choices_of(state)


def test_paths_of_states_that_are_not_stored_are_remembered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether a path is known changes the number of steps, but neither the states nor their choices. With one place for
    remembered states, most states find another one there. If short paths end at their maximum length, the choices may
    differ, but not the values."""
    engine = plain_search()
    saved: list[int] = []

    @given(networks())
    @settings(max_examples=examples(30), deadline=None)
    def run(written: Json) -> None:
        checker, property_ = question_of(written)
        compiled = checker.compiled(property_)
        if not can_be_reduced(compiled.program, compiled.goal):
            return
        whole = explore(checker, property_, ALL)
        for longest in (2, 1000):
            monkeypatch.setattr(engine, "MAX_PASSED", longest)
            found = []
            for places in (1, 64):
                monkeypatch.setattr(engine, "MAX_REMEMBERED", places)
                modules = plain_kernel(), engine
                found.append(explore(checker, property_, ALL, modules=modules, is_reduced=True))
                check(whole, found[-1])
        few, many = found
        assert few.states == many.states
        for state in range(few.search.expanded):
            assert few.search.key(state) == many.search.key(state)
            assert few.search.choices_of(state) == many.search.choices_of(state)
        saved.append(few.search.passed - many.search.passed)

    run()
    assert min(saved) >= 0
    assert max(saved) > 0


def counters(number: int, choice: list[Json]) -> Json:
    """A model with 10ⁿ states for each state of an automaton with the edges `choice`, from which it goes to `m` or `n`.
    The property asks whether x becomes 1."""
    count = edge("l", way("l", own=op("+", "own", 1)), guard=op("<", "own", 9))
    parts = [automaton(f"c{i}", "l", [count], [variable("own")]) for i in range(number)]
    parts.append(automaton("d", "l m n", choice))
    return document(*parts, variables=[variable("x")], properties={"p": probability(op("F", op("=", "x", 1)))})


TOSS = [edge("l", way("m", 0.5, x=1), way("n", 0.5))]
CHOICE = [edge("l", way("m", x=1)), edge("l", "n")]


def exact_of(written: Json, **limits: Any) -> Exact:
    checker = ModelChecker(model(written))
    return exact_values(checker, checker.compiled_properties[0], StateLimits(**limits))


def test_few_states_are_all_explored() -> None:
    exact = exact_of(counters(3, TOSS))
    assert not exact.is_reduced
    assert exact.states == 3000
    assert exact.average == 0.5


def test_the_uniform_value_follows_from_an_equal_minimum_and_maximum() -> None:
    exact = exact_of(counters(7, TOSS))
    assert exact.is_reduced
    assert exact.states < 10
    assert (exact.least, exact.greatest, exact.average) == (0.5, 0.5, 0.5)
    text = exact_report.lines("p", exact, 0.0, is_whole=True)
    assert text[0] == f"p: = 0.5 for all schedulers, exact, {exact.states} states after reductions, 0.0 s"
    assert "  example traces: it fails after 64 steps, it holds after 1 step" in text or text[1].startswith(
        "  example traces: "
    )


def test_the_uniform_value_is_computed_from_all_states_if_possible() -> None:
    exact = exact_of(counters(5, CHOICE))
    assert not exact.is_reduced
    assert exact.states > 100_000
    assert (exact.least, exact.greatest, exact.average) == (0.0, 1.0, 0.5)


def test_the_uniform_value_of_many_states_is_not_computed() -> None:
    exact = exact_of(counters(7, CHOICE))
    assert exact.is_reduced
    assert (exact.least, exact.greatest, exact.uniform) == (0.0, 1.0, None)
    text = exact_report.lines("p", exact, 0.0)
    assert text[0] == f"p: minimum 0, maximum 1, exact, {exact.states} states after reductions, 0.0 s"
    assert text[1] == "  not computed: the value under uniform choices; use --no-reductions"
    row = exact_report.row(exact)
    assert row["reduced"] is True
    assert row["uniform"] is None
    assert row["bounds"]["uniform"] is None
    assert row["shortest"] == {"failed": None, "passed": None}


def test_without_reductions_all_states_are_explored() -> None:
    with pytest.raises(UndecidedError, match="stopped at 30,000 states"):
        exact_of(counters(7, TOSS), states=30_000, reduces=False)
    assert exact_of(counters(7, TOSS), states=30_000).states < 10


def test_limits_apply_to_reduced_searches() -> None:
    """The shared variable is visible, so neither choice is left out."""
    ring = [edge("l", way("l", x=op("%", op("+", "x", step), 80_000))) for step in (2, 4)]
    with pytest.raises(UndecidedError, match="stopped at 30,000 states"):
        exact_of(counters(1, ring), states=30_000)


@pytest.mark.parametrize("path", ["Pmin", "Pmax"])
def test_two_machines_that_only_work_form_no_trace_without_an_end(path: str) -> None:
    """A cycle of invisible steps must not keep the search from the step that reaches the goal."""
    toggle = automaton("t", "l m", [edge("l", "m"), edge("m", "l")])
    goal = automaton("g", "l m", [edge("l", way("m", x=1))])
    reached = {"p": probability(op("F", op("=", "x", 1)), path)}
    spaces = both(*question_of(document(toggle, goal, variables=[variable("x")], properties=reached)))
    assert spaces is not None
    check(*spaces)
    assert values_of(spaces[1]).minimum.upper == 0.0
    assert values_of(spaces[1]).maximum.lower == 1.0


@pytest.mark.parametrize(
    ("value", "is_independent"), [("z", True), (op("max", "z", 0), True), (op("-", "z", 0), False)]
)
def test_only_guards_that_can_be_undefined_are_reads_of_other_steps(value: Any, is_independent: bool) -> None:
    """Between the rounds of `a`, `b` counts in the variable of a guard, for a step that waits for `c`."""
    wait = edge("l", "l", action="go", guard=op("=", value, 7))
    turn = edge("l", way("m", own=op("%", op("+", "own", 1), 5)))
    parts = [
        automaton("a", "l m", [wait, turn, edge("m", way("l", 0.5, x=1), way("l", 0.5))], [variable("own")]),
        automaton("b", "l", [edge("l", way("l", z=op("%", op("+", "z", 1), 6)))]),
        automaton("c", "l m", [edge("m", "l", action="go")]),
    ]
    written = document(
        *parts,
        variables=[variable("x"), variable("z")],
        syncs=[["go", None, "go"]],
        properties={"p": probability(op("F", op("=", "x", 1)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert is_smaller(*spaces) == is_independent


@pytest.mark.parametrize("value", [0, 1])
@pytest.mark.parametrize("has_chance", [False, True])
def test_writes_are_invisible_if_they_keep_the_value(value: int, *, has_chance: bool) -> None:
    """A step that writes a variable of the property is only taken alone if each destination keeps the value 0. The step
    is independent of a choice between two edges, which cannot be taken alone."""
    ways = [way("m", x=value)]
    if has_chance:
        ways = [way("m", 0.5, x=0), way("n", 0.5, x=value)]
    written = document(
        automaton("a", "l m n", [edge("l", *ways)]),
        automaton("b", "l m n", [edge("l", way("m", y=1)), edge("l", "n")]),
        variables=[variable("x"), variable("y")],
        properties={"p": probability(op("U", op("≤", "y", "x"), op("=", "y", 1)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert (len(spaces[1].search.choices_of(0)) == 1) == (value == 0)


def test_steps_that_change_nothing_can_avoid_an_end() -> None:
    """They can be taken for ever, but not at the end. So `stuck` has a smaller minimum than after reductions."""
    idle = automaton("i", "l", [edge("l", way("l", 0.5), way("l", 0.5))])
    ends = automaton(STUCK_AUTOMATON, "l m", [edge("l", STUCK_LOCATION)])
    written = document(idle, ends, variables=[variable("x")], properties={"p": probability(op("F", op("=", "x", 1)))})
    checker, property_ = question_of(written, is_stuck=True)
    assert both(checker, property_) is None
    assert values_of(explore(checker, property_, ALL)).minimum.upper == 0.0
    assert values_of(explore(checker, property_, ALL)).maximum.lower == 1.0
    assert both(*question_of(written)) is not None


def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "model.jani"
    file.write_text(json.dumps(counters(7, CHOICE)), encoding="utf-8")
    arguments = ["verify", str(file), "--exhaustive", "--max-states", "30000"]
    assert run([*arguments, "--explain", "--verbose"]) == 0
    text = capsys.readouterr().out
    assert "p: minimum 0, maximum 1, exact, " in text
    assert "\n  p failed in a trace after 64 steps" in text
    assert (
        "\ncomputed from all reachable states: minimum and maximum over all schedulers; "
        "reductions left out choices that do not change these values\n"
    ) in text
    assert run([*arguments, "--no-reductions"]) == 1
    assert "stopped at 30,000 states" in capsys.readouterr().out


def test_the_last_line_names_properties_without_the_uniform_value(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    written = counters(7, CHOICE)
    written["properties"].append({"name": "q", "expression": probability(op("F", True))})
    file = tmp_path / "model.jani"
    file.write_text(json.dumps(written), encoding="utf-8")
    assert run(["verify", str(file), "--exhaustive", "--verbose"]) == 0
    text = capsys.readouterr().out
    assert "  not computed: the value under uniform choices" in text
    assert "q: = 1 for all schedulers" in text
    values = "minimum and maximum over all schedulers, value under uniform choices (not of `p`); reductions"
    assert f"\ncomputed from all reachable states: {values}" in text


@pytest.mark.parametrize("returns", [False, True])
def test_a_step_is_taken_alone_if_no_step_that_depends_on_it_can_be_reached(*, returns: bool) -> None:
    """`c` reads what `a` writes, but only in the location `l`, to which it returns or not. The property sees each step
    of `c`."""
    steps = [
        edge("m", way("o", 0.5, z=1), way("n", 0.5, z=2)),
        edge("o", way("l" if returns else "n", z=3)),
        edge("l", way("n", z=4), guard=op("=", "w", 1)),
    ]
    written = document(
        automaton("a", "l m", [edge("l", way("m", w=1))]),
        automaton("c", "m l n o", steps),
        variables=[variable("w"), variable("z")],
        properties={"p": probability(op("F", op("=", "z", 4)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert len(spaces[1].search.choices_of(0)) == (2 if returns else 1)


@pytest.mark.parametrize("is_written", [False, True])
def test_a_condition_that_is_false_stays_false_if_no_step_writes_its_variables(*, is_written: bool) -> None:
    """`c` reads what `a` writes only where a condition on `y` holds, which a step of `c` writes or not."""
    steps = [
        edge("m", way("o", 0.5, z=1, **({"y": 1} if is_written else {})), way("n", 0.5, z=2)),
        edge("o", way("l", z=3), guard=op("=", "y", 1)),
        edge("l", way("n", z=op("+", "w", 3))),
    ]
    written = document(
        automaton("a", "l m", [edge("l", way("m", w=1))]),
        automaton("c", "m l n o", steps),
        variables=[variable("w"), variable("y"), variable("z")],
        properties={"p": probability(op("F", op("=", "z", 4)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert len(spaces[1].search.choices_of(0)) == (2 if is_written else 1)


@pytest.mark.parametrize("value", ["x", op("-", "x", 0)])
@pytest.mark.parametrize("is_left", [False, True])
def test_conditions_that_can_be_undefined_are_evaluated_where_they_can_be_reached(value: Any, *, is_left: bool) -> None:
    """A condition of `c` for a step that is never possible contains a variable that `a` writes."""
    never = edge("l" if is_left else "o", "n", action="never", guard=op("=", value, 7))
    steps = [edge("l", way("m", z=1)), edge("m", way("o", 0.5, z=2), way("n", 0.5, z=3)), never]
    written = document(
        automaton("a", "l m", [edge("l", way("m", x=1))]),
        automaton("c", "l m n o" if not is_left else "m l n o", steps),
        automaton("d", "l m", [edge("m", "l", action="never")]),
        variables=[variable("x"), variable("z")],
        syncs=[[None, "never", "never"]],
        properties={"p": probability(op("F", op("=", "z", 3)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert len(spaces[1].search.choices_of(0)) == (1 if is_left or value == "x" else 2)


@pytest.mark.parametrize("enters", [True, False])
def test_conditions_are_undefined_before_a_step_that_nobody_else_needs(*, enters: bool) -> None:
    """`a` writes x before it takes part in `go`. Before that, a condition of `j` for `go` is undefined: once `j` has
    entered `l`, or once `b` has written y."""
    divided = op("=", op("%", 1, "x"), 0)
    go = edge("l", "n", action="go", guard=divided if enters else op("∧", op("=", "y", 1), divided))
    written = document(
        automaton("a", "l m", [edge("l", way("m", x=1)), edge("m", "l", action="go")]),
        automaton("j", "m l n" if enters else "l n", [edge("m", "l"), go] if enters else [go]),
        automaton("b", "l m", [edge("l", way("m", y=1))]),
        variables=[variable("x"), variable("y"), variable("z")],
        syncs=[["go", "go", None]],
        properties={"p": probability(op("F", op("=", "z", 1)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    assert spaces[0].problem is not None
    check(*spaces)


def test_two_of_three_vectors_suffice() -> None:
    """`r` goes with `a` or with `b`. What `c` does with `d` matters only after that."""
    written = document(
        automaton("a", "l m", [edge("l", "m", action="first")]),
        automaton("b", "l m", [edge("l", "m", action="second")]),
        automaton(
            "r",
            "l m n o",
            [edge("l", "m", action="first"), edge("l", "n", action="second"), edge("m", "o", action="y")],
        ),
        automaton("c", "l m", [edge("l", "m", action="x")]),
        automaton("d", "l m n", [edge("l", "m", action="x"), edge("l", way("n", z=1), action="y")]),
        variables=[variable("z")],
        syncs=[
            ["first", None, "first", None, None],
            [None, "second", "second", None, None],
            [None, None, None, "x", "x"],
            [None, None, "y", None, "y"],
        ],
        properties={"p": probability(op("F", op("=", "z", 1)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert is_smaller(*spaces)


@pytest.mark.parametrize("is_received", [True, False])
def test_ticks_that_test_a_buffer_are_taken_early(is_received: bool) -> None:
    """The tick of `t` waits until the buffer `e` is empty. If the message is received only after the tick, the tick may
    not be possible any more, and the trace may end before it."""
    written = document(
        automaton("t", "l m n", [edge("l", "m", action="tick"), edge("m", "n", action="q")]),
        automaton("s", "l m", [edge("l", "m", action="send")]),
        automaton(
            "e", "w f", [edge("w", "w", action="tick"), edge("w", "f", action="send"), edge("f", "w", action="receive")]
        ),
        automaton(
            "r", "l m n",
            [edge("l", way("n", z=1), action="q"), edge("l" if is_received else "n", "m", action="receive")],
        ),
        variables=[variable("z")],
        syncs=[
            ["tick", None, "tick", None],
            [None, "send", "send", None],
            [None, None, "receive", "receive"],
            ["q", None, None, "q"],
        ],
        properties={"p": probability(op("F", op("=", "z", 1)))},
    )  # fmt: skip
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert is_smaller(*spaces) or not is_received
    assert values_of(spaces[1]).minimum.lower == 0.0


def test_a_destination_with_probability_zero_does_not_lead_on() -> None:
    """As above, but `i` receives the message only in `m`, which it cannot reach. So the trace gets stuck if the message
    is sent before the tick. After the tick, it does not end."""
    stays = edge("l", way("m", "none"), way("l", op("-", 1, "none")), action="idle")
    written = document(
        automaton("t", "l m n", [edge("l", "m", action="tick"), edge("m", "n"), edge("n", "m")]),
        automaton(STUCK_AUTOMATON, "l m", [edge("l", STUCK_LOCATION, action="send")]),
        automaton(
            "e",
            "w f",
            [
                edge("w", "w", action="tick"),
                edge("w", "f", action="send"),
                edge("f", "f", action="idle"),
                edge("f", "w", action="receive"),
            ],
        ),
        automaton("i", "l m", [stays, edge("m", "l", action="receive")], [variable("none")]),
        variables=[variable("z")],
        syncs=[
            ["tick", None, "tick", None],
            [None, "send", "send", None],
            [None, None, "idle", "idle"],
            [None, None, "receive", "receive"],
        ],
        properties={"p": probability(op("F", op("=", "z", 1)))},
    )
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert spaces[0].can_get_stuck


def test_a_choice_may_wait_for_chance() -> None:
    """`r` goes with `a` or with `b`, and reaches the goal if the coin `c` agrees: always, if it waits for the coin."""
    written = document(
        automaton("a", "l m", [edge("l", "m", action="first")]),
        automaton("b", "l m", [edge("l", "m", action="second")]),
        automaton(
            "r",
            "l m n o",
            [
                edge("l", "m", action="first"),
                edge("l", "n", action="second"),
                edge("m", way("o", z=1), action="heads"),
                edge("n", way("o", z=1), action="tails"),
            ],
        ),
        automaton(
            "c", "l m n o",
            [
                edge("l", way("m", 0.5), way("n", 0.5)), edge("l", "o"),
                edge("m", "m", action="heads"), edge("n", "n", action="tails"),
            ],
        ),
        variables=[variable("z")],
        syncs=[
            ["first", None, "first", None],
            [None, "second", "second", None],
            [None, None, "heads", "heads"],
            [None, None, "tails", "tails"],
        ],
        properties={"p": probability(op("F", op("=", "z", 1)))},
    )  # fmt: skip
    spaces = both(*question_of(written))
    assert spaces is not None
    check(*spaces)
    assert values_of(spaces[1]).maximum.lower == 1.0
