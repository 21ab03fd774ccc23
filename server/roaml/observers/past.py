# SPDX-License-Identifier: Apache-2.0
"""Translates patterns to formulas of past-time logic, for tools that read only these formulas
(docs/spec/plain-scxml.md#lowered-properties).

The formula of a property is false at the letter that violates the pattern. There is no formula if the end of a trace or
of a stretch (`roaml.observers.patterns`) can violate the pattern: for obligations without a deadline, and for
obligations that must be met before their stretch ends.
"""

from __future__ import annotations

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
    ScopeKind,
    Since,
    Window,
    historically,
    implies,
    once,
)

TRUE = Constant(True)
_FROM_ONE = Window(1)
_NOW = Window(0, 0)
_ONE = Window(1, 1)


def past_formula(property_: PatternProperty, *, answers_with_clock: bool = True) -> Formula | None:
    """The formula that is false at the first letter that violates the property; `None` if there is none.

    Args:
        answers_with_clock: whether the second condition can become true with a step of the clock, for example because
            it requires that an event is not sent. Without this, the formula of a response is shorter.
    """
    inside = _inside(property_.scope)
    violation = _violation(property_, inside, answers_with_clock)
    if violation is None:
        return None
    match property_.scope:
        case ScopeKind.BEFORE:
            return implies(Atom(OPEN), Not(once(violation)))
        case ScopeKind.BETWEEN:
            return implies(Atom(CLOSE), Not(once(violation)))
    return Not(violation)


def _inside(scope: ScopeKind) -> Formula:
    """A formula that is true at letters in a stretch."""
    match scope:
        case ScopeKind.GLOBALLY:
            return TRUE
        case ScopeKind.AFTER:
            return once(Atom(OPEN))
        case ScopeKind.BEFORE | ScopeKind.UNTIL:
            return historically(Not(Atom(OPEN)))
        case ScopeKind.BETWEEN | ScopeKind.AFTER_UNTIL:
            return Since(Not(Atom(CLOSE)), And(Atom(OPEN), Not(Atom(CLOSE))))


def _violation(property_: PatternProperty, inside: Formula, answers_with_clock: bool) -> Formula | None:
    """A formula that is true at letters that violate the pattern in their stretch; `None` if there is none."""

    def earlier(condition: Formula, window: Window) -> Formula:
        """A formula that is true if `condition` was true in the current stretch, at a distance in `window`."""
        return Since(inside, _and(inside, condition), window)

    left, window = Atom(LEFT), property_.window
    # True at the letters of the instant at which the stretch opened.
    first = _and(inside, Not(Since(inside, inside, _FROM_ONE)))
    match property_.pattern:
        case Pattern.UNIVERSALITY | Pattern.ABSENCE:
            wrong = left if property_.pattern is Pattern.ABSENCE else Not(left)
            bounded = wrong if window.is_unbounded else And(earlier(first, window), wrong)
            return _and(inside, bounded)
        case Pattern.PRECEDENCE:
            return _and(inside, And(Atom(RIGHT), Not(earlier(left, window))))
        case Pattern.RECURRENCE:
            return _and(inside, Not(earlier(Or(first, left), window)))
        case Pattern.EXISTENCE | Pattern.RESPONSE:
            return _late(property_, inside, first, answers_with_clock)


def _late(property_: PatternProperty, inside: Formula, first: Formula, answers_with_clock: bool) -> Formula | None:
    """A formula that is true if the deadline of an obligation has passed; `None` if there is none."""
    window = property_.window
    can_close = property_.scope not in (ScopeKind.GLOBALLY, ScopeKind.AFTER)
    if window.upper is None or can_close:
        return None
    over = Window(window.upper + 1)
    if property_.pattern is Pattern.RESPONSE:
        if window.lower:
            return None
        waits = _and(inside, Not(Atom(RIGHT)))
        request = And(waits, Atom(LEFT))
        late = Since(waits, request, over)
        if not answers_with_clock:
            return late
        # All letters since the deadline are answers, and the last letter before them left a request unanswered.
        due = Since(waits, request, Window(window.upper, window.upper))
        was_due = And(once(due, _ONE), Not(Since(Not(due), Atom(RIGHT), _ONE)))
        return Or(late, And(historically(Atom(RIGHT), _NOW), was_due))
    is_in_window = And(Atom(LEFT), Since(inside, first, window))
    happened = Since(inside, _and(inside, is_in_window))
    return And(Since(inside, first, over), Not(happened))


def _and(left: Formula, right: Formula) -> Formula:
    return right if left == TRUE else And(left, right)
