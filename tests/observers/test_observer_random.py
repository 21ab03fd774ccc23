# SPDX-License-Identifier: Apache-2.0
"""Observers against the naive evaluation, on random traces."""

from __future__ import annotations

from dataclasses import replace

import naive
import pytest
from drawn import CONDITIONS, final_state, observed
from hypothesis import assume, given, settings

import kept_strategies as st
from examples import examples
from roaml.observers.build import observer_of
from roaml.observers.program import State
from roaml.observers.properties import (
    And,
    Atom,
    Constant,
    Formula,
    FormulaProperty,
    Not,
    Or,
    Pattern,
    PatternProperty,
    ScopeKind,
    Since,
    Window,
    historically,
    implies,
    once,
)
from roaml.observers.verdict import End, Verdict


@st.composite
def traces(draw: st.DrawFn) -> tuple[naive.Letter, ...]:
    """Random letters; few conditions hold at a time, so that windows pass."""
    conditions = sorted(CONDITIONS.values())
    rows = draw(
        st.lists(
            st.tuples(st.booleans(), st.lists(st.sampled_from(conditions), max_size=2, unique=True)),
            min_size=1,
            max_size=25,
        )
    )
    letters, time = [], 0
    for number, (ticks, holds) in enumerate(rows):
        time += int(ticks and number > 0)
        letters.append(naive.Letter(time, frozenset(holds)))
    return tuple(letters)


@st.composite
def windows(draw: st.DrawFn, most: int = 4) -> Window:
    lower = draw(st.integers(0, most))
    return Window(lower, draw(st.none() | st.integers(lower, lower + most)))


@st.composite
def patterns(draw: st.DrawFn) -> PatternProperty:
    pattern, scope = draw(st.sampled_from(Pattern)), draw(st.sampled_from(ScopeKind))
    window = Window(0, draw(st.integers(0, 4))) if pattern is Pattern.RECURRENCE else draw(windows())
    return PatternProperty(pattern, scope, window)


def formulas() -> st.SearchStrategy[Formula]:
    atoms: st.SearchStrategy[Formula] = st.sampled_from([Atom("left"), Atom("right"), Constant(True)])

    def larger(smaller: st.SearchStrategy[Formula]) -> st.SearchStrategy[Formula]:
        pairs = [st.builds(kind, smaller, smaller) for kind in (And, Or, implies)]
        timed = [st.builds(kind, smaller, windows()) for kind in (once, historically)]
        return st.one_of(*pairs, *timed, st.builds(Not, smaller), st.builds(Since, smaller, smaller, windows()))

    return st.recursive(atoms, larger, max_leaves=6)


@given(patterns(), traces(), st.sampled_from(End))
def test_patterns(property_: PatternProperty, trace: tuple[naive.Letter, ...], end: End) -> None:
    expected, result = naive.verdict(property_, trace, end), observed(property_, trace, end)
    if end is End.CUT and result is Verdict.SATISFIED:
        assert expected is Verdict.UNDECIDED
    else:
        assert result is expected


@pytest.mark.parametrize("pattern", Pattern)
@pytest.mark.parametrize("scope", ScopeKind)
@settings(max_examples=examples(40))
@given(data=st.data())
def test_each_pattern_and_scope(pattern: Pattern, scope: ScopeKind, data: st.DataObject) -> None:
    window = Window(0, 2) if pattern is Pattern.RECURRENCE else data.draw(windows())
    property_, trace = PatternProperty(pattern, scope, window), data.draw(traces())
    for end in (End.FINISHED, End.TIME):
        assert observed(property_, trace, end) is naive.verdict(property_, trace, end)


@given(st.builds(FormulaProperty, formulas()), traces(), st.sampled_from([End.FINISHED, End.TIME]))
def test_formulas(property_: FormulaProperty, trace: tuple[naive.Letter, ...], end: End) -> None:
    assert observed(property_, trace, end) is naive.verdict(property_, trace, end)


@given(patterns(), traces(), traces())
def test_a_verdict_before_the_end_stays(
    property_: PatternProperty, trace: tuple[naive.Letter, ...], more: tuple[naive.Letter, ...]
) -> None:
    early = observed(property_, trace, End.CUT)
    assume(early is not Verdict.UNDECIDED)
    now = trace[-1].time
    longer = (*trace, *(replace(letter, time=now + letter.time) for letter in more))
    assert naive.verdict(property_, longer, End.FINISHED) is early


LONG = Window(70, 75)


@pytest.mark.parametrize("pattern", [Pattern.RESPONSE, Pattern.PRECEDENCE])
@given(st.lists(st.tuples(st.integers(0, 40), st.sampled_from(["left", "right"])), max_size=12))
def test_windows_that_need_several_integers(pattern: Pattern, events: list[tuple[int, str]]) -> None:
    letters, time = [naive.Letter(0, frozenset())], 0
    for pause, name in events:
        for _ in range(pause):
            time += 1
            letters.append(naive.Letter(time, frozenset()))
        letters.append(naive.Letter(time, frozenset([name])))
    property_, trace = PatternProperty(pattern, window=LONG), tuple(letters)
    assert observed(property_, trace, End.TIME) is naive.verdict(property_, trace, End.TIME)


@given(patterns(), traces(), traces())
def test_closed_stretches_leave_no_trace_in_the_state(
    property_: PatternProperty, trace: tuple[naive.Letter, ...], other: tuple[naive.Letter, ...]
) -> None:
    """Outside of stretches every observer of a repeated scope is in the same state, but for its verdict and for what
    has happened so far."""
    assume(property_.scope in (ScopeKind.BETWEEN, ScopeKind.AFTER_UNTIL))
    closed = frozenset(["close"])
    states: list[State] = []
    for letters in (trace, other):
        state = dict(final_state(property_, (*letters, naive.Letter(letters[-1].time, closed))))
        outputs = observer_of(property_).outputs
        for register in (outputs.violated, outputs.exercised, outputs.opened):
            if register is not None:
                del state[register.name]
        states.append(state)
    assert states[0] == states[1]
