# SPDX-License-Identifier: Apache-2.0
"""Traces drawn as a line: `. p | q s |u #`.

Words are letters: `.` is one in which no condition holds, `pq` one in which two do; the first word is the start.
`|` is a step of the clock, `|p` one at which p holds. The last word is the end: `#` nothing can happen any more, `T`
the end of time, `~` cut.
"""

from __future__ import annotations

from itertools import pairwise

from naive import Letter

from roaml.observers.build import begin, observer_of
from roaml.observers.program import State, step
from roaml.observers.properties import (
    CLOSE,
    LEFT,
    OPEN,
    RIGHT,
    Pattern,
    PatternProperty,
    Property,
    ScopeKind,
    Window,
)
from roaml.observers.verdict import End, Verdict, verdict

CONDITIONS = {"p": LEFT, "q": RIGHT, "s": OPEN, "u": CLOSE}
ENDS = {"#": End.FINISHED, "T": End.TIME, "~": End.CUT}


def read(line: str) -> tuple[tuple[Letter, ...], End]:
    *words, end = line.split()
    letters, time = [], 0
    for word in words:
        time += word.startswith("|")
        letters.append(Letter(time, frozenset(CONDITIONS[c] for c in word if c not in ".|")))
    return tuple(letters), ENDS[end]


def property_of(text: str) -> PatternProperty:
    """`response globally 1 3`: the bounds are those of the window; `-` is none."""
    pattern, scope, *bounds = text.split()
    lower, upper = bounds or ("0", "-")
    return PatternProperty(Pattern(pattern), ScopeKind(scope), Window(int(lower), None if upper == "-" else int(upper)))


def final_state(property_: Property, trace: tuple[Letter, ...]) -> State:
    observer = observer_of(property_)
    state = begin(observer, _inputs(property_, trace[0]))
    for before, letter in pairwise(trace):
        state = step(observer, state, _inputs(property_, letter), letter.time > before.time)
        for register in observer.registers:
            value = state[register.name]
            assert isinstance(value, bool) if register.limit is None else 0 <= value <= register.limit
    return state


def observed(property_: Property, trace: tuple[Letter, ...], end: End) -> Verdict:
    return verdict(observer_of(property_), final_state(property_, trace), end)


def _inputs(property_: Property, letter: Letter) -> dict[str, bool]:
    return {name: name in letter.holds for name in property_.inputs}
