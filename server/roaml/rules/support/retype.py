# SPDX-License-Identifier: Apache-2.0
"""Fixes that change the type of a variable if a value does not fit its current type."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Fix
from roaml.expr.tree import Name
from roaml.expr.types import INTEGER_RANGES
from roaml.model.machine import Data
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue, ValueUse
from roaml.rules.rule import MachineContext
from roaml.text import TextEdit


def declared_for(context: MachineContext, value: TypedValue) -> Data | None:
    """The declaration of the variable that receives a value; `None` if no variable, or only a part of one, receives
    it."""
    data = value.place.chart.data
    if value.use is ValueUse.INITIAL:
        return next((declaration for declaration in data if declaration.element is value.element), None)
    if value.use is not ValueUse.ASSIGNED:
        return None
    for other in context.typed.values:
        if other.use is ValueUse.LOCATION and other.element is value.element and isinstance(other.value, Expression):
            tree = other.value.tree
            name = tree.name if isinstance(tree, Name) else ""
            return next((declaration for declaration in data if declaration.id and declaration.id.value == name), None)
    return None


def as_type(context: MachineContext, value: TypedValue, type_: str) -> Iterator[Fix]:
    """A fix that declares the variable that receives a value with the base type `type_`. No fix is offered if the
    bounds of the variable are numbers of another kind."""
    data = declared_for(context, value)
    if data is None or data.id is None or data.type is None or data.type.name is None:
        return
    base = data.type.name.base
    if (data.lower or data.upper) and (base in INTEGER_RANGES) != (type_ in INTEGER_RANGES):
        return
    new = data.type.text.replace(base, type_, 1)
    yield Fix(f"Declare `{data.id.value}` as {new}", (TextEdit(data.type.span, new),), preferred=False)


def wide_enough(number: int, type_: str) -> str | None:
    """The smallest integer type that holds `number` and all values of `type_` or, if there is none, the smallest one
    that holds `number`. `None` if no integer type holds the number."""
    low, high = INTEGER_RANGES[type_]
    like = sorted(INTEGER_RANGES, key=lambda name: name.startswith("int") is not type_.startswith("int"))
    for least, most in ((min(low, number), max(high, number)), (number, number)):
        for name in like:
            if INTEGER_RANGES[name][0] <= least and most <= INTEGER_RANGES[name][1]:
                return str(name)
    return None
