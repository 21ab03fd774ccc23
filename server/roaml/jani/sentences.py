# SPDX-License-Identifier: Apache-2.0
"""Writes properties as English sentences, for people who do not know the notation: `Pmax=? [ F done ]` is about traces
in which "`done` holds at some time". Whether the minimum or the maximum is asked for is not part of the sentence,
because results name the one that they state."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.jani.expressions import Binary, Boolean, Expression, Integer, Name, Real, Unary
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.properties import (
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    Expectation,
    Filter,
    Formula,
    Interval,
    PathBounds,
    Predicate,
    Probability,
    StatePredicate,
    UnaryFormula,
    UnaryPath,
    UnaryPathOperator,
    identifiers,
)
from roaml.jani.semantics import Value

MAX_LENGTH = 160
"""The maximum number of characters of a sentence. Longer ones are harder to read than formulas."""
_PREDICATES = {
    StatePredicate.DEADLOCK: "no step is possible",
    StatePredicate.INITIAL: "the state is initial",
    StatePredicate.TIMELOCK: "time cannot pass",
}
_WORDS = {BinaryOperator.AND: "and", BinaryOperator.OR: "or"}


class _UnsaidError(Exception):
    """A formula has no sentence."""


def sentence(formula: Formula, constants: Mapping[str, Value] | None = None) -> str:
    """What a property requires of a trace, or which value it asks for, as a sentence; "" if there is none, because a
    part has no simple words or the sentence would be long.

    Args:
        constants: the values of constants, which follow the sentence if it names them, such as `(limit = 3)`.
    """
    try:
        text = _asked(formula)
    except _UnsaidError:
        return ""
    if len(text) >= MAX_LENGTH:
        return ""
    known = constants or {}
    named = dict.fromkeys(name for name, _ in identifiers(formula) if isinstance(known.get(name), (bool, int, float)))
    values = ", ".join(f"{name} = {_value(known[name])}" for name in named)
    return f"{text[:1].upper()}{text[1:]}{f' ({values})' if values else ''}."


def _value(value: Value) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else str(value)


def _asked(formula: Formula) -> str:
    match formula:
        case Filter():
            return _asked(formula.values)
        case BinaryFormula(left=(Filter() | Probability() | Expectation()) as compared):
            return _asked(compared)
        case BinaryFormula(right=(Filter() | Probability() | Expectation()) as compared):
            return _asked(compared)
        case Probability():
            return _path(formula.path)
        case Expectation():
            return _expected(formula)
        case _:
            raise _UnsaidError


def _expected(formula: Expectation) -> str:
    is_count = isinstance(formula.reward, (Integer, Real)) and formula.reward.value == 1
    if formula.time_instant is not None or formula.reward_instants:
        raise _UnsaidError
    if formula.accumulate is None:
        reward, step = f"value of `{_expression(formula.reward)}`", "after"
    else:
        reward, step = "number of steps" if is_count else f"total of `{_expression(formula.reward)}`", "in the first"
    if formula.reach is not None:
        until = "until" if formula.accumulate is not None else "in the first state in which"
        return f"the expected {reward} {until} {_state(formula.reach)}"
    if formula.step_instant is None:
        raise _UnsaidError
    return f"the expected {reward} {step} {_steps(formula.step_instant)}"


def _path(formula: Formula) -> str:
    match formula:
        case UnaryPath(UnaryPathOperator.FINALLY, UnaryPath(UnaryPathOperator.GLOBALLY, condition)):
            return f"from some time on, {_state(condition)} for ever"
        case UnaryPath(UnaryPathOperator.GLOBALLY, UnaryPath(UnaryPathOperator.FINALLY, condition)):
            return f"again and again, {_state(condition)}"
        case UnaryPath(UnaryPathOperator.GLOBALLY, BinaryFormula(BinaryOperator.IMPLIES, left, answer)):
            if not isinstance(answer, UnaryPath) or answer.operator is not UnaryPathOperator.FINALLY:
                raise _UnsaidError
            later = _bounds(answer, "{} later", "then or later")
            return f"whenever {_state(left)}, {_state(answer.operand)} {later}{_bounds(formula, ' {}', '')}"
        case UnaryPath(UnaryPathOperator.FINALLY, condition):
            return f"{_state(condition)} {_bounds(formula, '{}', 'at some time')}"
        case UnaryPath(UnaryPathOperator.GLOBALLY, condition):
            return f"{_always(condition)}{_bounds(formula, ' {}', '')}"
        case UnaryPath(UnaryPathOperator.NEXT, condition):
            return f"{_state(condition)} after the next step{_bounds(formula, ' {}', '')}"
        case BinaryPath(BinaryPathOperator.UNTIL, left, right):
            end = f"{_state(right)} {_bounds(formula, '{}', 'at some time')}"
            return end if _is_true(left) else f"{end}, and until then {_always(left)}"
        case BinaryPath(BinaryPathOperator.WEAK_UNTIL, left, right):
            return f"{_state(left)} until {_state(right)}, or for ever{_bounds(formula, ' {}', '')}"
        case BinaryPath(BinaryPathOperator.RELEASE, left, right):
            return f"{_state(right)} up to and including the time when {_state(left)}, or for ever" + _bounds(
                formula, " {}", ""
            )
        case UnaryFormula(UnaryOperator.NOT, UnaryPath(UnaryPathOperator.FINALLY, condition)) if not _is_bounded(
            formula.operand
        ):
            return _never(condition)
        case UnaryFormula(UnaryOperator.NOT, operand):
            return f"it is not so that {_path(operand)}"
        case BinaryFormula(operator, left, right) if operator in _WORDS:
            word = "both " if operator is BinaryOperator.AND else "either "
            return f"{word}{_path(left)}, {_WORDS[operator]} {_path(right)}"
        case BinaryFormula(BinaryOperator.IMPLIES, left, right):
            return f"if {_path(left)}, then {_path(right)}"
        case _:
            return _state(formula)


def _is_true(formula: Formula) -> bool:
    return isinstance(formula, Boolean) and formula.value


def _is_bounded(path: Formula) -> bool:
    return isinstance(path, PathBounds) and bool(path.step_bounds or path.time_bounds or path.reward_bounds)


def _bounds(path: PathBounds, form: str, without: str) -> str:
    """The bounds of a path formula in words.

    Args:
        form: the words around them.
        without: the words if there are none.
    """
    if path.time_bounds is not None or (path.reward_bounds and path.step_bounds is not None):
        raise _UnsaidError
    if path.step_bounds is not None:
        return form.format(_steps_within(path.step_bounds))
    parts = []
    for bound in path.reward_bounds or ():
        words = _range(bound.bounds)
        parts.append(f"with a total of `{_expression(bound.reward)}` {words}")
    return form.format(" and ".join(parts)) if parts else without


def _steps_within(bounds: Interval) -> str:
    if bounds.lower_exclusive or bounds.upper_exclusive:
        raise _UnsaidError
    lower, upper = bounds.lower, bounds.upper
    if lower is None or (isinstance(lower, Integer) and lower.value == 0):
        return "at some time" if upper is None else f"within {_steps(upper)}"
    return f"after at least {_steps(lower)}" if upper is None else f"after {_expression(lower)} to {_steps(upper)}"


def _range(bounds: Interval) -> str:
    parts = []
    if bounds.lower is not None:
        parts.append(f"{'more than' if bounds.lower_exclusive else 'at least'} {_expression(bounds.lower)}")
    if bounds.upper is not None:
        parts.append(f"{'less than' if bounds.upper_exclusive else 'at most'} {_expression(bounds.upper)}")
    return " and ".join(parts)


def _steps(number: Expression) -> str:
    text = _expression(number)
    return f"{text} step" if text == "1" else f"{text} steps"


def _state(formula: Formula) -> str:
    """A condition on states as a clause."""
    match formula:
        case Predicate(predicate):
            return _PREDICATES[predicate]
        case UnaryFormula(UnaryOperator.NOT, Predicate(StatePredicate.DEADLOCK)):
            return "a step is possible"
        case BinaryFormula(operator, left, right) if operator in _WORDS:
            return f"{_state(left)} {_WORDS[operator]} {_state(right)}"
        case _:
            return f"`{_expression(formula)}` holds"


def _always(formula: Formula) -> str:
    if isinstance(formula, Unary) and formula.operator is UnaryOperator.NOT:
        return _never(formula.operand)
    text = _state(formula)
    return f"{text.removesuffix(' holds')} always holds" if text.endswith(" holds") else f"always {text}"


def _never(formula: Formula) -> str:
    text = _state(formula)
    return f"{text.removesuffix(' holds')} never holds" if text.endswith(" holds") else f"never {text}"


def _expression(formula: Formula, *, is_inner: bool = False) -> str:
    """An expression in the notation of JANI, with its operators between the operands."""
    match formula:
        case Name(identifier):
            return identifier
        case Boolean(value):
            return "true" if value else "false"
        case Integer(value):
            return str(value)
        case Real(value):
            return f"{value:g}"
        case Unary(UnaryOperator.NOT, operand):
            return f"¬{_expression(operand, is_inner=True)}"
        case Binary(operator, left, right) if operator.symbol.isalpha():
            return f"{operator.symbol}({_expression(left)}, {_expression(right)})"
        case Binary(operator, left, right):
            text = f"{_operand(left, operator)} {operator.symbol} {_operand(right, operator)}"
            return f"({text})" if is_inner else text
        case _:
            raise _UnsaidError


def _operand(formula: Expression, outer: BinaryOperator) -> str:
    """An operand, in parentheses unless its operator is obviously applied first."""
    if not isinstance(formula, Binary):
        return _expression(formula)
    joins = (BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES)
    is_first = (outer in joins and formula.operator not in joins) or (
        outer is formula.operator and outer in (BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.ADD)
    )
    return _expression(formula, is_inner=not is_first)
