# SPDX-License-Identifier: Apache-2.0
"""How the values of the variables differ between the states of a search: which variables make the states many."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Any

from roaml.record import Record
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.registers import BOOL, REAL, product

MAX_DECODED = 2_000_000
"""The maximum number of values that are read from the states; it takes a tenth of a second."""
MIN_VALUES = 10
"""The minimum number of different values with which a variable may be one that grows."""
MIN_NEW = 0.25
"""The minimum part of these values that only states of the second half have: states are numbered in the order of the
search, so a variable that grows with it has other values there."""


class Spread(Record, frozen=True):
    """The values of a variable whose number grows with the search.

    Attributes:
        instance: the number of the instance that declares the variable; `None` for a variable of the model.
        name: the name of the variable.
        values: the number of different values, at least; an array is one value.
        least, greatest: the range of the values; of the elements of an array.
        has_maximum: whether its type has a maximum.
    """

    instance: int | None
    name: str
    values: int
    least: float
    greatest: float
    has_maximum: bool


def growing(checker: ModelChecker, search: Any) -> list[Spread]:
    """The variables with more and more values, from a sample of the states: those with most values first."""
    states = _sampled(search)
    keys = [search.key(state) for state in states]
    spreads = (_spread(checker, instance, storage, keys) for instance, storage in variables_of(checker))
    return sorted((spread for spread in spreads if spread is not None), key=lambda spread: -spread.values)


def _sampled(search: Any) -> range:
    """States at equal distances, up to the last one."""
    if search.count == 0:
        return range(0)
    many = max(2 * MIN_VALUES, MAX_DECODED // max(1, len(search.key(0))))
    step = -(-search.count // many)
    return range((search.count - 1) % step, search.count, step)


def variables_of(checker: ModelChecker) -> Iterator[tuple[int | None, Storage]]:
    """The variables of the model (`None`) and of its instances, by their numbers."""
    layout = checker.legend.layout
    yield from ((None, storage) for storage in layout.shared)
    for number, instance in enumerate(layout.instances):
        yield from ((number, storage) for storage in instance.own)


def _spread(checker: ModelChecker, instance: int | None, storage: Storage, keys: list[list[int]]) -> Spread | None:
    """The values of a variable in some states; `None` if they do not grow with the number of the state."""
    size = product(storage.shape)
    if storage.kind == BOOL or size == 0:
        return None
    program = checker.program
    first = program.instances + storage.base + (program.int_count if storage.kind == REAL else 0)
    values = [tuple(key[first : first + size]) for key in keys]
    different, earlier = set(values), set(values[: len(values) // 2])
    if len(different) < MIN_VALUES or len(different - earlier) < MIN_NEW * len(different):
        return None
    elements = [cell_value(element, storage.kind) for value in different for element in value]
    return Spread(instance, storage.name, len(different), min(elements), max(elements), storage.bounds[1] is not None)


def cell_value(element: int, kind: str) -> float:
    """The value of a cell; that of a real number contains its bits."""
    if kind != REAL:
        return element
    value: float = struct.unpack("d", struct.pack("q", element))[0]
    return value
