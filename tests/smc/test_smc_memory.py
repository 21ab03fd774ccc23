# SPDX-License-Identifier: Apache-2.0
"""Flat memory: arrays that are zero at first and keep their numbers when they grow."""

from __future__ import annotations

import mmap
from typing import Any

import pytest

from roaml.smc import memory
from roaml.smc.memory import MAX_HEAP_BYTES, RESERVED_FACTOR, flat, grown

SMALL = 100
LARGE = MAX_HEAP_BYTES
"""Numbers of elements; `LARGE` elements of four bytes are a mapping."""


@pytest.mark.parametrize("typecode", ["B", "i", "q", "Q", "d"])
@pytest.mark.parametrize(
    ("before", "after"), [(SMALL, 2 * SMALL), (SMALL, LARGE), (LARGE, 3 * LARGE), (LARGE, LARGE + 1)]
)
def test_numbers_are_kept_and_new_ones_are_zero(typecode: str, before: int, after: int) -> None:
    numbers = flat(typecode, before)
    assert (len(numbers), set(numbers)) == (before, {0})
    for index in range(before):
        numbers[index] = index % 251
    larger = grown(numbers, after)
    assert len(larger) == after
    assert list(larger[:before]) == [index % 251 for index in range(before)]
    assert set(larger[before:]) == {0}


def test_a_large_array_grows_in_place() -> None:
    first = grown(flat("i", LARGE), 2 * LARGE)
    second = grown(first, 4 * LARGE)
    assert second.obj is first.obj
    assert grown(second, 2 * RESERVED_FACTOR * LARGE).obj is first.obj
    assert grown(second, 2 * RESERVED_FACTOR * LARGE + 1).obj is not first.obj


def test_without_space_to_reserve_the_array_still_grows(monkeypatch: pytest.MonkeyPatch) -> None:
    class Refusing(mmap.mmap):
        def __new__(cls, descriptor: int, size: int, **named: Any) -> Refusing:
            if size > 16 * LARGE:
                raise OSError("cannot allocate memory")
            return super().__new__(cls, descriptor, size, **named)

    numbers = flat("i", LARGE)
    numbers[LARGE - 1] = 7
    monkeypatch.setattr(memory.mmap, "mmap", Refusing)
    larger = grown(numbers, 2 * LARGE)
    assert (len(larger), larger[LARGE - 1], larger[LARGE]) == (2 * LARGE, 7, 0)
