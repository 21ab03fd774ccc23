# SPDX-License-Identifier: Apache-2.0
"""Which variables the expressions and assignments of a model read and write, and which operations can be undefined.

A set of variables is an integer; its bits are the variables in the order of their registers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.jani.expressions import (
    ArrayAccess,
    ArrayValue,
    Binary,
    Boolean,
    Conditional,
    Expression,
    Integer,
    Name,
    NamedNumber,
    Real,
    Unary,
    children,
)
from roaml.jani.model import Assignment
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.smc.compile import Legend
from roaml.smc.names import Storage

_TOTAL = frozenset(
    (
        UnaryOperator.NOT,
        BinaryOperator.OR,
        BinaryOperator.AND,
        BinaryOperator.IMPLIES,
        BinaryOperator.EQUAL,
        BinaryOperator.NOT_EQUAL,
        BinaryOperator.LESS,
        BinaryOperator.LESS_EQUAL,
        BinaryOperator.GREATER,
        BinaryOperator.GREATER_EQUAL,
        BinaryOperator.MINIMUM,
        BinaryOperator.MAXIMUM,
    )
)
"""The operators that have a value for all operands. Integers are limited to 64 bits, so sums are not among them."""
_DEFINED_ATOMS = frozenset((Integer, Boolean, Real, NamedNumber, Name))
_DEFINED = frozenset((Conditional, ArrayValue))
"""The classes of expressions that have a value if their subexpressions have one."""


def bits(mask: int) -> Iterator[int]:
    """The numbers of the elements of a set, in ascending order."""
    while mask:
        bit = mask & -mask
        yield bit.bit_length() - 1
        mask ^= bit


class VariableUses:
    """The variables of a model that its parts use. A part belongs to an instance, which is given by its number."""

    def __init__(self, legend: Legend) -> None:
        layout = legend.layout
        self._failing: dict[tuple[int, int], bool] = {}
        self._names = legend.reads
        self._instances = layout.instances
        self._bits = {id(storage): 1 << number for number, storage in enumerate(layout.storages)}
        shared = {storage.name: self._bits[id(storage)] for storage in layout.shared}
        self._scopes = [
            {**shared, **{storage.name: self._bits[id(storage)] for storage in instance.own}}
            for instance in layout.instances
        ]

    def of(self, storages: Iterable[Storage]) -> int:
        """The set of these variables."""
        return sum(self._bits[id(storage)] for storage in storages)

    def read_in(self, expression: Expression, instance: int) -> int:
        """The variables that an expression reads."""
        return self._of_names(self._names.names_in(expression, self._instances[instance].names), instance)

    def read_by(self, assignment: Assignment, instance: int) -> int:
        """The variables that an assignment reads, including those in the indices of its target."""
        return self._of_names(self._names.by(assignment, self._instances[instance].names), instance)

    def written_by(self, assignment: Assignment, instance: int) -> int:
        """The variable that an assignment writes."""
        return self._scopes[instance][assignment.variable]

    def can_fail(self, expression: Expression, instance: int) -> bool:
        """Whether an expression of the model has no value in some states. In doubt, it can fail."""
        key = id(expression), instance  # The model keeps the expression alive.
        known = self._failing.get(key)
        if known is None:
            known = self._failing[key] = self._can_fail(expression, instance)
        return known

    def _can_fail(self, expression: Expression, instance: int) -> bool:
        nodes = [expression]
        for node in nodes:  # which grows
            kind = type(node)
            if kind in _DEFINED_ATOMS:
                continue
            if isinstance(node, (Unary, Binary)):
                if node.operator not in _TOTAL:
                    return True
            elif kind not in _DEFINED and not (isinstance(node, ArrayAccess) and self._is_element(node, instance)):
                return True
            nodes += children(node)
        return False

    def can_assignment_fail(self, assignment: Assignment, instance: int) -> bool:
        """Whether an assignment is an undefined operation in some states."""
        meaning = self._instances[instance].names.values[assignment.variable]
        assert isinstance(meaning, Storage)
        return (
            meaning.bounds != (None, None)
            or self.can_fail(assignment.value, instance)
            or (isinstance(assignment.target, ArrayAccess) and self.can_fail(assignment.target, instance))
        )

    def _is_element(self, access: ArrayAccess, instance: int) -> bool:
        """Whether an index is a number for which the array has an element."""
        if not isinstance(access.array, Name) or not isinstance(access.index, Integer):
            return False
        meaning = self._instances[instance].names.values.get(access.array.identifier)
        return isinstance(meaning, Storage) and meaning.shape != () and 0 <= access.index.value < meaning.shape[0]

    def _of_names(self, names: Iterable[str], instance: int) -> int:
        scope, mask = self._scopes[instance], 0
        for name in names:
            mask |= scope.get(name, 0)
        return mask
