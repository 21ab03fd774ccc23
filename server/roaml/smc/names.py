# SPDX-License-Identifier: Apache-2.0
"""What names stand for while a model is compiled, and what kinds and shapes values have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from roaml.jani.expressions import Call, Expression, Name, walk
from roaml.jani.model import Function
from roaml.jani.node import Node
from roaml.jani.semantics import Value
from roaml.jani.types import ArrayType, BasicType, BoundedType, Type
from roaml.smc.fault import FaultError
from roaml.smc.registers import BOOL, INT, REAL, Number, Operand, Region


@dataclass(slots=True)
class Storage:
    """Where a variable or constant lives. `watch` is its number if something must be told of changes, else -1."""

    name: str
    type: Type
    kind: str
    shape: tuple[int, ...]
    base: int = -1
    watch: int = -1
    is_constant: bool = False
    bounds: tuple[Number | None, Number | None] = (None, None)


Meaning: TypeAlias = Storage | Operand | Region
"""What a name stands for: a variable, a bound scalar, a bound array."""


@dataclass(frozen=True)
class Names:
    """What names mean somewhere."""

    values: Mapping[str, Meaning]
    functions: Mapping[str, Function]

    def bound(self, more: Mapping[str, Meaning]) -> Names:
        return Names({**self.values, **more}, self.functions)


def kind_of(type_: Type) -> str:
    """The kind of values of a type, of the elements of an array type.

    Raises:
        FaultError: values of this type are not supported.
    """
    while isinstance(type_, ArrayType):
        type_ = type_.element
    if isinstance(type_, BoundedType):
        type_ = type_.base
    kinds = {BasicType.BOOL: BOOL, BasicType.INT: INT, BasicType.REAL: REAL}
    if isinstance(type_, BasicType) and type_ in kinds:
        return kinds[type_]
    raise FaultError("only variables of type bool, int, real and arrays of these are supported")


def larger(first: tuple[int, ...], second: tuple[int, ...]) -> tuple[int, ...]:
    """The least shape that holds both."""
    if len(first) != len(second):
        return first if len(first) > len(second) else second
    return tuple(map(max, first, second))


def shape_of(value: Value) -> tuple[int, ...]:
    """The shape of a value."""
    if not isinstance(value, tuple):
        return ()
    inner: tuple[int, ...] = ()
    for each in value:
        inner = larger(inner, shape_of(each))
    return (len(value), *inner)


def variables_in(expression: Expression, functions: Mapping[str, Function]) -> set[str]:
    """The names that the value of an expression depends on."""
    found: set[str] = set()
    called: set[str] = set()
    stack = [expression]
    while stack:
        for node in walk(stack.pop()):
            if isinstance(node, Name):
                found.add(node.identifier)
            elif isinstance(node, Call) and node.function not in called:
                called.add(node.function)
                if node.function in functions:
                    stack.append(functions[node.function].body)
    return found


def unsupported(node: Node) -> str:
    """The message for a kind of expression that the engine does not know."""
    return f"the model checker does not support this kind of expression ({type(node).__name__})"
