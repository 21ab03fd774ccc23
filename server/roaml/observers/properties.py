# SPDX-License-Identifier: Apache-2.0
"""Properties of traces: a pattern in a scope, or a formula of past-time metric temporal logic
(docs/spec/xml-properties.md#meaning).

Conditions are identified by names: the names of `Atom`s in formulas, and `LEFT`, `RIGHT`, `OPEN` and `CLOSE` in
patterns. Bounds on time are in clock steps, both ends included. `None` means that there is no upper bound.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from typing import TypeAlias

from roaml.record import Record

LEFT = "left"
"""The only or the first condition of a pattern."""
RIGHT = "right"
"""The second condition of a pattern."""
OPEN = "open"
"""The only or the first condition of a scope."""
CLOSE = "close"
"""The condition that closes a scope `between` or `after-until`."""


class Pattern(enum.Enum):
    UNIVERSALITY = "universality"
    ABSENCE = "absence"
    EXISTENCE = "existence"
    RESPONSE = "response"
    PRECEDENCE = "precedence"
    RECURRENCE = "recurrence"

    @property
    def is_binary(self) -> bool:
        """Whether the pattern has two conditions."""
        return self in (Pattern.RESPONSE, Pattern.PRECEDENCE)


class ScopeKind(enum.Enum):
    GLOBALLY = "globally"
    AFTER = "after"
    BEFORE = "before"
    UNTIL = "until"
    BETWEEN = "between"
    AFTER_UNTIL = "after-until"

    @property
    def has_event(self) -> bool:
        """Whether the scope needs the condition `OPEN`."""
        return self is not ScopeKind.GLOBALLY

    @property
    def has_until(self) -> bool:
        """Whether the scope needs the condition `CLOSE`."""
        return self in (ScopeKind.BETWEEN, ScopeKind.AFTER_UNTIL)

    @property
    def is_judged_at_close(self) -> bool:
        """Whether a stretch is judged only when it closes, and not at the end of the trace."""
        return self in (ScopeKind.BEFORE, ScopeKind.BETWEEN)


class Window(Record, frozen=True):
    """The distances in time that a property allows, in clock steps.

    Raises:
        ValueError: `lower` is negative, or `upper` is less than `lower`.
    """

    lower: int = 0
    upper: int | None = None

    def __post_init__(self) -> None:
        if self.lower < 0 or (self.upper is not None and self.upper < self.lower):
            raise ValueError(f"invalid range of times: from {self.lower} to {self.upper}")

    @property
    def is_unbounded(self) -> bool:
        return self.lower == 0 and self.upper is None


ANY_TIME = Window()
"""All distances in time."""


class PatternProperty(Record, frozen=True):
    """A pattern that holds in every stretch of a scope.

    Raises:
        ValueError: a recurrence has no upper bound, or has a lower bound.
    """

    pattern: Pattern
    scope: ScopeKind = ScopeKind.GLOBALLY
    window: Window = ANY_TIME

    def __post_init__(self) -> None:
        if self.pattern is Pattern.RECURRENCE and (self.window.upper is None or self.window.lower > 0):
            raise ValueError("a recurrence needs an upper bound on the time and no lower one")

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the observed conditions."""
        names = [LEFT]
        if self.pattern.is_binary:
            names.append(RIGHT)
        if self.scope.has_event:
            names.append(OPEN)
        if self.scope.has_until:
            names.append(CLOSE)
        return tuple(names)


# --------------------------------------------------------------------- formulas


class Atom(Record, frozen=True):
    name: str


class Constant(Record, frozen=True):
    value: bool


class Not(Record, frozen=True):
    operand: Formula


class And(Record, frozen=True):
    left: Formula
    right: Formula


class Or(Record, frozen=True):
    left: Formula
    right: Formula


class Since(Record, frozen=True):
    """A formula that is true if `right` was true at some letter up to the current one whose distance is in `window`,
    and `left` was true at all letters after that letter."""

    left: Formula
    right: Formula
    window: Window = ANY_TIME


Formula: TypeAlias = Atom | Constant | Not | And | Or | Since


def implies(left: Formula, right: Formula) -> Formula:
    return Or(Not(left), right)


def once(operand: Formula, window: Window = ANY_TIME) -> Formula:
    """The formula that is true if `operand` was true at some letter up to the current one whose distance is in
    `window`."""
    return Since(Constant(True), operand, window)


def historically(operand: Formula, window: Window = ANY_TIME) -> Formula:
    """The formula that is true if `operand` was true at all letters up to the current one whose distance is in
    `window`."""
    return Not(once(Not(operand), window))


def children(formula: Formula) -> tuple[Formula, ...]:
    match formula:
        case Atom() | Constant():
            return ()
        case Not():
            return (formula.operand,)
        case And() | Or() | Since():
            return (formula.left, formula.right)


def walk(formula: Formula) -> Iterator[Formula]:
    """`formula` and all its subformulas in preorder."""
    stack = [formula]
    while stack:
        node = stack.pop()
        yield node
        stack += reversed(children(node))


class FormulaProperty(Record, frozen=True):
    """The property that a formula is true at every letter."""

    formula: Formula

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the observed conditions, in the order of their first occurrence."""
        return tuple(dict.fromkeys(node.name for node in walk(self.formula) if isinstance(node, Atom)))


Property: TypeAlias = PatternProperty | FormulaProperty
