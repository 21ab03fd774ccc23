# SPDX-License-Identifier: Apache-2.0
"""Writes code that copies values between registers and the cells of arrays, and pads smaller arrays with zeros."""

from __future__ import annotations

from roaml.jani.node import Node
from roaml.smc import opcodes
from roaml.smc.fault import FaultCode, FaultError
from roaml.smc.registers import INT, REAL, Operand, Region, Tape, product


class CellAssembler:
    """Writes code that copies computed values. `watch` is the number of the variable that is written, or -1 if its
    changes are not tracked."""

    def __init__(self, tape: Tape) -> None:
        self.tape = tape

    def end(self) -> None:
        """Write the end of a piece of code whose result is not used."""
        self.tape.emit(opcodes.RETURN, a=self.tape.constant(INT, 0).register)

    def failing(self, node: Node, code: FaultCode, kind: str, value: int = 0, size: int = 0) -> Operand:
        """Write code for an expression that has no value: the code fails if it is executed."""
        self.tape.place(node.origin)
        self.tape.emit(opcodes.FAULT, code, value, size)
        return Operand(kind, self.tape.temporary(kind))

    # ------------------------------------------------------------ scalars

    def moved(self, operand: Operand, into: int) -> Operand:
        if into < 0 or operand.register == into:
            return operand
        self.tape.emit(opcodes.MOVE_REAL if operand.kind == REAL else opcodes.MOVE, into, operand.register)
        return Operand(operand.kind, into)

    def target(self, kind: str, into: int) -> int:
        return into if into >= 0 else self.tape.temporary(kind)

    def as_real(self, operand: Operand, into: int = -1) -> Operand:
        if operand.kind == REAL:
            return self.moved(operand, into)
        if operand.value is not None:
            return self.moved(self.tape.constant(REAL, float(operand.value)), into)
        register = self.target(REAL, into)
        self.tape.emit(opcodes.REAL, register, operand.register)
        return Operand(REAL, register)

    def load(self, cell: Region, into: int = -1) -> Operand:
        """Write code that reads a single cell. Return the register with the value."""
        if cell.offset < 0:
            return self.moved(Operand(cell.kind, cell.base), into)
        register = self.target(cell.kind, into)
        self.tape.emit(opcodes.LOAD_REAL if cell.kind == REAL else opcodes.LOAD, register, cell.base, cell.offset)
        return Operand(cell.kind, register)

    def write(self, value: Operand, cell: Region, watch: int) -> None:
        is_real = cell.kind == REAL
        if cell.offset >= 0:
            code = opcodes.STORE_REAL if is_real else opcodes.STORE
            self.tape.emit(code, cell.base, cell.offset, value.register, watch)
        elif watch >= 0:
            self.tape.emit(opcodes.SET_REAL if is_real else opcodes.SET, cell.base, value.register, watch)
        else:
            self.moved(value, cell.base)

    # ------------------------------------------------------------ arrays

    def part(self, region: Region, position: int) -> Region:
        shape = region.shape[1:]
        return Region(region.kind, shape, region.base + position * product(shape), region.offset)

    def clear(self, into: Region, watch: int) -> None:
        zero = self.tape.constant(into.kind, 0)
        for i in range(into.size):
            self.write(zero, Region(into.kind, (), into.base + i, into.offset), watch)

    def copy(self, source: Region, into: Region, watch: int, node: Node) -> None:
        """Write code that copies an array to a region whose `offset` is -1."""
        if len(source.shape) != len(into.shape):
            raise FaultError("the arrays have different numbers of dimensions", node.origin)
        if source.kind != into.kind and into.kind == REAL:
            for i in range(into.size):
                value = self.load(Region(source.kind, (), source.base + i, source.offset))
                self.write(self.as_real(value), Region(REAL, (), into.base + i), watch)
            return
        if source.shape[1:] == into.shape[1:] and source.shape[0] <= into.shape[0]:
            self.copy_block(source, into, watch)
            rest = into.size - source.size
            if rest:
                self.clear(Region(into.kind, (rest,), into.base + source.size), watch)
            return
        if source.shape[0] > into.shape[0]:
            self.failing(node, FaultCode.INDEX, INT, into.shape[0], into.shape[0])
            return
        for position in range(into.shape[0]):
            part = self.part(into, position)
            if position < source.shape[0]:
                self.copy(self.part(source, position), part, watch, node)
            else:
                self.clear(part, watch)

    def copy_block(self, source: Region, into: Region, watch: int) -> None:
        is_real = into.kind == REAL
        if source.offset < 0:
            code = opcodes.COPY_REAL if is_real else opcodes.COPY
            self.tape.emit(code, into.base, source.base, watch, source.size)
            return
        code = opcodes.COPY_INDEXED_REAL if is_real else opcodes.COPY_INDEXED
        self.tape.emit(code, into.base, source.base, source.offset, source.size)
        if watch >= 0:
            self.tape.emit(opcodes.NOTE, watch)
