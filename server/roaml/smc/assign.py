# SPDX-License-Identifier: Apache-2.0
"""Assignments -> bytecode. The code of an assignment is written in one piece, or in two: one that computes the value,
and a later one that stores it.

A value that is stored in an array of a larger shape is padded with zeros.
"""

from __future__ import annotations

from collections.abc import Sequence

from roaml.jani.expressions import ArrayAccess, ArrayConstructor, ArrayValue, Conditional, Expression, Name
from roaml.jani.node import Origin
from roaml.record import Record
from roaml.smc import opcodes
from roaml.smc.assemble import ExpressionAssembler
from roaml.smc.fault import FaultError
from roaml.smc.names import Storage, StorageNames, unsupported
from roaml.smc.operations import MAX_INT64
from roaml.smc.registers import INT, REAL, Number, Operand, Region, product


class Later(Record, frozen=True):
    """An assignment whose value is computed and not stored yet: its target, the first register of the value, and the
    number of the variable that changes (-1 if its changes are not tracked)."""

    place: Region
    register: int
    watch: int


class AssignmentAssembler:
    """Writes the code of assignments."""

    def __init__(self, expressions: ExpressionAssembler) -> None:
        self.tape = expressions.tape
        self.cells = expressions.cells
        self.expressions = expressions

    def assign(self, target: Expression, value: Expression, names: StorageNames, origin: Origin | None = None) -> None:
        """Write the code of `target := value`."""
        self.tape.place(target.origin or origin)
        storage, accesses = self.assigned(target, names)
        place = self.expressions.indexed(Region(storage.kind, storage.shape, storage.base), accesses, names)
        self.tape.place(value.origin or target.origin or origin)
        if place.shape:
            self.assign_array(value, place, names, storage.watch)
        elif storage.bounds != (None, None):
            operand = self.expressions.stored(value, storage.kind, names)
            self.check_bounds(operand, storage)
            self.cells.write(operand, place, storage.watch)
        else:
            self.expressions.put(value, place, names, storage.watch)

    def assigned(self, target: Expression, names: StorageNames) -> tuple[Storage, list[ArrayAccess]]:
        accesses: list[ArrayAccess] = []
        inner = target
        while isinstance(inner, ArrayAccess):
            accesses.append(inner)
            inner = inner.array
        if not isinstance(inner, Name):
            raise FaultError(unsupported(inner), target.origin)
        storage = names.meaning(inner)
        if not isinstance(storage, Storage) or storage.is_constant:
            raise FaultError(f"`{inner.identifier}` is not a variable, so it cannot be assigned to", target.origin)
        if len(accesses) > len(storage.shape):
            raise FaultError("this is not an array", target.origin)
        accesses.reverse()
        return storage, accesses

    def assign_array(self, value: Expression, place: Region, names: StorageNames, watch: int) -> None:
        if place.offset < 0 and not isinstance(value, (ArrayValue, ArrayConstructor, Conditional)):
            self.expressions.fill(value, place, names, watch)
            return
        # The new value may depend on the current one, so it is computed in a copy.
        copy = self.expressions.materialized(value, place.kind, place.shape, names)
        self.write_early(place, copy.base, watch)

    def write_early(self, place: Region, register: int, watch: int) -> None:
        is_real = place.kind == REAL
        if not place.shape:
            self.cells.write(Operand(place.kind, register), place, watch)
        elif place.offset < 0:
            self.tape.emit(opcodes.COPY_REAL if is_real else opcodes.COPY, place.base, register, watch, place.size)
        else:
            code = opcodes.STORE_MANY_REAL if is_real else opcodes.STORE_MANY
            self.tape.emit(code, place.base, place.offset, register, place.size)
            if watch >= 0:
                self.tape.emit(opcodes.NOTE, watch)

    def early(self, target: Expression, value: Expression, names: StorageNames, origin: Origin | None = None) -> Later:
        """Write code that computes the value and the target of an assignment. `finish` stores the value."""
        self.tape.place(target.origin or origin)
        storage, accesses = self.assigned(target, names)
        place = self.expressions.indexed(Region(storage.kind, storage.shape, storage.base), accesses, names)
        if place.offset >= 0:
            offset = self.tape.reserve(INT, 1)
            self.tape.emit(opcodes.MOVE, offset, place.offset)
            place = Region(place.kind, place.shape, place.base, offset)
        self.tape.place(value.origin or target.origin or origin)
        if place.shape:
            return Later(
                place, self.expressions.materialized(value, storage.kind, place.shape, names).base, storage.watch
            )
        register = self.tape.reserve(storage.kind, 1)
        operand = self.expressions.stored(value, storage.kind, names, register)
        self.check_bounds(operand, storage)
        return Later(place, register, storage.watch)

    def finish(self, later: Later) -> None:
        self.write_early(later.place, later.register, later.watch)

    def reset(self, storage: Storage) -> None:
        """Write code that resets a variable to its initial value."""
        for i in range(product(storage.shape)):
            cells: Sequence[Number] = self.tape.reals if storage.kind == REAL else self.tape.ints
            value = self.tape.constant(storage.kind, cells[storage.base + i])
            self.cells.write(value, Region(storage.kind, (), storage.base + i), storage.watch)

    def check_bounds(self, operand: Operand, storage: Storage) -> None:
        low, high = storage.bounds
        if low is None and high is None:
            return
        is_real = storage.kind == REAL
        low = (-float("inf") if is_real else -MAX_INT64 - 1) if low is None else low
        high = (float("inf") if is_real else MAX_INT64) if high is None else high
        ends = [self.tape.constant(storage.kind, end).register for end in (low, high)]
        self.tape.emit(opcodes.RANGE_REAL if is_real else opcodes.RANGE, 0, operand.register, *ends)
