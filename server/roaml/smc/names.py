# SPDX-License-Identifier: Apache-2.0
"""The registers and values to which the names in a model refer while it is compiled."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from roaml.jani.expressions import ArrayAccess, Call, Expression, Name, walk
from roaml.jani.model import Assignment, Function
from roaml.jani.node import Node
from roaml.jani.types import Type
from roaml.record import Record, replace
from roaml.smc.fault import FaultError
from roaml.smc.registers import Number, Operand, Region


class Storage(Record):
    """The registers of a variable or a constant array.

    Attributes:
        kind: the kind of the value or, for an array, of its elements; see `roaml.smc.shapes`.
        shape: the lengths of an array in all dimensions; () for a scalar.
        base: the number of the first register.
        watch: the number of the variable if its changes must be tracked, otherwise -1.
        bounds: the lower and the upper bound of the type; `None` for a bound that does not exist.
    """

    name: str
    type: Type
    kind: str
    shape: tuple[int, ...]
    base: int = -1
    watch: int = -1
    is_constant: bool = False
    bounds: tuple[Number | None, Number | None] = (None, None)


Meaning: TypeAlias = Storage | Operand | Region
"""The meaning of a name: a variable or a constant array (`Storage`); a scalar constant, a scalar parameter or the
variable of an array constructor (`Operand`); or an array parameter (`Region`)."""


class StorageNames(Record, frozen=True):
    """The meanings of names at a place. `calls` are the functions whose calls are being compiled at the place, the
    outermost first."""

    values: Mapping[str, Meaning]
    functions: Mapping[str, Function]
    calls: tuple[str, ...] = ()

    def bound(self, more: Mapping[str, Meaning]) -> StorageNames:
        return replace(self, values={**self.values, **more})

    def inside(self, function: Function, parameters: Mapping[str, Meaning]) -> StorageNames:
        """The meanings of names in the body of a function."""
        return StorageNames({**self.values, **parameters}, self.functions, (*self.calls, function.name))

    def constants(self) -> dict[str, Number]:
        """The names whose values do not depend on the state, with their values."""
        return {name: m.value for name, m in self.values.items() if isinstance(m, Operand) and m.value is not None}

    def meaning(self, node: Name) -> Meaning:
        meaning = self.values.get(node.identifier)
        if meaning is None:
            raise FaultError(f"there is no variable `{node.identifier}`", node.origin)
        return meaning

    def called(self, node: Call) -> Function:
        function = self.functions.get(node.function)
        if function is None:
            raise FaultError(f"there is no function `{node.function}`", node.origin)
        if node.function in self.calls:
            raise FaultError(f"`{node.function}` calls itself, which is not supported", node.origin)
        if len(node.arguments) != len(function.parameters):
            needed, given = len(function.parameters), len(node.arguments)
            raise FaultError(
                f"wrong number of arguments of `{node.function}`: {given} instead of {needed}", node.origin
            )
        return function


def variables_in(expression: Expression, functions: Mapping[str, Function]) -> set[str]:
    """The names in an expression, and in the functions that it calls."""
    identifiers: set[str] = set()
    called: set[str] = set()
    stack = [expression]
    while stack:
        for node in walk(stack.pop()):
            if isinstance(node, Name):
                identifiers.add(node.identifier)
            elif isinstance(node, Call) and node.function not in called:
                called.add(node.function)
                if node.function in functions:
                    stack.append(functions[node.function].body)
    return identifiers


def read_by(assignment: Assignment, functions: Mapping[str, Function]) -> set[str]:
    """The names on which an assignment depends: those in its value, and those in the indices of its target."""
    read_names = variables_in(assignment.value, functions)
    target: Expression = assignment.target
    while isinstance(target, ArrayAccess):
        read_names |= variables_in(target.index, functions)
        target = target.array
    return read_names


def unsupported(node: Node) -> str:
    """The message for an unsupported kind of expression."""
    return f"the model checker does not support this kind of expression ({type(node).__name__})"
