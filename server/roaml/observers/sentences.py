# SPDX-License-Identifier: Apache-2.0
"""Writes properties of traces as English sentences (docs/spec/xml-properties.md#patterns).

Conditions and durations are given as text, so that incomplete properties can be written as well.
"""

from __future__ import annotations

from collections.abc import Mapping

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
    ScopeKind,
    Since,
    Window,
)
from roaml.record import Record

_MAX_DEPTH = 8
"""The number of levels of a formula that are written out."""


class SentenceClause(Record, frozen=True):
    """A condition as a clause: `/charge` (subject) is (auxiliary) called (verb)."""

    subject: str
    verb: str
    auxiliary: str = ""

    def __str__(self) -> str:
        return self.saying("")

    def saying(self, adverb: str) -> str:
        """The clause with an adverb such as "never"."""
        return " ".join(filter(None, (self.subject, self.auxiliary, adverb, self.verb)))


UNKNOWN = SentenceClause("…", "")


class Times(Record, frozen=True):
    """The lower bound (`after`) and the upper bound (`within`) of a time, as text with units such as "5 s"; an empty
    string means that there is no bound."""

    after: str = ""
    within: str = ""


def pattern_sentence(pattern: Pattern, scope: ScopeKind, clauses: Mapping[str, SentenceClause], times: Times) -> str:
    """The sentence that states a pattern in a scope.

    Args:
        clauses: the conditions, by the names of inputs; a missing condition is written as dots.
    """
    opened = _Clauses(clauses)
    text = f"{_scope(scope, opened)}{_pattern(pattern, opened, times)}"
    return _sentence(f"{text}{_condition_of_scope(scope)}")


def formula_sentence(formula: Formula, clauses: Mapping[str, SentenceClause]) -> str:
    """The sentence that states that a formula of past-time metric temporal logic holds at every step."""
    return _sentence(f"at every step, {_formula(formula, clauses, _MAX_DEPTH)}")


def pattern_formula(pattern: Pattern, scope: ScopeKind, conditions: Mapping[str, str], times: Times) -> str:
    """A pattern as a formula of temporal logic with past operators; its scope is written in words.

    Args:
        conditions: the conditions, by the names of inputs.
    """
    left, right, opened, closed = (conditions.get(name, "…") for name in (LEFT, RIGHT, OPEN, CLOSE))
    bounds = f"[{times.after or '0'}, {times.within or '∞'}]" if times.after or times.within else ""
    formula = {
        Pattern.UNIVERSALITY: f"G{bounds} {left}",
        Pattern.ABSENCE: f"G{bounds} ¬{left}",
        Pattern.EXISTENCE: f"F{bounds} {left}",
        Pattern.RESPONSE: f"G ({left} ⇒ F{bounds} {right})",
        Pattern.PRECEDENCE: f"G ({right} ⇒ O{bounds} {left})",
        Pattern.RECURRENCE: f"G F{bounds} {left}",
    }[pattern]
    match scope:
        case ScopeKind.GLOBALLY:
            return formula
        case ScopeKind.BETWEEN | ScopeKind.AFTER_UNTIL:
            word = "between" if scope is ScopeKind.BETWEEN else "after"
            return f"{word} {opened} {'and' if scope is ScopeKind.BETWEEN else 'until'} {closed}: {formula}"
    return f"{scope.value} {opened}: {formula}"


class _Clauses:
    def __init__(self, clauses: Mapping[str, SentenceClause]) -> None:
        self.left = clauses.get(LEFT, UNKNOWN)
        self.right = clauses.get(RIGHT, UNKNOWN)
        self.open = clauses.get(OPEN, UNKNOWN)
        self.close = clauses.get(CLOSE, UNKNOWN)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


# --------------------------------------------------------------------- patterns


def _scope(scope: ScopeKind, clauses: _Clauses) -> str:
    match scope:
        case ScopeKind.GLOBALLY:
            return ""
        case ScopeKind.AFTER:
            return f"from the first time that {clauses.open}, "
        case ScopeKind.BEFORE:
            return f"before the first time that {clauses.open}, "
        case ScopeKind.UNTIL:
            return f"until {clauses.open} or the trace ends, "
        case ScopeKind.BETWEEN:
            return f"each time from when {clauses.open} until {clauses.close}, "
        case ScopeKind.AFTER_UNTIL:
            return f"each time from when {clauses.open} until {clauses.close} or the trace ends, "


def _condition_of_scope(scope: ScopeKind) -> str:
    """The end of the sentence for a scope that is judged only at its end; an empty string for other scopes."""
    return "; nothing is required if that end never comes" if scope.is_judged_at_close else ""


def _pattern(pattern: Pattern, clauses: _Clauses, times: Times) -> str:
    left, right = clauses.left, clauses.right
    match pattern:
        case Pattern.UNIVERSALITY:
            return f"{left.saying('always')}{_since_start(times)}"
        case Pattern.ABSENCE:
            return f"{left.saying('never')}{_since_start(times)}"
        case Pattern.EXISTENCE:
            return f"{left}{_since_start(times) or ' at some time'}"
        case Pattern.RESPONSE:
            return f"whenever {left}, {right} {_distance(times, 'later') or 'then or later'}"
        case Pattern.PRECEDENCE:
            return f"whenever {right}, {left} {_distance(times, 'before') or 'then or before'}"
        case Pattern.RECURRENCE:
            return f"{left} at least once every {times.within or '…'}"


def _since_start(times: Times) -> str:
    if times.after and times.within:
        return f" from {times.after} to {times.within} after the beginning"
    if times.after:
        return f" at {times.after} after the beginning or later"
    return f" within {times.within} from the beginning" if times.within else ""


def _distance(times: Times, direction: str) -> str:
    if times.after and times.within:
        return f"{times.after} to {times.within} {direction}"
    if times.after:
        return f"at least {times.after} {direction}"
    if not times.within:
        return ""
    return f"within {times.within}" if direction == "later" else f"at most {times.within} {direction}"


# --------------------------------------------------------------------- formulas


def _formula(formula: Formula, clauses: Mapping[str, SentenceClause], depth: int) -> str:
    def inner(part: Formula) -> str:
        text = _formula(part, clauses, depth - 1)
        is_simple = isinstance(part, (Atom, Constant)) or (isinstance(part, Not) and isinstance(part.operand, Atom))
        return text if is_simple else f"({text})"

    if depth == 0:
        return "…"
    match formula:
        case Atom(name):
            return str(clauses.get(name, UNKNOWN))
        case Constant(value):
            return "true" if value else "false"
        case Not(Since(Constant(True), Not(operand), window)):
            return f"{inner(operand)} {_always(window)}"
        case Not(Atom(name)):
            return f"not {clauses.get(name, UNKNOWN)}"
        case Not(operand):
            return f"not {inner(operand)}"
        case And(left, right):
            return f"{inner(left)} and {inner(right)}"
        case Or(Not(left), right):
            return f"if {inner(left)}, then {inner(right)}"
        case Or(left, right):
            return f"{inner(left)} or {inner(right)}"
        case Since(Constant(True), right, window):
            return f"{inner(right)} {_ago(window)}"
        case Since(left, right, window):
            return f"{inner(right)} {_ago(window)} and {inner(left)} ever since"


def _steps(number: int) -> str:
    return "1 step" if number == 1 else f"{number} steps"


def _ago(window: Window) -> str:
    if window.upper is None:
        return "now or before" if window.lower == 0 else f"at least {_steps(window.lower)} ago"
    if window.upper == 0:
        return "at this time"
    if window.lower == 0:
        return f"at most {_steps(window.upper)} ago"
    return f"{window.lower} to {_steps(window.upper)} ago"


def _always(window: Window) -> str:
    if window.upper is None:
        return "always until now" if window.lower == 0 else f"always until {_steps(window.lower)} ago"
    if window.lower == 0:
        return f"always during the last {_steps(window.upper)}"
    return f"always from {window.upper} to {_steps(window.lower)} ago"
