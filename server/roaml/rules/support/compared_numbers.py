# SPDX-License-Identifier: Apache-2.0
"""Comparisons of variables with constants in a condition."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from roaml.expr.infer import constant
from roaml.expr.operators import MIRRORED, OPPOSITE, Operator, OperatorKind
from roaml.expr.tree import Binary, Expr, Name, String, children, walk
from roaml.expr.types import Scalar
from roaml.model.values.analyse import of_type
from roaml.model.values.describe import described
from roaml.model.values.domain import BOTH, FALSE, TRUE, Origin, ValueSet, exactly
from roaml.model.values.evaluate import compared
from roaml.rules.support.alternatives import joined


def comparisons(tree: Expr) -> Iterator[tuple[Binary, str, float]]:
    """The comparisons of a variable with a constant: each with the name of the variable and the constant."""
    for node in walk(tree):
        if isinstance(node, Binary) and node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER):
            for variable, other in ((node.left, node.right), (node.right, node.left)):
                number = constant(other)
                if isinstance(variable, Name) and number is not None:
                    yield node, variable.name, number


def compared_constants(tree: Expr) -> Iterator[tuple[Binary, str, float | str]]:
    """The comparisons of a variable with a number or a text, each with the name of the variable and the constant."""
    yield from comparisons(tree)
    for node in walk(tree):
        if isinstance(node, Binary) and node.operator.kind is OperatorKind.EQUALITY:
            for variable, other in ((node.left, node.right), (node.right, node.left)):
                if isinstance(variable, Name) and isinstance(other, String):
                    yield node, variable.name, other.value


def required(tree: Expr) -> Iterator[Expr]:
    """The parts of a condition without which it cannot hold: itself, and what it joins with `&&`."""
    yield tree
    if isinstance(tree, Binary) and tree.operator is Operator.AND:
        yield from required(tree.left)
        yield from required(tree.right)


def decided_junctions(tree: Expr) -> Iterator[tuple[Expr, str, bool]]:
    """The conjunctions in a condition whose comparisons of a variable with constants exclude each other, and the
    disjunctions one of whose comparisons always holds: each with the name of the variable and its value."""
    parts: Sequence[Expr] = children(tree)
    if isinstance(tree, Binary) and tree.operator in (Operator.AND, Operator.OR):
        parts = joined(tree, tree.operator)
        name = _excluded(parts, negated=tree.operator is Operator.OR)
        if name is not None:
            yield tree, name, tree.operator is Operator.OR
            return
    for part in parts:
        yield from decided_junctions(part)


def _excluded(parts: Iterable[Expr], *, negated: bool) -> str | None:
    """The variable that has no value for which all comparisons among the parts hold, or none holds if `negated`."""
    allowed: dict[str, tuple[float, bool, float, bool]] = {}
    for part in parts:
        for node, name, number in comparisons(part) if isinstance(part, Binary) else ():
            operator = node.operator if isinstance(node.left, Name) else MIRRORED.get(node.operator)
            if node is not part or operator is None:
                continue
            operator = OPPOSITE[operator] if negated else operator
            low, open_low, high, open_high = allowed.get(name, (-math.inf, False, math.inf, False))
            if operator in (Operator.EQUAL, Operator.GREATER, Operator.GREATER_EQUAL):
                low, open_low = max((low, open_low), (number, operator is Operator.GREATER))
            if operator in (Operator.EQUAL, Operator.LESS, Operator.LESS_EQUAL):
                high, not_open = min((high, not open_high), (number, operator is not Operator.LESS))
                open_high = not not_open
            allowed[name] = low, open_low, high, open_high
    for name, (low, open_low, high, open_high) in allowed.items():
        if low > high or (low == high and (open_low or open_high)):
            return name
    return None


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


def result_for(node: Binary, name: str, known: ValueSet, value: float | str) -> ValueSet:
    """The results of a comparison with a constant for all values that are sent, as far as they are known."""
    if node.operator.kind is OperatorKind.EQUALITY:
        if known.only is None or known.includes(value):
            return BOTH
        return FALSE if node.operator is Operator.EQUAL else TRUE
    is_left = isinstance(node.left, Name) and node.left.name == name
    sides = (reached(known), exactly(value)) if is_left else (exactly(value), reached(known))
    return compared(node.operator, *sides) if node.operator.kind is OperatorKind.ORDER else BOTH


def only_ways(tree: Expr) -> Iterator[Expr]:
    """The equalities in what must always hold that are the only one about their variable: `!done || code == 4` requires
    that the code becomes 4. Several, as in `mode == 1 || mode == 2`, state which values are allowed."""
    if not isinstance(tree, Binary) or tree.operator is not Operator.OR:
        return
    equalities: dict[str, list[Expr]] = {}
    stack: list[Expr] = [tree]
    while stack:
        node = stack.pop()
        if isinstance(node, Binary) and node.operator in (Operator.OR, Operator.AND):
            stack += (node.left, node.right)
        elif isinstance(node, Binary):
            for side in (node.left, node.right):
                if isinstance(side, Name):
                    equalities.setdefault(side.name, []).append(node)
    for alike in equalities.values():
        if len(alike) == 1 and isinstance(alike[0], Binary) and alike[0].operator is Operator.EQUAL:
            yield alike[0]


def reached(values: ValueSet) -> ValueSet:
    """The values without the bounds that only widening or a type gives."""
    if values.only is not None:
        return values
    low = values.low if values.low_from is Origin.REACHED else -math.inf
    high = values.high if values.high_from is Origin.REACHED else math.inf
    return ValueSet(None, low, high, values.low_from, values.high_from)
