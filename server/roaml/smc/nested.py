# SPDX-License-Identifier: Apache-2.0
"""Nested path formulas that observers can decide (docs/spec/properties.md#nested).

A formula is brought into its normal form, which is then compared with the forms of the patterns. If none of them fits,
the negation of the formula is compared.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TypeVar

from roaml.jani.expressions import Expression, Integer, Real
from roaml.jani.nesting import is_about_paths, is_nested
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.properties import (
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    Formula,
    PathBounds,
    ProperFormula,
    UnaryFormula,
    UnaryPath,
    UnaryPathOperator,
    children,
)
from roaml.observers import properties as observed
from roaml.observers.properties import (
    CLOSE,
    LEFT,
    OPEN,
    RIGHT,
    Atom,
    FormulaProperty,
    Pattern,
    PatternProperty,
    ScopeKind,
    Since,
    Window,
    implies,
    once,
)
from roaml.record import Record
from roaml.smc.normal_form import (
    TRUE,
    Disjunction,
    NestingError,
    are_opposite,
    clauses_of,
    conjuncts,
    finally_,
    globally,
    joined,
    key_of,
    lasting_condition,
    negated,
    normal_form,
    parts_of,
)

MAX_FORMULAS = 100
"""The maximum number of path operators in a nested formula."""
MAX_STEPS = 1_000_000
"""The maximum bound on the time, in clock steps."""
_SECOND = 1_000_000_000
"""The number of nanoseconds in a second."""
_ANY_TIME = Window()
_T = TypeVar("_T")


class ObservedFormula(Record, frozen=True):
    """A property of the sequence of states, and pairs of an input of its observer and a condition on states."""

    property: observed.Property
    conditions: tuple[tuple[str, Expression], ...]


def without_nesting(formula: Formula, step: int | None, observe: Callable[[ObservedFormula], Formula]) -> Formula:
    """An equivalent path formula in which observers replace the nested formulas.

    Args:
        formula: a path formula for which `is_nested` is true.
        step: the step of the clock in ns; `None` if there is no clock.
        observe: creates an observer, and returns the path formula that states that its property holds.

    Raises:
        NestingError: no pattern has this form, or there are more than `MAX_FORMULAS` path operators.
    """
    if _count_formulas(formula) > MAX_FORMULAS:
        raise NestingError
    return _Recogniser(step, observe).path(normal_form(formula))


def without_nesting_before(formula: BinaryFormula, observe: Callable[[ObservedFormula], Formula]) -> Formula | None:
    """Like `without_nesting`, for `F close ⇒ ((request ⇒ (¬close U (answer ∧ ¬close))) U close)`; `None` if the formula
    has another form."""
    if _count_formulas(formula) > MAX_FORMULAS:
        return None
    try:
        match normal_form(formula):
            case BinaryFormula(BinaryOperator.OR, UnaryPath() as never, BinaryPath() as path):
                return _Recogniser(None, observe).before(never, path)
    except NestingError:
        pass
    return None


def _count_formulas(formula: Formula) -> int:
    count, waiting = 0, [formula]
    while waiting and count <= MAX_FORMULAS:
        part = waiting.pop()
        if isinstance(part, ProperFormula):
            count += 1
            waiting += children(part)
    return count


# ----------------------------------------------------------------------- forms


class _Request(Record, frozen=True):
    """A request and its answer: `request ⇒ F answer`; with a scope, `request ⇒ (¬close U (answer ∧ ¬close))`."""

    request: Expression
    answer: Expression
    window: Window = _ANY_TIME


class _Recogniser:
    def __init__(self, step: int | None, observe: Callable[[ObservedFormula], Formula]) -> None:
        self.step = step
        self.observe = observe

    def path(self, formula: Formula) -> Formula:
        """A path formula without nesting that is equivalent to one in normal form."""
        match formula:
            case BinaryFormula(operator, left, right):
                return BinaryFormula(operator, self.path(left), self.path(right))
            case UnaryPath() | BinaryPath() if lasting_condition(formula) is None and is_nested(formula):
                return self.nested_or_opposite(formula)
            case UnaryPath() if formula.time_bounds is not None:
                raise NestingError(is_time=True)
        return formula

    def nested_or_opposite(self, formula: Formula) -> Formula:
        attempt = _Recogniser(self.step, lambda _: formula)  # creates no observers
        try:
            attempt.nested(formula)
        except NestingError as error:
            opposite = normal_form(formula, is_negated=True)
            try:
                attempt.nested(opposite)
            except NestingError as other:
                raise NestingError(is_time=error.is_time or other.is_time) from None
            return UnaryFormula(UnaryOperator.NOT, self.nested(opposite))
        return self.nested(formula)

    def nested(self, formula: Formula) -> Formula:
        match formula:
            case UnaryPath(operator=UnaryPathOperator.GLOBALLY, operand=operand):
                if formula.time_bounds is not None:
                    raise NestingError
                return _all([self.always(clause) for clause in clauses_of(operand)])
            case BinaryPath(operator=BinaryPathOperator.WEAK_UNTIL, left=left, right=right):
                return self.weak_until(left, right)
            case BinaryPath(operator=BinaryPathOperator.UNTIL, left=left, right=right):
                # The condition on the state ends the stretch, whatever the other parts require at its end.
                ends = [part for part in conjuncts(right) if not isinstance(part, ProperFormula)]
                if not ends:
                    raise NestingError
                end: Formula = ends[0]
                for part in ends[1:]:
                    end = joined(False, end, part)
                return _all([self.weak_until(left, right), finally_(end)])
        raise NestingError

    # ------------------------------------------------------- G (condition ∨ …)

    def always(self, clause: Disjunction) -> Formula:
        lasting = [path for path in clause.paths if lasting_condition(path) is not None]
        paths = [path for path in clause.paths if lasting_condition(path) is None]
        if lasting:
            # Whether `F G` or `G F` holds for a path does not depend on where the path begins.
            result = self.always(Disjunction(clause.condition, tuple(paths)))
            for path in lasting:
                result = BinaryFormula(BinaryOperator.OR, result, path)
            return result
        trigger = negated(clause.condition)
        match paths:
            case []:
                return globally(clause.condition)
            case [UnaryPath(operator=UnaryPathOperator.FINALLY)]:
                return self.response(self.request(clause), ScopeKind.GLOBALLY)
            case [UnaryPath(operator=UnaryPathOperator.GLOBALLY, operand=operand) as path]:
                if path.time_bounds is not None:
                    return self.bounded_after(trigger, _condition(operand), self.window(path))
                return _all([self.always_after(trigger, inner) for inner in clauses_of(operand)])
            case [BinaryPath(left=left, right=right) as path]:
                close = _close_of_existence(trigger, left, right)
                if close is not None:
                    # Each trigger needs a separate event before `close`, so this is a response.
                    is_until = path.operator is BinaryPathOperator.UNTIL
                    scope = ScopeKind.AFTER_UNTIL if is_until else ScopeKind.BETWEEN
                    request = _Request(trigger, _condition(right))
                    return self.response(request, scope, {OPEN: TRUE, CLOSE: close})
                stays = self.after_until(trigger, left, _condition(right))
                if path.operator is BinaryPathOperator.UNTIL:
                    ends = self.response(_Request(trigger, _condition(right)), ScopeKind.GLOBALLY)
                    return _all([stays, ends])
                return stays
            case [UnaryPath() as never, BinaryPath() as path] | [BinaryPath() as path, UnaryPath() as never]:
                if never.operator is UnaryPathOperator.GLOBALLY and never.time_bounds is None:
                    close = negated(_condition(never.operand))
                    return self.between(trigger, close, path.left, _condition(path.right))
        raise NestingError

    def request(self, clause: Disjunction, close: Expression | None = None) -> _Request:
        """The request that a clause contains. If given, `close` ends the stretch in which the answer is required."""
        request = negated(clause.condition)
        match clause.paths:
            case (UnaryPath(operator=UnaryPathOperator.FINALLY, operand=answer) as path,) if close is None:
                return _Request(request, _condition(answer), self.window(path))
            case (BinaryPath(operator=BinaryPathOperator.UNTIL, left=left, right=right),) if close is not None:
                waits, answer = _condition(left), _condition(right)
                if are_opposite(waits, close) and key_of(close, is_negated=True) in parts_of(answer, "and"):
                    return _Request(request, answer)
        raise NestingError

    def always_after(self, trigger: Expression, clause: Disjunction) -> Formula:
        """The translation of `G (trigger ⇒ G clause)`."""
        if not clause.paths:
            return self.pattern(Pattern.UNIVERSALITY, ScopeKind.AFTER, {LEFT: clause.condition, OPEN: trigger})
        return self.response(self.request(clause), ScopeKind.AFTER, {OPEN: trigger})

    def bounded_after(self, trigger: Expression, condition: Expression, window: Window) -> Formula:
        """The translation of `G (trigger ⇒ G[window] condition)`: after a trigger, the negated condition is forbidden
        in the window."""
        formula = implies(once(Atom(OPEN), window), Atom(LEFT))
        return self._observed(FormulaProperty(formula), {LEFT: condition, OPEN: trigger})

    def after_until(self, trigger: Expression, stays: Formula, close: Expression) -> Formula:
        """The translation of `G (trigger ⇒ (stays W close))`."""
        conditions = {OPEN: trigger, CLOSE: close}
        if not isinstance(stays, ProperFormula):
            return self.pattern(Pattern.UNIVERSALITY, ScopeKind.AFTER_UNTIL, {LEFT: stays, **conditions})
        (clause,) = _single(clauses_of(stays))
        return self.response(self.request(clause, close), ScopeKind.AFTER_UNTIL, conditions)

    def between(self, trigger: Expression, close: Expression, stays: Formula, end: Expression) -> Formula:
        """The translation of `G (trigger ∧ F close ⇒ (stays U end))`."""
        conditions = {OPEN: trigger, CLOSE: close}
        if key_of(close) == key_of(end):
            if not isinstance(stays, ProperFormula):
                return self.pattern(Pattern.UNIVERSALITY, ScopeKind.BETWEEN, {LEFT: stays, **conditions})
            (clause,) = _single(clauses_of(stays))
            return self.response(self.request(clause, close), ScopeKind.BETWEEN, conditions)
        if key_of(close) not in parts_of(end, "or"):
            raise NestingError
        # The formula says at `close`: since a trigger after which `end` did not hold, `stays` was not violated.
        is_open = Since(observed.Not(Atom(RIGHT)), observed.And(Atom(OPEN), observed.Not(Atom(RIGHT))))
        violated = observed.And(observed.Not(observed.Or(Atom(LEFT), Atom(RIGHT))), is_open)
        formula = implies(Atom(CLOSE), observed.Not(once(violated)))
        return self._observed(FormulaProperty(formula), {LEFT: _condition(stays), RIGHT: end, **conditions})

    # ------------------------------------------------------------------ W

    def weak_until(self, left: Formula, right: Formula) -> Formula:
        if isinstance(left, ProperFormula):
            # (request ⇒ …) W close
            close = _condition(right)
            (clause,) = _single(clauses_of(left))
            return self.response(self.request(clause, close), ScopeKind.UNTIL, {OPEN: close})
        parts = list(conjuncts(right))
        opens = [part for part in parts if not isinstance(part, ProperFormula)]
        (opening,) = _single(opens)
        if not are_opposite(left, opening):
            raise NestingError
        return _all([self.after(opening, part) for part in parts if isinstance(part, ProperFormula)])

    def before(self, never: UnaryPath, path: BinaryPath) -> Formula:
        """The translation of `G ¬close ∨ ((request ⇒ …) U close)`."""
        if never.operator is not UnaryPathOperator.GLOBALLY or never.time_bounds is not None:
            raise NestingError
        close = _condition(path.right)
        if not are_opposite(_condition(never.operand), close):
            raise NestingError
        (clause,) = _single(clauses_of(path.left))
        return self.response(self.request(clause, close), ScopeKind.BEFORE, {OPEN: close})

    def after(self, opening: Expression, path: Formula) -> Formula:
        """The translation of `¬opening W (opening ∧ path)`."""
        conditions = {OPEN: opening}
        match path:
            case UnaryPath(operator=UnaryPathOperator.FINALLY, operand=operand):
                event = {LEFT: _condition(operand), **conditions}
                return self.pattern(Pattern.EXISTENCE, ScopeKind.AFTER, event, self.window(path))
            case UnaryPath(operator=UnaryPathOperator.GLOBALLY, operand=operand) if not is_about_paths(operand):
                always = {LEFT: _condition(operand), **conditions}
                return self.pattern(Pattern.UNIVERSALITY, ScopeKind.AFTER, always, self.window(path))
            case UnaryPath(operator=UnaryPathOperator.GLOBALLY, operand=operand) if path.time_bounds is None:
                return _all([self.always_after(opening, clause) for clause in clauses_of(operand)])
            case BinaryPath(left=left, right=right):
                first = _condition(right)
                pair = {LEFT: first, RIGHT: negated(_condition(left)), **conditions}
                precedes = self.pattern(Pattern.PRECEDENCE, ScopeKind.AFTER, pair)
                if path.operator is BinaryPathOperator.UNTIL:
                    return _all(
                        [precedes, self.pattern(Pattern.EXISTENCE, ScopeKind.AFTER, {LEFT: first, **conditions})]
                    )
                return precedes
        raise NestingError

    # -------------------------------------------------------------- observers

    def response(self, request: _Request, scope: ScopeKind, conditions: dict[str, Expression] | None = None) -> Formula:
        pair = {LEFT: request.request, RIGHT: request.answer}
        return self.pattern(Pattern.RESPONSE, scope, {**pair, **(conditions or {})}, request.window)

    def pattern(
        self, pattern: Pattern, scope: ScopeKind, conditions: dict[str, Expression], window: Window = _ANY_TIME
    ) -> Formula:
        return self._observed(PatternProperty(pattern, scope, window), conditions)

    def _observed(self, property_: observed.Property, conditions: dict[str, Expression]) -> Formula:
        return self.observe(ObservedFormula(property_, tuple(conditions.items())))

    def window(self, path: PathBounds) -> Window:
        """The bounds on the time of F and G, in clock steps.

        Raises:
            NestingError: there is no clock; or the bounds are not literals, are too large, or contain no step of the
                clock.
        """
        interval = path.time_bounds
        if interval is None:
            return Window()
        if self.step is None:
            raise NestingError(is_time=True)
        lower, upper = self._steps(interval.lower), self._steps(interval.upper)
        first = 0 if lower is None else math.floor(lower) + 1 if interval.lower_exclusive else math.ceil(lower)
        last = None if upper is None else math.ceil(upper) - 1 if interval.upper_exclusive else math.floor(upper)
        if max(first, last or 0) > MAX_STEPS:
            raise NestingError(is_time=True)
        try:
            return Window(max(first, 0), last)
        except ValueError:
            raise NestingError(is_time=True) from None

    def _steps(self, bound: Expression | None) -> Fraction | None:
        assert self.step is not None
        match bound:
            case None:
                return None
            case Integer(value):
                return Fraction(value * _SECOND, self.step)
            case Real(number):
                return Fraction(repr(number)) * _SECOND / self.step
        raise NestingError(is_time=True)


def _close_of_existence(trigger: Expression, left: Formula, right: Formula) -> Expression | None:
    """The condition u of `trigger ⇒ (¬u U (right ∧ ¬u))` if the trigger includes ¬u; `None` for another form."""
    if isinstance(left, ProperFormula) or isinstance(right, ProperFormula):
        return None
    waits = key_of(left)
    is_existence = waits in parts_of(right, "and") and waits in parts_of(trigger, "and")
    return negated(left) if is_existence else None


def _single(items: Sequence[_T]) -> Sequence[_T]:
    if len(items) != 1:
        raise NestingError
    return items


def _condition(formula: Formula) -> Expression:
    if isinstance(formula, ProperFormula):
        raise NestingError
    return formula


def _all(formulas: list[Formula]) -> Formula:
    if not formulas:
        raise NestingError
    result = formulas[0]
    for formula in formulas[1:]:
        result = BinaryFormula(BinaryOperator.AND, result, formula)
    return result
