# SPDX-License-Identifier: Apache-2.0
"""Indexes for guards that begin with comparisons `variable = constant`: by the values of such variables, the guards
that may be true. With hundreds of these guards, only a few are evaluated.

The guards are found in their bytecode. Only the comparisons before the first other instruction are used, so a guard
that is not evaluated would have been false, without an error.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Mapping, Sequence
from typing import TypeAlias

from roaml.record import Record
from roaml.smc import opcodes
from roaml.smc.opcodes import WIDTH

MIN_INDEXED = 4
"""With fewer guards, an index is not faster."""
MAX_LISTS_PER_GUARD = 4
"""Bounds the number of lists in an index, as a multiple of the guards."""
MIN_SHARE = 0.5
"""The least share of the guards that an index must contain."""

_COMPARISONS = (
    opcodes.FAIL_EQ,
    opcodes.FAIL_NE,
    opcodes.FAIL_LT,
    opcodes.FAIL_LE,
    opcodes.FAIL_TRUE,
    opcodes.FAIL_FALSE,
)

Fixed: TypeAlias = Mapping[int, int]
"""The values that registers must have for a guard to be true."""


def fixed_values(
    code: Sequence[int], start: int, ints: Sequence[int], int_count: int, constants: Container[int]
) -> dict[int, int]:
    """The values that the registers of variables must have for a guard to be true, as far as its first comparisons show
    them.

    Args:
        start: the index of the first instruction of the guard; -1 if the guard is always true.
        int_count: the number of registers that are variables; they are the first ones.
        constants: the registers of constants.
    """
    values: dict[int, int] = {}
    at = start
    while at >= 0:
        for register, value in _equality(code, at, ints, int_count, constants):
            values.setdefault(register, value)
        if code[at] not in _COMPARISONS:
            break
        at += WIDTH
    return values


def is_fixed(
    code: Sequence[int], start: int, ints: Sequence[int], int_count: int, constants: Container[int], fixed: Fixed
) -> bool:
    """Whether a guard is true if the registers have its fixed values `fixed`, because it compares nothing else. The
    other parameters are those of `fixed_values`."""
    at = start
    while at >= 0:
        equal = _equality(code, at, ints, int_count, constants)
        if not equal or any(fixed.get(register) != value for register, value in equal):
            return False
        if code[at] == opcodes.IS_EQ:
            return True
        at += WIDTH
    return False


def _equality(
    code: Sequence[int], at: int, ints: Sequence[int], int_count: int, constants: Container[int]
) -> list[tuple[int, int]]:
    """The register of a variable and its value, if the instruction at `at` requires that they are equal."""
    op, a, b = code[at], code[at + 2], code[at + 3]
    if op in (opcodes.FAIL_NE, opcodes.IS_EQ):
        if b < int_count and a in constants:
            a, b = b, a
        if a < int_count and b in constants:
            return [(a, ints[b])]
    return []


class Dimension(Record, frozen=True):
    """A register, and its values `low`, `low + 1` ... that an index distinguishes; `size` is their number."""

    register: int
    low: int
    size: int


class Indexes:
    """Indexes by the values of some registers. The index i has the dimensions from `dimension_start[i]` to
    `dimension_start[i + 1]`, and the lists from `first_list[i]` to `first_list[i + 1]`: one for each combination of
    values, in which the values of the last dimension change fastest, and a last one for all other values. The range
    from `list_start[i]` to `list_start[i + 1]` of `items` contains list i. An item is a number n, or -1 - n if
    the guard of n is true for these values and need not be evaluated."""

    def __init__(self) -> None:
        self.dimensions: list[Dimension] = []
        self.dimension_start = [0]
        self.first_list = [0]
        self.list_start = [0]
        self.items: list[int] = []
        self._known: dict[tuple[tuple[Dimension, ...], tuple[int, ...]], int] = {}

    def add(
        self, dimensions: Sequence[Dimension], guards: Mapping[int, Fixed], fixed: Container[int], *, has_all: bool
    ) -> int:
        """Add an index, unless there is an equal one; return its number.

        Args:
            guards: a number -> the fixed values of its guard, in the order of the lists.
            fixed: the numbers whose guards are true if the registers have these values.
            has_all: whether the lists also contain the guards that do not fix all registers.
        """
        key = tuple(dimensions), (int(has_all), *guards)
        if key in self._known:
            return self._known[key]
        self._known[key] = len(self.first_list) - 1
        registers = {dimension.register for dimension in dimensions}
        count = 1
        for dimension in dimensions:
            count *= dimension.size
        lists: list[list[int]] = [[] for _ in range(count + 1)]
        for number, values in guards.items():
            if registers <= values.keys():
                at = 0
                for dimension in dimensions:
                    at = at * dimension.size + values[dimension.register] - dimension.low
                lists[at].append(-1 - number if number in fixed and registers == values.keys() else number)
            elif has_all:
                for items in lists:
                    items.append(number)
        for items in lists:
            self.items += items
            self.list_start.append(len(self.items))
        self.first_list.append(len(self.list_start) - 1)
        self.dimensions += dimensions
        self.dimension_start.append(len(self.dimensions))
        return len(self.first_list) - 2


def dimensions_of(guards: Sequence[Fixed]) -> list[Dimension]:
    """The dimensions of an index for guards with these fixed values; none if an index would not be faster. The
    registers that most guards fix come first."""
    dimensions: list[Dimension] = []
    keyed = [fixed for fixed in guards if fixed]
    lists = 1
    while len(keyed) >= MIN_INDEXED:
        used = {dimension.register for dimension in dimensions}
        counts = Counter(register for fixed in keyed for register in fixed if register not in used)
        best: Dimension | None = None
        for register, count in sorted(counts.items()):
            values = [fixed[register] for fixed in keyed if register in fixed]
            dimension = Dimension(register, min(values), max(values) - min(values) + 1)
            is_small = lists * dimension.size <= MAX_LISTS_PER_GUARD * count
            if dimension.size == 1 or not is_small or count < MIN_SHARE * len(guards):
                continue
            if best is None or (count, dimension.size) > (counts[best.register], best.size):
                best = dimension
        if best is None:
            break
        dimensions.append(best)
        lists *= best.size
        keyed = [fixed for fixed in keyed if best.register in fixed]
    return dimensions
