# SPDX-License-Identifier: Apache-2.0
"""Closed vocabularies: the base class of their enumerations, and the last case of an exhaustive `match`."""

from __future__ import annotations

import enum
from typing import NoReturn


class Vocabulary(enum.Enum):
    """A closed set of words. Members are compared by identity."""

    # `Enum` hashes the name in Python, which is slow for keys of dictionaries.
    __hash__ = object.__hash__

    def __str__(self) -> str:
        return str(self.value)

    def __lt__(self, other: Vocabulary) -> bool:
        """The order of the values as strings, so that tuples that contain members can be sorted."""
        return str(self.value) < str(other.value)


def assert_never(value: NoReturn) -> NoReturn:
    """Marks a case that a type checker proves to be unreachable, like `typing.assert_never` of Python 3.11: the checker
    reports the kinds of values for which the `match` has no case."""
    raise AssertionError(f"a value of an unexpected kind: {value!r}")
