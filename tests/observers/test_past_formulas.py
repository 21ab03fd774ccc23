# SPDX-License-Identifier: Apache-2.0
"""The past formula of a pattern is violated at the same letter as the pattern."""

from __future__ import annotations

import random

import pytest

from roaml.observers.build import begin, observer_of
from roaml.observers.past import past_formula
from roaml.observers.program import step
from roaml.observers.properties import OPEN, RIGHT, FormulaProperty, Pattern, PatternProperty, ScopeKind, Window

WINDOWS = [Window(), Window(0, 0), Window(0, 2), Window(1, 3), Window(2)]


def violations(property_: PatternProperty | FormulaProperty, letters: list[tuple[dict[str, bool], bool]]) -> list[bool]:
    observer = observer_of(property_)
    state = begin(observer, letters[0][0])
    seen = [bool(state[observer.outputs.violated.name])]
    for inputs, tick in letters[1:]:
        state = step(observer, state, inputs, tick)
        seen.append(bool(state[observer.outputs.violated.name]))
    return seen


def drawn_letters(
    random_: random.Random, property_: PatternProperty, answers_with_clock: bool
) -> list[tuple[dict[str, bool], bool]]:
    """Letters with their ticks.

    Args:
        answers_with_clock: whether the second condition may become true with a tick.
    """
    letters: list[tuple[dict[str, bool], bool]] = []
    for i in range(12):
        inputs = {name: random_.random() < (0.1 if name == OPEN else 0.35) for name in property_.inputs}
        tick = i > 0 and random_.random() < 0.5
        if tick and RIGHT in inputs and not answers_with_clock:
            inputs[RIGHT] &= letters[-1][0][RIGHT]
        letters.append((inputs, tick))
    return letters


@pytest.mark.parametrize("answers_with_clock", [True, False])
@pytest.mark.parametrize("scope", ScopeKind)
@pytest.mark.parametrize("pattern", Pattern)
def test_the_formula_is_violated_when_the_pattern_is(
    pattern: Pattern, scope: ScopeKind, answers_with_clock: bool
) -> None:
    random_ = random.Random(3)
    outcomes = set()
    for window in [Window(0, 2)] if pattern is Pattern.RECURRENCE else WINDOWS:
        property_ = PatternProperty(pattern, scope, window)
        formula = past_formula(property_, answers_with_clock=answers_with_clock)
        if formula is None:
            assert pattern in (Pattern.EXISTENCE, Pattern.RESPONSE)
            continue
        for _ in range(60):
            letters = drawn_letters(random_, property_, answers_with_clock)
            expected = violations(property_, letters)
            assert violations(FormulaProperty(formula), letters) == expected
            outcomes.add(expected[-1])
    has_formula = pattern not in (Pattern.EXISTENCE, Pattern.RESPONSE) or scope in (
        ScopeKind.GLOBALLY,
        ScopeKind.AFTER,
    )
    assert outcomes == ({True, False} if has_formula else set())
