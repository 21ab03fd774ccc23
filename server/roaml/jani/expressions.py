# SPDX-License-Identifier: Apache-2.0
"""Expressions, which have a value in each state of a model.

- Expressions are immutable. Two expressions are equal if their content is equal; their origins are ignored.
- Expressions may be nested as deeply as memory allows. Visit them with `walk` or `roaml.jani.deep`, never by plain
  recursion.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.jani.node import CommentedNode, Node
from roaml.jani.operators import BinaryOperator, Distribution, NumberConstant, UnaryOperator


class Boolean(Node, frozen=True):
    value: bool


class Integer(Node, frozen=True):
    value: int


class Real(Node, frozen=True):
    """A number written with a point or an exponent; `value` is finite."""

    value: float


class NamedNumber(CommentedNode, frozen=True):
    """A named real number: `{"constant": "e"}` or `{"constant": "π"}`."""

    constant: NumberConstant


class Name(Node, frozen=True):
    """A reference to a variable, constant or parameter."""

    identifier: str


class Unary(CommentedNode, frozen=True):
    operator: UnaryOperator
    operand: Expression


class Binary(CommentedNode, frozen=True):
    operator: BinaryOperator
    left: Expression
    right: Expression


class Conditional(CommentedNode, frozen=True):
    """`ite`: the value of `then` if `test` holds; otherwise the value of `otherwise`."""

    test: Expression
    then: Expression
    otherwise: Expression


class ArrayAccess(CommentedNode, frozen=True):
    """`aa`: the element of `array` at `index`, from 0."""

    array: Expression
    index: Expression


class ArrayValue(CommentedNode, frozen=True):
    """`av`: an array with these elements."""

    elements: tuple[Expression, ...]


class ArrayConstructor(CommentedNode, frozen=True):
    """`ac`: an array of `length` elements, the values of `body` for `variable` = 0, ..., `length` - 1."""

    variable: str
    length: Expression
    body: Expression


class DatatypeAccess(CommentedNode, frozen=True):
    """`da`: a member of a value of a datatype."""

    record: Expression
    member: str


class DatatypeValue(CommentedNode, frozen=True):
    """`dv`: a value of a datatype, given by its members."""

    datatype: str
    members: tuple[tuple[str, Expression], ...]


class OptionAccess(CommentedNode, frozen=True):
    """`oa`: the content of an option that is not empty."""

    option: Expression


class OptionValue(CommentedNode, frozen=True):
    """`ov`: an option with a value."""

    content: Expression


class EmptyOption(CommentedNode, frozen=True):
    """`empty`: an option without a value."""


class Call(CommentedNode, frozen=True):
    function: str
    arguments: tuple[Expression, ...]


class Selection(CommentedNode, frozen=True):
    """`nondet`: any value of `variable` for which `condition` holds."""

    variable: str
    condition: Expression


class Sample(CommentedNode, frozen=True):
    """A random value of a distribution."""

    distribution: Distribution
    arguments: tuple[Expression, ...]


class Derivative(CommentedNode, frozen=True):
    """`der`: the derivative of a continuous variable with respect to time."""

    variable: str


class Missing(Node, frozen=True):
    """A part that cannot be read. A finding of the reader states the reason. A model with a missing part cannot be
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

_ATOMS = frozenset((Boolean, Integer, Real, NamedNumber, Name, EmptyOption, Derivative, Missing))
"""The classes of expressions without subexpressions."""

LValue: TypeAlias = Name | ArrayAccess | DatatypeAccess | OptionAccess | Missing
"""The targets of assignments: a variable or a part of one."""


def children(expression: Expression) -> tuple[Expression, ...]:
    """The direct subexpressions, in the order of the JANI file."""
    if type(expression) in _ATOMS:  # Half of all expressions; each class that does not match takes 0.3 µs below.
        return ()
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
