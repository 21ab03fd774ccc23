# SPDX-License-Identifier: Apache-2.0
"""Path formulas of JANI as patterns in scopes, and back (docs/spec/properties.md#conversion)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from roaml.jani.expressions import Binary, Expression, Integer, Real, Unary
from roaml.jani.nesting import is_nested
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.properties import (
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    Formula,
    Interval,
    ProperFormula,
    UnaryPath,
    UnaryPathOperator,
)
from roaml.observers.properties import CLOSE, LEFT, OPEN, RIGHT, Pattern, PatternProperty, ScopeKind, Window
from roaml.record import Record
from roaml.smc.nested import ObservedFormula, without_nesting, without_nesting_before
from roaml.smc.normal_form import (
    TRUE,
    NestingError,
    are_opposite,
    finally_,
    globally,
    joined,
    key_of,
    lasting_condition,
    negated,
    normal_form,
    until,
    weak,
)

_SECOND = 1_000_000_000
"""The number of nanoseconds in a second."""
_FROM_START = (ScopeKind.GLOBALLY, ScopeKind.BEFORE, ScopeKind.UNTIL)
"""The scopes with only one stretch, which begins at the start of the trace (docs/spec/xml-properties.md#scopes)."""


class PatternForm(Record, frozen=True):
    """A pattern in a scope, and its conditions by the names of its inputs."""

    property: PatternProperty
    conditions: Mapping[str, Expression]


def needs_first(property_: PatternProperty, name: str) -> bool:
    """Whether a property depends only on the first time at which the condition `name` holds or, for universality, at
    which the condition does not hold.

    If so, a condition may use the flag of an event: the flag is true for the first time in the step in which the event
    is sent for the first time.
    """
    if name == OPEN:
        return not property_.scope.has_until
    if name == CLOSE or property_.pattern is Pattern.RESPONSE:
        return False
    return property_.scope in _FROM_START


# ------------------------------------------------------------------ from JANI


def pattern_of(path: Formula, step: int | None) -> PatternForm | None:
    """The pattern that is equivalent to a path formula; `None` if there is none.

    Args:
        step: the step of the clock in ns; `None` if there is no clock.
    """
    try:
        form = _nested(path, step)
        return form if form is not None else _flat(normal_form(path))
    except NestingError:
        return None


def _nested(path: Formula, step: int | None) -> PatternForm | None:
    observed: list[ObservedFormula] = []

    def observe(formula: ObservedFormula) -> Formula:
        observed.append(formula)
        return TRUE

    result: Formula | None = None
    if isinstance(path, BinaryFormula):
        result = without_nesting_before(path, observe)
    elif lasting_condition(path) is None and is_nested(path):
        result = without_nesting(path, step, observe)
        if result != TRUE or len(observed) != 1:
            raise NestingError
    if result != TRUE or len(observed) != 1 or not isinstance(observed[0].property, PatternProperty):
        return None
    property_, conditions = observed[0].property, dict(observed[0].conditions)
    closing = conditions.get(CLOSE if property_.scope.has_until else OPEN)
    if property_.pattern is Pattern.RESPONSE and closing is not None and property_.scope is not ScopeKind.AFTER:
        conditions[RIGHT] = _without(conditions[RIGHT], closing)
    return PatternForm(property_, conditions)


def _flat(path: Formula) -> PatternForm | None:
    """The pattern of a formula in normal form whose path operators are applied to conditions; `None` if there is
    none."""
    match path:
        case UnaryPath(operator=operator, operand=operand) if path.time_bounds is None:
            if isinstance(operand, ProperFormula):
                return None
            is_existence = operator is UnaryPathOperator.FINALLY
            return _form(Pattern.EXISTENCE if is_existence else Pattern.UNIVERSALITY, ScopeKind.GLOBALLY, operand)
        case BinaryPath(operator=BinaryPathOperator.WEAK_UNTIL, left=left, right=right):
            if isinstance(left, ProperFormula) or isinstance(right, ProperFormula):
                return None
            if isinstance(left, Unary) and left.operator is UnaryOperator.NOT:
                return _form(Pattern.PRECEDENCE, ScopeKind.GLOBALLY, right, left.operand)
            return _form(Pattern.UNIVERSALITY, ScopeKind.UNTIL, left, opening=right)
        case BinaryPath(operator=BinaryPathOperator.UNTIL, left=left, right=right):
            if isinstance(left, ProperFormula) or isinstance(right, ProperFormula):
                return None
            return _existence(ScopeKind.UNTIL, right, negated(left))
        case BinaryFormula(BinaryOperator.OR, UnaryPath() as never, BinaryPath() as rest):
            return _before(never, rest)
        case BinaryFormula(BinaryOperator.OR, BinaryPath() as rest, UnaryPath() as never):
            return _before(never, rest)
    return None


def _before(never: UnaryPath, rest: BinaryPath) -> PatternForm | None:
    """The pattern of `G ¬close ∨ (left U right)`, that is, of `F close ⇒ (left U right)`; `None` if there is none."""
    if never.operator is not UnaryPathOperator.GLOBALLY or never.time_bounds is not None:
        return None
    if rest.operator is not BinaryPathOperator.UNTIL:
        return None
    left, right, ends = rest.left, rest.right, never.operand
    if isinstance(left, ProperFormula) or isinstance(right, ProperFormula) or isinstance(ends, ProperFormula):
        return None
    close = negated(ends)
    if key_of(right) == key_of(close):
        return _form(Pattern.UNIVERSALITY, ScopeKind.BEFORE, left, opening=close)
    if are_opposite(left, close):
        return _existence(ScopeKind.BEFORE, right, close)
    parts = list(operands(right, BinaryOperator.OR))
    others = [part for part in parts if key_of(part) != key_of(close)]
    if others and len(others) < len(parts):
        first = _all(others, is_or=True)
        return _form(Pattern.PRECEDENCE, ScopeKind.BEFORE, first, negated(left), opening=close)
    return None


def _existence(scope: ScopeKind, right: Expression, close: Expression) -> PatternForm | None:
    """The pattern of `¬close U right` if `right` is `event ∧ ¬close`, otherwise `None`."""
    event = _without(right, close)
    return None if event is right else _form(Pattern.EXISTENCE, scope, event, opening=close)


def _form(
    pattern: Pattern,
    scope: ScopeKind,
    left: Expression,
    right: Expression | None = None,
    opening: Expression | None = None,
) -> PatternForm:
    written = {LEFT: left, RIGHT: right, OPEN: opening}
    conditions = {name: condition for name, condition in written.items() if condition is not None}
    return PatternForm(PatternProperty(pattern, scope), conditions)


def _without(condition: Expression, excluded: Expression) -> Expression:
    """A conjunction without the operands that are the negation of `excluded`; `condition` itself if there are none."""
    parts = list(operands(condition, BinaryOperator.AND))
    others = [part for part in parts if not are_opposite(part, excluded)]
    return _all(others) if others and len(others) < len(parts) else condition


def operands(condition: Expression, operator: BinaryOperator) -> Iterator[Expression]:
    """The operands of a conjunction or disjunction, as `operator` selects; `condition` itself if it is another
    expression."""
    waiting = [condition]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Binary) and part.operator is operator:
            waiting += (part.right, part.left)
        else:
            yield part


def _all(parts: list[Expression], *, is_or: bool = False) -> Expression:
    result = parts[0]
    for part in parts[1:]:
        result = Binary(BinaryOperator.OR if is_or else BinaryOperator.AND, result, part)
    return result


# --------------------------------------------------------------------- to JANI


def path_of(form: PatternForm, step: int | None) -> Formula | None:
    """The path formula that is equivalent to a pattern; `None` if there is none.

    Args:
        step: the step of the clock in ns; `None` if there is no clock.
    """
    property_ = form.property
    pattern, scope = property_.pattern, property_.scope
    if pattern is Pattern.ABSENCE:
        conditions = {**form.conditions, LEFT: negated(form.conditions[LEFT])}
        return path_of(PatternForm(PatternProperty(Pattern.UNIVERSALITY, scope, property_.window), conditions), step)
    bounds: Interval | None = None
    if not property_.window.is_unbounded:
        is_response = pattern is Pattern.RESPONSE and scope in (ScopeKind.GLOBALLY, ScopeKind.AFTER)
        is_once = pattern in (Pattern.UNIVERSALITY, Pattern.EXISTENCE) and scope is ScopeKind.AFTER
        if step is None or not (is_response or is_once):
            return None
        bounds = _bounds(property_.window, step)
    left = form.conditions[LEFT]
    right, opening = form.conditions.get(RIGHT, TRUE), form.conditions.get(OPEN, TRUE)
    closing = form.conditions.get(CLOSE, TRUE)
    match scope:
        case ScopeKind.GLOBALLY:
            return _globally(pattern, left, right, bounds)
        case ScopeKind.UNTIL:
            return _until(pattern, left, right, opening)
        case ScopeKind.BEFORE:
            path = _until(pattern, left, right, opening)
            if not isinstance(path, BinaryPath):
                return None
            strong = BinaryPath(BinaryPathOperator.UNTIL, path.left, path.right)
            return _implies(finally_(opening), strong)
        case ScopeKind.AFTER:
            return _after(pattern, left, right, opening, bounds)
    return _between(pattern, left, right, opening, closing, is_weak=scope is ScopeKind.AFTER_UNTIL)


def _globally(pattern: Pattern, left: Expression, right: Expression, bounds: Interval | None) -> Formula | None:
    match pattern:
        case Pattern.UNIVERSALITY:
            return globally(left)
        case Pattern.EXISTENCE:
            return finally_(left)
        case Pattern.RESPONSE:
            return globally(_implies(left, UnaryPath(UnaryPathOperator.FINALLY, right, time_bounds=bounds)))
        case Pattern.PRECEDENCE:
            return weak(negated(right), left)
    return None


def _until(pattern: Pattern, left: Expression, right: Expression, close: Expression) -> Formula | None:
    match pattern:
        case Pattern.UNIVERSALITY:
            return weak(left, close)
        case Pattern.EXISTENCE:
            return until(negated(close), joined(False, left, negated(close)))
        case Pattern.RESPONSE:
            return weak(_answered(left, right, close), close)
        case Pattern.PRECEDENCE:
            return weak(negated(right), joined(True, left, close))
    return None


def _after(
    pattern: Pattern, left: Expression, right: Expression, opening: Expression, bounds: Interval | None
) -> Formula | None:
    match pattern:
        case Pattern.UNIVERSALITY if bounds is None:
            return globally(_implies(opening, globally(left)))
        case Pattern.UNIVERSALITY:
            path: Formula = UnaryPath(UnaryPathOperator.GLOBALLY, left, time_bounds=bounds)
        case Pattern.EXISTENCE:
            path = UnaryPath(UnaryPathOperator.FINALLY, left, time_bounds=bounds)
        case Pattern.PRECEDENCE:
            path = weak(negated(right), left)
        case Pattern.RESPONSE:
            answer = UnaryPath(UnaryPathOperator.FINALLY, right, time_bounds=bounds)
            return globally(_implies(opening, globally(_implies(left, answer))))
        case _:
            return None
    return weak(negated(opening), joined(False, opening, path))


def _between(
    pattern: Pattern, left: Expression, right: Expression, opening: Expression, close: Expression, *, is_weak: bool
) -> Formula | None:
    match pattern:
        case Pattern.UNIVERSALITY:
            stays: Formula = left
        case Pattern.RESPONSE:
            stays = _answered(left, right, close)
        case _:
            return None  # these are required once in a stretch, not after each step that may open it
    if is_weak:
        return globally(_implies(opening, weak(stays, close)))
    return globally(_implies(joined(False, opening, finally_(close)), until(stays, close)))


def _answered(request: Expression, answer: Expression, close: Expression) -> Formula:
    """The formula `request ⇒ (¬close U (answer ∧ ¬close))`."""
    return _implies(request, until(negated(close), joined(False, answer, negated(close))))


def _implies(left: Formula, right: Formula) -> Formula:
    if isinstance(left, ProperFormula) or isinstance(right, ProperFormula):
        return BinaryFormula(BinaryOperator.IMPLIES, left, right)
    return Binary(BinaryOperator.IMPLIES, left, right)


def _bounds(window: Window, step: int) -> Interval:
    def seconds(steps: int) -> Expression:
        value = Fraction(steps * step, _SECOND)
        return Integer(int(value)) if value.denominator == 1 else Real(float(value))

    lower = seconds(window.lower) if window.lower else None
    return Interval(lower, None if window.upper is None else seconds(window.upper))
