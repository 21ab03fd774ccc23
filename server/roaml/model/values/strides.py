# SPDX-License-Identifier: Apache-2.0
"""Variables that change by multiples of a number: `percent`, which begins at 0 and changes by 5, is never 4.

See P. Granger, "Static analysis of arithmetical congruences", International Journal of Computer Mathematics 30, 1989.
Here, a variable has one congruence in all states of its machine.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple, TypeGuard

from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Call, Expr, Member, Name
from roaml.model.machine import Assign, Chart
from roaml.model.syntax import Expression
from roaml.model.values.domain import ValueSet, between


class Stride(NamedTuple):
    """The values that leave the rest `rest` when they are divided by `modulus`."""

    modulus: int
    rest: int


def strides(chart: Chart, whole: Collection[str]) -> Mapping[str, Stride]:
    """The strides greater than 1 of variables of a chart.

    Args:
        whole: the variables whose values are integers.
    """
    differences: dict[str, int] = {}
    first: dict[str, int] = {}
    for data in chart.data:
        begin = constant(data.value.tree) if _is_read(data.value) else None
        if data.id is not None and data.id.value in whole and isinstance(begin, int):
            first[data.id.value], differences[data.id.value] = begin, 0
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            place, value = statement.location.tree, statement.value
            name = place.name if isinstance(place, Name) else ""
            known = list(_differences(value.tree, name, first[name])) if _is_read(value) and name in first else [None]
            for difference in known:
                if difference is None:
                    first.pop(name, None)
                else:
                    differences[name] = math.gcd(differences[name], difference)
    return {name: Stride(m, first[name] % m) for name, m in differences.items() if name in first and m > 1}


def aligned(values: ValueSet, stride: Stride) -> ValueSet:
    """The values with a stride; the bounds of an interval are values of it."""
    modulus, rest = stride
    if values.only is not None:
        return ValueSet(frozenset(v for v in values.only if isinstance(v, str) or v % modulus == rest))
    low, high = values.low, values.high
    low = low + (rest - low) % modulus if math.isfinite(low) else low
    high = high - (high - rest) % modulus if math.isfinite(high) else high
    return ValueSet(frozenset()) if low > high else between(low, high, values.low_from, values.high_from)


def _is_read(value: object) -> TypeGuard[Expression]:
    return isinstance(value, Expression) and not value.broken


def _differences(tree: Expr, name: str, first: int) -> Iterator[int | None]:
    """By how much the values that an assignment gives to a variable differ from its initial or its last value; `None`
    if this is not known."""
    number = constant(tree)
    match tree:
        case _ if number is not None:
            yield number - first if isinstance(number, int) else None
        case Name():
            yield 0 if tree.name == name else None
        case Binary(operator=Operator.ADD | Operator.SUBTRACT, left=Name() as left) if left.name == name:
            step = constant(tree.right)
            yield step if isinstance(step, int) else None
        case Call(function=Member(name="min" | "max")):
            for argument in tree.arguments:
                yield from _differences(argument, name, first)
        case _:
            yield None
