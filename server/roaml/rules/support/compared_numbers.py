# SPDX-License-Identifier: Apache-2.0
"""Comparisons of variables with numbers in a condition."""

from __future__ import annotations

import math
from collections.abc import Iterator

from roaml.expr.infer import constant
from roaml.expr.operators import MIRRORED, Operator, OperatorKind
from roaml.expr.tree import Binary, Expr, Name, walk
from roaml.expr.types import Scalar
from roaml.model.values.analyse import of_type
from roaml.model.values.describe import described
from roaml.model.values.domain import FALSE, TRUE, Origin, ValueSet, exactly
from roaml.model.values.evaluate import compared


def comparisons(tree: Expr) -> Iterator[tuple[Binary, str, float]]:
    """The comparisons of a variable with a constant: each with the name of the variable and the constant."""
    for node in walk(tree):
        if isinstance(node, Binary) and node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER):
            for variable, other in ((node.left, node.right), (node.right, node.left)):
                number = constant(other)
                if isinstance(variable, Name) and number is not None:
                    yield node, variable.name, number


def required(tree: Expr) -> Iterator[Expr]:
    """The parts of a condition without which it cannot hold: itself, and what it joins with `&&`."""
    yield tree
    if isinstance(tree, Binary) and tree.operator is Operator.AND:
        yield from required(tree.left)
        yield from required(tree.right)


def contradictions(tree: Expr) -> Iterator[tuple[Expr, str]]:
    """The conjunctions in a condition whose comparisons of a variable with constants exclude each other, each with the
    name of the variable."""
    if not isinstance(tree, Binary) or tree.operator is not Operator.AND:
        for side in (tree.left, tree.right) if isinstance(tree, Binary) else ():
            yield from contradictions(side)
        return
    allowed: dict[str, tuple[float, bool, float, bool]] = {}
    for part in required(tree):
        for node, name, number in comparisons(part) if isinstance(part, Binary) else ():
            operator = node.operator if isinstance(node.left, Name) else MIRRORED.get(node.operator)
            if node is not part or operator is None:
                continue
            low, open_low, high, open_high = allowed.get(name, (-math.inf, False, math.inf, False))
            if operator in (Operator.EQUAL, Operator.GREATER, Operator.GREATER_EQUAL):
                low, open_low = max((low, open_low), (number, operator is Operator.GREATER))
            if operator in (Operator.EQUAL, Operator.LESS, Operator.LESS_EQUAL):
                high, not_open = min((high, not open_high), (number, operator is not Operator.LESS))
                open_high = not not_open
            allowed[name] = low, open_low, high, open_high
    for name, (low, open_low, high, open_high) in allowed.items():
        if low > high or (low == high and (open_low or open_high)):
            yield tree, name
            return


def by_type(node: Binary, name: str, type_: Scalar, number: float) -> tuple[bool, str] | None:
    """The result of a comparison that is the same for all values of an integer type, and a message about it."""
    is_left = isinstance(node.left, Name) and node.left.name == name
    sides = (of_type(type_), exactly(number)) if is_left else (exactly(number), of_type(type_))
    result = compared(node.operator, *sides)
    if result.value is None:
        return None
    how = "always" if result == TRUE else "never"
    message = f"this comparison is {how} true: the values of `{type_}` are {described(of_type(type_))}"
    return result == TRUE, message


def never_holds(node: Binary, name: str, known: ValueSet, number: float) -> bool:
    """Whether a comparison with a number is false for all values that are sent."""
    if node.operator is Operator.EQUAL:
        return known.only is not None and not known.includes(number)
    is_left = isinstance(node.left, Name) and node.left.name == name
    sides = (reached(known), exactly(number)) if is_left else (exactly(number), reached(known))
    return node.operator.kind is OperatorKind.ORDER and compared(node.operator, *sides) == FALSE


def reached(values: ValueSet) -> ValueSet:
    """The values without the bounds that only widening or a type gives."""
    if values.only is not None:
        return values
    low = values.low if values.low_from is Origin.REACHED else -math.inf
    high = values.high if values.high_from is Origin.REACHED else math.inf
    return ValueSet(None, low, high, values.low_from, values.high_from)
