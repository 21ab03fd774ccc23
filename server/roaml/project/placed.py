# SPDX-License-Identifier: Apache-2.0
"""Replaces the places in data, such as a translated system, without knowing the data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from roaml.record import Record, replace
from roaml.text import Location

T = TypeVar("T")


def placed(value: T, place: Callable[[Location], Location]) -> T:
    """`value` with the result of `place` instead of each location in records, tuples and mappings. Parts without
    locations are shared."""
    result: T = _placed(value, place, {})
    return result


def _placed(value: Any, place: Callable[[Location], Location], known: dict[int, tuple[Any, Any]]) -> Any:
    if isinstance(value, Location):
        return place(value)
    if not isinstance(value, (Record, tuple, Mapping)):
        return value
    if id(value) in known:
        return known[id(value)][1]
    result = value
    if isinstance(value, Record):
        changes = {}
        for name in value.__struct_fields__:
            before = getattr(value, name)
            after = _placed(before, place, known)
            if after is not before:
                changes[name] = after
        result = replace(value, **changes) if changes else value
    elif isinstance(value, Mapping):
        items = {key: _placed(part, place, known) for key, part in value.items()}
        result = items if any(items[key] is not part for key, part in value.items()) else value
    elif type(value) is tuple:
        parts = tuple(_placed(part, place, known) for part in value)
        result = parts if any(a is not b for a, b in zip(parts, value, strict=True)) else value
    known[id(value)] = (value, result)  # the reference keeps the number in use
    return result
