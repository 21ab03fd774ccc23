# SPDX-License-Identifier: Apache-2.0
"""The allocation of registers and instructions while a model is compiled."""

from __future__ import annotations

from typing import TypeAlias

from roaml.jani.node import Origin
from roaml.jani.operators import Operator
from roaml.record import Record
from roaml.smc import opcodes
from roaml.smc.opcodes import ORDERS, WIDTH

BOOL, INT, REAL = "bool", "int", "real"
"""Kinds of values. Bools and ints share the same registers."""

_FAILING = {
    opcodes.JUMP_TRUE: opcodes.FAIL_TRUE,
    opcodes.JUMP_FALSE: opcodes.FAIL_FALSE,
    opcodes.JUMP_EQ: opcodes.FAIL_EQ,
    opcodes.JUMP_NE: opcodes.FAIL_NE,
    opcodes.JUMP_LT: opcodes.FAIL_LT,
    opcodes.JUMP_LE: opcodes.FAIL_LE,
}
"""A jump -> the instruction that returns 0 instead of jumping."""
_DECIDING = {
    opcodes.FAIL_TRUE: (opcodes.IS_NE, False),
    opcodes.FAIL_FALSE: (opcodes.IS_NE, False),
    opcodes.FAIL_EQ: (opcodes.IS_NE, False),
    opcodes.FAIL_NE: (opcodes.IS_EQ, False),
    opcodes.FAIL_LT: (opcodes.IS_LE, True),
    opcodes.FAIL_LE: (opcodes.IS_LT, True),
}
"""An instruction that returns 0 -> the one that returns 1 otherwise, and whether its operands are swapped."""

Number: TypeAlias = "bool | int | float"


class Operand(Record, frozen=True):
    """A scalar in a register. `value` is its value if that is known during compilation, otherwise `None`."""

    kind: str
    register: int
    value: Number | None = None


class Region(Record, frozen=True):
    """Consecutive registers of an array, row by row. `offset` is an int register that is added to `base`, or -1."""

    kind: str
    shape: tuple[int, ...]
    base: int
    offset: int = -1

    @property
    def size(self) -> int:
        return product(self.shape)


def product(shape: tuple[int, ...]) -> int:
    """The number of elements of an array."""
    size = 1
    for length in shape:
        size *= length
    return size


class Label:
    """A target of jumps in the code. `Tape.mark` determines its place, before or after the jumps are written."""

    def __init__(self) -> None:
        self.at = -1
        self.uses: list[int] = []


class Tape:
    """The code that has been written so far, and the registers that it uses."""

    def __init__(self) -> None:
        self.code: list[int] = []
        self.ints: list[int] = []
        self.reals: list[float] = []
        self.functions: list[Operator] = []
        self.origins: list[tuple[int, Origin | None]] = []
        self._constants: dict[tuple[str, Number], Operand] = {}
        self._functions: dict[Operator, int] = {}
        self._free_ints: list[int] = []
        self._free_reals: list[int] = []
        self._used_ints = 0
        self._used_reals = 0

    @property
    def here(self) -> int:
        return len(self.code)

    def emit(self, op: int, d: int = 0, a: int = 0, b: int = 0, c: int = 0) -> None:
        self.code += (op, d, a, b, c)

    def place(self, origin: Origin | None) -> None:
        """Set the origin of the following instructions."""
        if origin is not None:
            self.origins.append((len(self.code), origin))

    def jump(self, op: int, label: Label, a: int = 0, b: int = 0) -> None:
        label.uses.append(len(self.code) + 1)
        if op in (opcodes.JUMP_TRUE, opcodes.JUMP_FALSE):
            b = self.constant(INT, 1 if op is opcodes.JUMP_TRUE else 0).register
        self.emit(op, label.at, a, b, ORDERS.get(op, 0))

    def mark(self, label: Label) -> None:
        label.at = len(self.code)
        for use in label.uses:
            self.code[use] = label.at

    def shorten(self, otherwise: Label) -> None:
        """Shorten a condition that has just been written: jumps to `otherwise`, whose code returns 0, become
        instructions that return 0; a comparison before the instruction that returns 1 returns the result itself."""
        returns_1 = otherwise.at - WIDTH
        for use in otherwise.uses:
            at = use - 1
            op = _FAILING.get(self.code[at])
            if op is None:
                continue
            self.code[at : at + 2] = op, 0
            if at + WIDTH == returns_1 and op in _DECIDING:
                op, is_swapped = _DECIDING[op]
                self.code[at] = op
                self.code[at + 4] = ORDERS[op]
                if is_swapped:
                    self.code[at + 2], self.code[at + 3] = self.code[at + 3], self.code[at + 2]

    def constant(self, kind: str, value: Number) -> Operand:
        """A register that always contains this value."""
        # The sign distinguishes -0.0 from 0.0, which are equal.
        key = (f"{kind}{str(value)[0]}", value)
        register = self._constants.get(key)
        if register is None:
            register = Operand(kind, self.reserve(kind, 1, value), value)
            self._constants[key] = register
        return register

    def reserve(self, kind: str, size: int, value: Number = 0) -> int:
        """Reserve consecutive registers; return the number of the first one."""
        if kind == REAL:
            self.reals += [float(value)] * size
            return len(self.reals) - size
        self.ints += [int(value)] * size
        return len(self.ints) - size

    def begin(self, origin: Origin | None = None) -> int:
        """Begin a piece of code with an origin; return its index. All temporary registers are free in it."""
        self._used_ints = self._used_reals = 0
        self.origins.append((len(self.code), origin))
        return len(self.code)

    def temporary(self, kind: str) -> int:
        """A register for an intermediate result in this piece of code."""
        if kind == REAL:
            if self._used_reals == len(self._free_reals):
                self._free_reals.append(self.reserve(kind, 1))
            self._used_reals += 1
            return self._free_reals[self._used_reals - 1]
        if self._used_ints == len(self._free_ints):
            self._free_ints.append(self.reserve(kind, 1))
        self._used_ints += 1
        return self._free_ints[self._used_ints - 1]

    @property
    def constants(self) -> frozenset[int]:
        """The int registers that contain constants."""
        return frozenset(operand.register for operand in self._constants.values() if operand.kind != REAL)

    def function(self, operator: Operator) -> int:
        """The number with which code calls the function of an operator."""
        if operator not in self._functions:
            self._functions[operator] = len(self.functions)
            self.functions.append(operator)
        return self._functions[operator]

    def origin_of(self, at: int) -> Origin | None:
        """The origin of the instruction at an index of the code."""
        origin_at = None
        for place, origin in self.origins:
            if place > at:
                break
            origin_at = origin
        return origin_at


assert WIDTH == 5
