# SPDX-License-Identifier: Apache-2.0
"""The verdict of a property on a whole trace, as the tables of docs/spec/xml-properties.md define it. It is evaluated
slowly, over the whole sequence of letters, and independently of `roaml.observers.program`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from roaml.observers.properties import (
    CLOSE,
    LEFT,
    OPEN,
    RIGHT,
    And,
    Atom,
    Constant,
    Formula,
    Not,
    Or,
    Pattern,
    PatternProperty,
    Property,
    ScopeKind,
    Since,
)
from roaml.observers.verdict import End, Verdict


@dataclass(frozen=True)
class Letter:
    time: int
    holds: frozenset[str]


@dataclass(frozen=True)
class Stretch:
    """A stretch of a trace. `judged` is whether the property is evaluated in it; `closed` whether it ends before the
    trace does."""

    letters: tuple[Letter, ...]
    closed: bool
    judged: bool


BROKEN, KEPT = "broken", "kept"


@dataclass(frozen=True)
class Owed:
    """An event that is still required, until the deadline."""

    deadline: int | None


def verdict(property_: Property, trace: Sequence[Letter], end: End) -> Verdict:
    """UNDECIDED means that the trace ended before a violation."""
    now = trace[-1].time
    if isinstance(property_, PatternProperty):
        obligations = [
            obligation
            for stretch in stretches(property_.scope, trace)
            if stretch.judged
            for obligation in _obligations(property_, stretch, now)
        ]
    else:
        obligations = [KEPT if holds(property_.formula, trace, i) else BROKEN for i in range(len(trace))]
    if BROKEN in obligations:
        return Verdict.VIOLATED
    if end is End.CUT:
        return Verdict.UNDECIDED
    owed = [obligation for obligation in obligations if isinstance(obligation, Owed)]
    if not owed:
        return Verdict.SATISFIED
    if end is End.FINISHED or any(o.deadline is None or o.deadline <= now for o in owed):
        return Verdict.VIOLATED
    return Verdict.OPEN


def stretches(scope: ScopeKind, trace: Sequence[Letter]) -> Iterator[Stretch]:
    opening = [i for i, letter in enumerate(trace) if OPEN in letter.holds]
    match scope:
        case ScopeKind.GLOBALLY:
            yield Stretch(tuple(trace), False, True)
        case ScopeKind.AFTER:
            if opening:
                yield Stretch(tuple(trace[opening[0] :]), False, True)
        case ScopeKind.BEFORE | ScopeKind.UNTIL:
            stop = opening[0] if opening else len(trace)
            yield Stretch(tuple(trace[:stop]), bool(opening), bool(opening) or scope is ScopeKind.UNTIL)
        case ScopeKind.BETWEEN | ScopeKind.AFTER_UNTIL:
            i = 0
            while i < len(trace):
                if OPEN in trace[i].holds and CLOSE not in trace[i].holds:
                    stop = next((k for k in range(i, len(trace)) if CLOSE in trace[k].holds), None)
                    closed = stop is not None
                    yield Stretch(tuple(trace[i:stop]), closed, closed or scope is ScopeKind.AFTER_UNTIL)
                    if stop is None:
                        return
                    i = stop
                i += 1


def _obligations(property_: PatternProperty, stretch: Stretch, now: int) -> Iterator[str | Owed]:
    window, letters = property_.window, stretch.letters

    def inside(distance: int) -> bool:
        return window.lower <= distance and (window.upper is None or distance <= window.upper)

    def still_to_come(since: int) -> str | Owed:
        deadline = None if window.upper is None else since + window.upper
        return BROKEN if stretch.closed or (deadline is not None and deadline < now) else Owed(deadline)

    match property_.pattern:
        case Pattern.UNIVERSALITY | Pattern.ABSENCE:
            for letter in letters:
                if inside(letter.time - letters[0].time):
                    holds_here = LEFT in letter.holds
                    yield KEPT if holds_here is (property_.pattern is Pattern.UNIVERSALITY) else BROKEN
        case Pattern.EXISTENCE:
            if any(LEFT in letter.holds and inside(letter.time - letters[0].time) for letter in letters):
                yield KEPT
            else:
                yield still_to_come(letters[0].time) if letters else BROKEN
        case Pattern.RESPONSE:
            for i, request in enumerate(letters):
                if LEFT in request.holds:
                    answers = [answer for answer in letters[i:] if RIGHT in answer.holds]
                    kept = any(inside(answer.time - request.time) for answer in answers)
                    yield KEPT if kept else still_to_come(request.time)
        case Pattern.PRECEDENCE:
            for i, letter in enumerate(letters):
                if RIGHT in letter.holds:
                    earlier = [cause for cause in letters[: i + 1] if LEFT in cause.holds]
                    yield KEPT if any(inside(letter.time - cause.time) for cause in earlier) else BROKEN
        case Pattern.RECURRENCE:
            assert window.upper is not None
            for i, letter in enumerate(letters):
                times = [letters[0].time, *(other.time for other in letters[: i + 1] if LEFT in other.holds)]
                yield KEPT if any(time >= letter.time - window.upper for time in times) else BROKEN


def holds(formula: Formula, trace: Sequence[Letter], i: int) -> bool:
    match formula:
        case Atom(name):
            return name in trace[i].holds
        case Constant(value):
            return value
        case Not(operand):
            return not holds(operand, trace, i)
        case And(left, right):
            return holds(left, trace, i) and holds(right, trace, i)
        case Or(left, right):
            return holds(left, trace, i) or holds(right, trace, i)
        case Since(left, right, window):
            for k in range(i, -1, -1):
                distance = trace[i].time - trace[k].time
                is_inside = window.lower <= distance and (window.upper is None or distance <= window.upper)
                if is_inside and holds(right, trace, k):
                    return True
                if not holds(left, trace, k):
                    return False
            return False
