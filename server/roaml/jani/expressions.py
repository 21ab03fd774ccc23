# SPDX-License-Identifier: Apache-2.0
"""Expressions, which have a value in each state of a model.

- Expressions are immutable. Two expressions are equal if their content is equal; their origins are ignored.
- Expressions may be nested as deeply as memory allows. Visit them with `walk` or `roaml.jani.deep`, never by plain
  recursion.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.jani.node import CommentedNode, Node
from roaml.jani.operators import BinaryOperator, Distribution, NumberConstant, UnaryOperator


@dataclass(frozen=True, slots=True)
class Boolean(Node):
    value: bool


@dataclass(frozen=True, slots=True)
class Integer(Node):
    value: int


@dataclass(frozen=True, slots=True)
class Real(Node):
    """A number written with a point or an exponent; `value` is finite."""

    value: float


@dataclass(frozen=True, slots=True)
class NamedNumber(CommentedNode):
    """A named real number: `{"constant": "e"}` or `{"constant": "π"}`."""

    constant: NumberConstant


@dataclass(frozen=True, slots=True)
class Name(Node):
    """A reference to a variable, constant or parameter."""

    identifier: str


@dataclass(frozen=True, slots=True)
class Unary(CommentedNode):
    operator: UnaryOperator
    operand: Expression


@dataclass(frozen=True, slots=True)
class Binary(CommentedNode):
    operator: BinaryOperator
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class Conditional(CommentedNode):
    """`ite`: the value of `then` if `test` holds; otherwise the value of `otherwise`."""

    test: Expression
    then: Expression
    otherwise: Expression


@dataclass(frozen=True, slots=True)
class ArrayAccess(CommentedNode):
    """`aa`: the element of `array` at `index`, from 0."""

    array: Expression
    index: Expression


@dataclass(frozen=True, slots=True)
class ArrayValue(CommentedNode):
    """`av`: an array with these elements."""

    elements: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class ArrayConstructor(CommentedNode):
    """`ac`: an array of `length` elements, the values of `body` for `variable` = 0, ..., `length` - 1."""

    variable: str
    length: Expression
    body: Expression


@dataclass(frozen=True, slots=True)
class DatatypeAccess(CommentedNode):
    """`da`: a member of a value of a datatype."""

    record: Expression
    member: str


@dataclass(frozen=True, slots=True)
class DatatypeValue(CommentedNode):
    """`dv`: a value of a datatype, given by its members."""

    datatype: str
    members: tuple[tuple[str, Expression], ...]


@dataclass(frozen=True, slots=True)
class OptionAccess(CommentedNode):
    """`oa`: the content of an option that is not empty."""

    option: Expression


@dataclass(frozen=True, slots=True)
class OptionValue(CommentedNode):
    """`ov`: an option with a value."""

    content: Expression


@dataclass(frozen=True, slots=True)
class EmptyOption(CommentedNode):
    """`empty`: an option without a value."""


@dataclass(frozen=True, slots=True)
class Call(CommentedNode):
    function: str
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Selection(CommentedNode):
    """`nondet`: any value of `variable` for which `condition` holds."""

    variable: str
    condition: Expression


@dataclass(frozen=True, slots=True)
class Sample(CommentedNode):
    """A random value of a distribution."""

    distribution: Distribution
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class Derivative(CommentedNode):
    """`der`: the derivative of a continuous variable with respect to time."""

    variable: str


@dataclass(frozen=True, slots=True)
class Missing(Node):
    """A part that cannot be read. A finding of the reader states the reason. A model with such a part is not
    written."""


Expression: TypeAlias = (
    Boolean
    | Integer
    | Real
    | NamedNumber
    | Name
    | Unary
    | Binary
    | Conditional
    | ArrayAccess
    | ArrayValue
    | ArrayConstructor
    | DatatypeAccess
    | DatatypeValue
    | OptionAccess
    | OptionValue
    | EmptyOption
    | Call
    | Selection
    | Sample
    | Derivative
    | Missing
)

LValue: TypeAlias = Name | ArrayAccess | DatatypeAccess | OptionAccess | Missing
"""The targets of assignments: a variable or a part of one."""


def children(expression: Expression) -> tuple[Expression, ...]:
    """The direct subexpressions, in the order of the JANI file."""
    match expression:
        case Binary():
            return (expression.left, expression.right)
        case Unary():
            return (expression.operand,)
        case Conditional():
            return (expression.test, expression.then, expression.otherwise)
        case ArrayAccess():
            return (expression.array, expression.index)
        case ArrayValue():
            return expression.elements
        case ArrayConstructor():
            return (expression.length, expression.body)
        case DatatypeAccess():
            return (expression.record,)
        case DatatypeValue():
            return tuple(value for _, value in expression.members)
        case OptionAccess():
            return (expression.option,)
        case OptionValue():
            return (expression.content,)
        case Call() | Sample():
            return expression.arguments
        case Selection():
            return (expression.condition,)
        case Boolean() | Integer() | Real() | NamedNumber() | Name() | EmptyOption() | Derivative() | Missing():
            return ()
        case _:
            return assert_never(expression)


def walk(expression: Expression) -> Iterator[Expression]:
    """`expression` and all its subexpressions, outer before inner, left before right."""
    stack = [expression]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(reversed(children(node)))
