# SPDX-License-Identifier: Apache-2.0
"""Observers as data: registers, and assignments that are executed in order at every letter.

- All values are booleans or integers from 0 to the `limit` of their register.
- Registers that only pass a value from one assignment to a later one are reset at the end of each letter, so that
  states of an observer differ only if its future behaviour differs.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from typing import TypeAlias

from roaml.record import Record


class Literal(Record, frozen=True):
    value: bool | int


class Input(Record, frozen=True):
    """Whether a condition of the property is true at this letter."""

    name: str


class Tick(Record, frozen=True):
    """Whether this letter is a step of the clock."""


class Register(Record, frozen=True):
    """A variable of an observer.

    Attributes:
        limit: the maximum value of an integer; `None` for a boolean.
    """

    name: str
    initial: bool | int
    limit: int | None = None


class Negation(Record, frozen=True):
    operand: Expression


class BinaryOperator(enum.Enum):
    AND = "and"
    OR = "or"
    EQUAL = "="
    LESS_EQUAL = "<="
    ADD = "+"
    SUBTRACT = "-"


class Binary(Record, frozen=True):
    operator: BinaryOperator
    left: Expression
    right: Expression


class Choice(Record, frozen=True):
    """`then` if `test` is true, else `otherwise`."""

    test: Expression
    then: Expression
    otherwise: Expression


Expression: TypeAlias = Literal | Input | Tick | Register | Negation | Binary | Choice

TRUE = Literal(True)
FALSE = Literal(False)


class Assign(Record, frozen=True):
    register: Register
    value: Expression


class Outputs(Record, frozen=True):
    """Registers and conditions that contain the verdict on a trace. A register that is true stays true.

    Attributes:
        violated: whether the property does not hold, however the trace continues.
        satisfied: whether the property holds, however the trace continues; `None` if this is never known.
        pending: whether an obligation is open that is violated if the trace ends here.
        due: whether an obligation is open that is violated if the clock ends here: it has no deadline, or its deadline
            is now.
        exercised: whether the property was triggered, by a request or an opened scope; `None` if it always applies.
        opened: whether a stretch of the scope was judged, for a pattern with two conditions in a scope that has no
            judged stretch in some traces; otherwise `None`.
    """

    violated: Register
    satisfied: Register | None = None
    pending: Expression = FALSE
    due: Expression = FALSE
    exercised: Register | None = None
    opened: Register | None = None


class Observer(Record, frozen=True):
    """An observer; `inputs` are the conditions whose values it reads at each letter."""

    inputs: tuple[str, ...]
    registers: tuple[Register, ...]
    assignments: tuple[Assign, ...]
    outputs: Outputs

    def initial(self) -> State:
        return {register.name: register.initial for register in self.registers}


State: TypeAlias = Mapping[str, bool | int]
"""The value of each register."""


def step(observer: Observer, state: State, inputs: Mapping[str, bool], tick: bool) -> State:
    """The state of an observer after one more letter.

    Args:
        inputs: the values of the conditions at the letter, by name.
        tick: whether the letter is a clock step.
    """
    values = dict(state)
    for assignment in observer.assignments:
        values[assignment.register.name] = evaluate(assignment.value, values, inputs, tick)
    return values


def evaluate(expression: Expression, state: State, inputs: Mapping[str, bool], tick: bool) -> bool | int:
    match expression:
        case Literal():
            return expression.value
        case Input():
            return inputs[expression.name]
        case Tick():
            return tick
        case Register():
            return state[expression.name]
        case Negation():
            return not evaluate(expression.operand, state, inputs, tick)
        case Choice():
            test = evaluate(expression.test, state, inputs, tick)
            return evaluate(expression.then if test else expression.otherwise, state, inputs, tick)
        case Binary():
            left = evaluate(expression.left, state, inputs, tick)
            match expression.operator:
                case BinaryOperator.AND:
                    return left and evaluate(expression.right, state, inputs, tick)
                case BinaryOperator.OR:
                    return left or evaluate(expression.right, state, inputs, tick)
            right = evaluate(expression.right, state, inputs, tick)
            match expression.operator:
                case BinaryOperator.EQUAL:
                    return left == right
                case BinaryOperator.LESS_EQUAL:
                    return left <= right
                case BinaryOperator.ADD:
                    return left + right
                case BinaryOperator.SUBTRACT:
                    return left - right


def simplified(expression: Expression, known: Mapping[Expression, Expression]) -> Expression:
    """A simplified copy of `expression`, in which its parts in `known` are replaced by their values."""
    if expression in known:
        return known[expression]
    match expression:
        case Negation():
            return negation(simplified(expression.operand, known))
        case Choice():
            test = simplified(expression.test, known)
            then, otherwise = simplified(expression.then, known), simplified(expression.otherwise, known)
            return choice(test, then, otherwise)
        case Binary():
            left, right = simplified(expression.left, known), simplified(expression.right, known)
            match expression.operator:
                case BinaryOperator.AND:
                    return conjunction(left, right)
                case BinaryOperator.OR:
                    return disjunction(left, right)
            return Binary(expression.operator, left, right)
        case _:
            return expression


# ------------------------------------------------------- making expressions


def negation(operand: Expression) -> Expression:
    match operand:
        case Literal():
            return Literal(not operand.value)
        case Negation():
            return operand.operand
    return Negation(operand)


def conjunction(*terms: Expression) -> Expression:
    result: Expression = TRUE
    for term in terms:
        if FALSE in (result, term):
            return FALSE
        result = term if result == TRUE else result if term == TRUE else Binary(BinaryOperator.AND, result, term)
    return result


def disjunction(*terms: Expression) -> Expression:
    result: Expression = FALSE
    for term in terms:
        if TRUE in (result, term):
            return TRUE
        result = term if result == FALSE else result if term == FALSE else Binary(BinaryOperator.OR, result, term)
    return result


def choice(test: Expression, then: Expression, otherwise: Expression) -> Expression:
    if test == TRUE or then == otherwise:
        return then
    return otherwise if test == FALSE else Choice(test, then, otherwise)


def equal(left: Expression, value: int) -> Expression:
    return Binary(BinaryOperator.EQUAL, left, Literal(value))


def at_most(left: Expression, value: int) -> Expression:
    return Binary(BinaryOperator.LESS_EQUAL, left, Literal(value))


def at_least(left: Expression, value: int) -> Expression:
    return Binary(BinaryOperator.LESS_EQUAL, Literal(value), left)


def plus(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.ADD, left, right)


def minus(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.SUBTRACT, left, right)
