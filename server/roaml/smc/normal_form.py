# SPDX-License-Identifier: Apache-2.0
"""The normal form of path formulas: negations only of state formulas, and only F, G, U, W, ∧ and ∨ above them. F and G
may have bounds on the time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

from roaml.jani.deep import Steps, run
from roaml.jani.expressions import Binary, Boolean, Expression, Unary
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
)
from roaml.record import Record, replace

MAX_CLAUSES = 16
"""The maximum number of clauses of a conjunctive normal form."""


class NestingError(Exception):
    """A nested formula does not have the form of a pattern.

    Attributes:
        is_time: whether the reason is a bound on the time.
    """

    def __init__(self, *, is_time: bool = False) -> None:
        super().__init__()
        self.is_time = is_time


def lasting_condition(formula: Formula) -> tuple[Formula, bool] | None:
    """The condition c of `F G c` or `G F c`, and whether the formula is `F G c`; `None` for another form."""
    if not isinstance(formula, UnaryPath) or not isinstance(formula.operand, UnaryPath):
        return None
    outer, inner = formula, formula.operand
    if has_bounds(outer) or has_bounds(inner):
        return None
    match outer.operator, inner.operator:
        case UnaryPathOperator.FINALLY, UnaryPathOperator.GLOBALLY:
            return inner.operand, True
        case UnaryPathOperator.GLOBALLY, UnaryPathOperator.FINALLY:
            return inner.operand, False
    return None


def has_bounds(path: PathBounds) -> bool:
    return bool(path.step_bounds or path.time_bounds or path.reward_bounds)


def normal_form(formula: Formula, *, is_negated: bool = False) -> Formula:
    """The negation normal form of a path formula, with F, G, U, W, ∧ and ∨; F and G may have bounds on the time.

    Raises:
        NestingError: the formula contains other operators, or other bounds.
    """
    match formula:
        case UnaryFormula(operator=UnaryOperator.NOT, operand=operand):
            return normal_form(operand, is_negated=not is_negated)
        case BinaryFormula(BinaryOperator.IMPLIES, left, right):
            return joined(
                not is_negated, normal_form(left, is_negated=not is_negated), normal_form(right, is_negated=is_negated)
            )
        case BinaryFormula(BinaryOperator.AND | BinaryOperator.OR as operator, left, right):
            is_or = (operator is BinaryOperator.OR) != is_negated
            return joined(is_or, normal_form(left, is_negated=is_negated), normal_form(right, is_negated=is_negated))
        case UnaryPath(operator=UnaryPathOperator.FINALLY | UnaryPathOperator.GLOBALLY as operator):
            if formula.step_bounds or formula.reward_bounds:
                raise NestingError
            operand = normal_form(formula.operand, is_negated=is_negated)
            is_eventual = (operator is UnaryPathOperator.FINALLY) != is_negated
            name = UnaryPathOperator.FINALLY if is_eventual else UnaryPathOperator.GLOBALLY
            return replace(formula, operator=name, operand=operand, comment=None)
        case BinaryPath():
            return _normal_binary(formula, is_negated)
        case _ if isinstance(formula, ProperFormula):
            raise NestingError
    return negated(formula) if is_negated else formula


def _normal_binary(formula: BinaryPath, is_negated: bool) -> Formula:
    if has_bounds(formula):
        raise NestingError(is_time=formula.time_bounds is not None)
    operator = formula.operator
    left = normal_form(formula.left, is_negated=is_negated)
    right = normal_form(formula.right, is_negated=is_negated)
    if operator is BinaryPathOperator.RELEASE:
        # a R b = b W (a ∧ b), and ¬(a R b) = ¬a U ¬b
        return until(left, right) if is_negated else weak(right, joined(False, left, right))
    is_until = operator is BinaryPathOperator.UNTIL
    if not is_negated:
        return until(left, right) if is_until else weak(left, right)
    # ¬(a U b) = ¬b W (¬a ∧ ¬b), and ¬(a W b) = ¬b U (¬a ∧ ¬b)
    both = joined(False, left, right)
    return weak(right, both) if is_until else until(right, both)


def joined(is_or: bool, left: Formula, right: Formula) -> Formula:
    operator = BinaryOperator.OR if is_or else BinaryOperator.AND
    absorbing, neutral = Boolean(is_or), Boolean(not is_or)
    if absorbing in (left, right):
        return absorbing
    if left == neutral:
        return right
    if right == neutral:
        return left
    if isinstance(left, ProperFormula) or isinstance(right, ProperFormula):
        return BinaryFormula(operator, left, right)
    return Binary(operator, left, right)


def finally_(operand: Formula) -> Formula:
    return UnaryPath(UnaryPathOperator.FINALLY, operand)


def globally(operand: Formula) -> Formula:
    return UnaryPath(UnaryPathOperator.GLOBALLY, operand)


def until(left: Formula, right: Formula) -> Formula:
    return finally_(right) if left == TRUE else BinaryPath(BinaryPathOperator.UNTIL, left, right)


def weak(left: Formula, right: Formula) -> Formula:
    return globally(left) if right == FALSE else BinaryPath(BinaryPathOperator.WEAK_UNTIL, left, right)


class Disjunction(Record, frozen=True):
    """A disjunction of a condition and path formulas."""

    condition: Expression
    paths: tuple[Formula, ...]


def clauses_of(formula: Formula) -> list[Disjunction]:
    """The clauses of the conjunctive normal form of a formula.

    Raises:
        NestingError: there are more than `MAX_CLAUSES`.
    """
    match formula:
        case BinaryFormula(BinaryOperator.AND, left, right):
            return [*clauses_of(left), *clauses_of(right)]
        case BinaryFormula(BinaryOperator.OR, left, right):
            clauses = [
                Disjunction(_or(c for c in (a.condition, b.condition) if c != FALSE), (*a.paths, *b.paths))
                for a in clauses_of(left)
                for b in clauses_of(right)
            ]
            if len(clauses) > MAX_CLAUSES:
                raise NestingError
            return clauses
    if isinstance(formula, ProperFormula):
        return [Disjunction(FALSE, (formula,))]
    return [Disjunction(formula, ())]


def conjuncts(formula: Formula) -> Iterator[Formula]:
    if isinstance(formula, BinaryFormula) and formula.operator is BinaryOperator.AND:
        yield from conjuncts(formula.left)
        yield from conjuncts(formula.right)
    else:
        yield formula


# ------------------------------------------------------------------ conditions

TRUE, FALSE = Boolean(True), Boolean(False)


def negated(condition: Expression) -> Expression:
    match condition:
        case Boolean(value):
            return Boolean(not value)
        case Unary(UnaryOperator.NOT, operand):
            return operand
    return Unary(UnaryOperator.NOT, condition, origin=condition.origin)


def _or(conditions: Iterable[Expression]) -> Expression:
    result: Expression = FALSE
    for condition in conditions:
        result = condition if result == FALSE else Binary(BinaryOperator.OR, result, condition)
    return result


_Key: TypeAlias = object
_OPPOSITE = {
    BinaryOperator.EQUAL: BinaryOperator.NOT_EQUAL,
    BinaryOperator.NOT_EQUAL: BinaryOperator.EQUAL,
    BinaryOperator.LESS: BinaryOperator.GREATER_EQUAL,
    BinaryOperator.GREATER_EQUAL: BinaryOperator.LESS,
    BinaryOperator.GREATER: BinaryOperator.LESS_EQUAL,
    BinaryOperator.LESS_EQUAL: BinaryOperator.GREATER,
}


def key_of(condition: Expression, *, is_negated: bool = False) -> _Key:
    """A key of a condition. Conditions with equal keys are equivalent."""
    return run(_key_steps(condition, is_negated))


def _key_steps(condition: Expression, is_negated: bool) -> Steps[_Key]:
    match condition:
        case Boolean(value):
            return value != is_negated
        case Unary(UnaryOperator.NOT, operand):
            return (yield _key_steps(operand, not is_negated))
        case Binary(BinaryOperator.IMPLIES, left, right):
            either = Binary(BinaryOperator.OR, Unary(UnaryOperator.NOT, left), right)
            return (yield _key_steps(either, is_negated))
        case Binary(BinaryOperator.AND | BinaryOperator.OR as operator, left, right):
            parts: set[_Key] = set()
            name = "and" if (operator is BinaryOperator.AND) != is_negated else "or"
            for operand in (left, right):
                key = yield _key_steps(operand, is_negated)
                is_same = isinstance(key, tuple) and key[0] == name
                parts |= key[1] if is_same else {key}
            return name, frozenset(parts)
        case Binary(operator, left, right) if is_negated and operator in _OPPOSITE:
            return "is", Binary(_OPPOSITE[operator], left, right)
    return "not" if is_negated else "is", condition


def are_opposite(left: Expression, right: Expression) -> bool:
    return key_of(left) == key_of(right, is_negated=True)


def parts_of(condition: Expression, name: str, *, is_negated: bool = False) -> frozenset[_Key]:
    """The keys of the operands of a chain of ∧ (if `name` is `and`) or ∨ (`or`); the key of `condition` itself if it is
    another expression."""
    key = key_of(condition, is_negated=is_negated)
    return key[1] if isinstance(key, tuple) and key[0] == name else frozenset((key,))
