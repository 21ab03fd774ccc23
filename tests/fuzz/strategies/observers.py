# SPDX-License-Identifier: Apache-2.0
"""Random patterns and formulas on random traces: observers against the naive evaluation of their definition."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

import naive
from drawn import CONDITIONS, observed

from fuzz.strategy import Failure, Strategy
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
    Property,
    ScopeKind,
    Since,
    Window,
    historically,
    implies,
    once,
)
from roaml.observers.verdict import End, Verdict

TRACES = 10
MAX_LETTERS = 40
MAX_DEPTH = 4
MAX_BOUND = 6
"""The longest lower bound of a window, and the longest distance between its bounds, in steps of the clock."""


@dataclass(frozen=True)
class Observed:
    """A property and traces, each with its end."""

    property: Property
    traces: tuple[tuple[tuple[naive.Letter, ...], End], ...]

    def description(self) -> Iterator[str]:
        yield str(self.property)

    def files(self) -> dict[str, str | bytes]:
        return {f"trace_{number}.txt": _drawn(*trace) for number, trace in enumerate(self.traces)}

    def run(self) -> Iterator[Failure]:
        for letters, end in self.traces:
            expected, result = naive.verdict(self.property, letters, end), observed(self.property, letters, end)
            is_early = end is End.CUT and result is Verdict.SATISFIED and expected is Verdict.UNDECIDED
            if result is not expected and not is_early:
                details = f"{self.property}\n{_drawn(letters, end)}\n{result.value} instead of {expected.value}"
                yield Failure("an observer differs from the naive evaluation", details)


def _drawn(letters: tuple[naive.Letter, ...], end: End) -> str:
    return " ".join(f"{letter.time}:{'+'.join(sorted(letter.holds))}" for letter in letters) + f" {end.name}"


def make(seed: int) -> Observed:
    random = Random(seed)
    property_ = _pattern(random) if random.random() < 0.7 else FormulaProperty(_formula(random, MAX_DEPTH))
    return Observed(property_, tuple((_trace(random), random.choice(list(End))) for _ in range(TRACES)))


def _pattern(random: Random) -> PatternProperty:
    pattern, scope = random.choice(list(Pattern)), random.choice(list(ScopeKind))
    if pattern is Pattern.RECURRENCE:
        return PatternProperty(pattern, scope, Window(0, random.randint(0, MAX_BOUND)))
    return PatternProperty(pattern, scope, _window(random))


def _window(random: Random) -> Window:
    if random.random() < 0.25:
        return Window()
    lower = random.randint(0, MAX_BOUND)
    return Window(lower, random.choice((None, lower + random.randint(0, MAX_BOUND))))


def _formula(random: Random, depth: int) -> Formula:
    if depth == 0 or random.random() < 0.2:
        return random.choice((Atom("left"), Atom("right"), Constant(True), Constant(False)))
    operand = _formula(random, depth - 1)
    kind = random.randrange(7)
    match kind:
        case 0:
            return Not(operand)
        case 1 | 2 | 3:
            return (And, Or, implies)[kind - 1](operand, _formula(random, depth - 1))
        case 4:
            return Since(operand, _formula(random, depth - 1), _window(random))
        case _:
            return (once if kind == 5 else historically)(operand, _window(random))


def _trace(random: Random) -> tuple[naive.Letter, ...]:
    """Few conditions hold at a time, so that windows pass."""
    density, pace = random.uniform(0.05, 0.4), random.random()
    letters, time = [], 0
    for number in range(random.randint(1, MAX_LETTERS)):
        time += int(number > 0 and random.random() < pace)
        letters.append(naive.Letter(time, frozenset(c for c in CONDITIONS.values() if random.random() < density)))
    return tuple(letters)


STRATEGY = Strategy("observers", "runs observers of random properties beside the naive evaluation", make)
