# SPDX-License-Identifier: Apache-2.0
"""What the analysis of values remembers between two versions of a machine.

Most of its time is spent on following the same transitions with the same values again: in a loop, because only some
variables have new values, and after a change of the text, because most states are the same. So the results are
remembered by content: the texts of the conditions and assignments, without their places, and the values of the
variables in them.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import Any, TypeAlias

from roaml.expr.tree import Name, walk
from roaml.model.machine import Assign, If, Statement
from roaml.model.syntax import Expression, Value
from roaml.model.values.evaluate import Valuation
from roaml.record import Record

Transitions: TypeAlias = "list[tuple[str, Valuation]]"
"""The states that follow a state, each with the values with which it is entered."""


class RememberedPart(Record, frozen=True):
    """A part of a machine that can be remembered.

    Attributes:
        content: determines, with the values of the variables, what the part does.
        names: the variables that the part reads or writes.
    """

    content: Hashable
    names: frozenset[str]


class Memory:
    """The transitions of the last versions of a machine. What two versions in a row do not need is forgotten."""

    def __init__(self) -> None:
        self._before: dict[Hashable, Transitions] = {}
        self._now: dict[Hashable, Transitions] = {}
        self._is_complete = True

    def begin(self) -> None:
        """Begin a version. What the last one needed remains; an interrupted version replaces nothing."""
        if self._is_complete:
            self._before, self._now = self._now, {}
        self._is_complete = False

    def complete(self) -> None:
        """The analysis of the version has reached its end."""
        self._is_complete = True

    def transitions(
        self, part: RememberedPart, known: Valuation, follow: Callable[[Valuation], Iterable[tuple[str, Valuation]]]
    ) -> Iterator[tuple[str, Valuation]]:
        """The transitions of `part` with the values `known`: those of `follow` for the values of its own variables; the
        other variables keep their values."""
        inside: Valuation = {}
        outside: Valuation = {}
        for place, values in known.items():
            (inside if root(place) in part.names else outside)[place] = values
        key = (part.content, frozenset(inside.items()))
        found = self._now.get(key, self._before.get(key))
        if found is None:
            found = list(follow(inside))
        self._now[key] = found
        for target, after in found:
            yield target, outside | after


@functools.lru_cache(10_000)
def root(place: str) -> str:
    """The variable of a place."""
    return re.split(r"[.\[]", place, maxsplit=1)[0]


def effects(body: Iterable[Statement]) -> tuple[Any, ...]:
    """The texts of the conditions and assignments in a body; other statements change no variable."""
    return tuple(_effect(statement) for statement in body if isinstance(statement, Assign | If))


def _effect(statement: Assign | If) -> tuple[Any, ...]:
    if isinstance(statement, Assign):
        return (text_of(statement.location), text_of(statement.value))
    otherwise = None if statement.otherwise is None else effects(statement.otherwise.body)
    return (tuple((text_of(branch.cond), effects(branch.body)) for branch in statement.branches), otherwise)


def text_of(value: Value | None) -> Hashable:
    """The text of an expression, or the key of the port that is read."""
    if isinstance(value, Expression):
        return value.text
    return None if value is None else (value.key.value if value.key else "",)


def names_in(body: Iterable[Statement]) -> Iterator[str]:
    """The names in the conditions and assignments of a body."""
    for statement in body:
        if isinstance(statement, Assign):
            yield from names_of(statement.location)
            yield from names_of(statement.value)
        elif isinstance(statement, If):
            for branch in statement.branches:
                yield from names_of(branch.cond)
                yield from names_in(branch.body)
            yield from names_in(statement.otherwise.body if statement.otherwise else ())


def names_of(value: Value | None) -> Iterator[str]:
    if isinstance(value, Expression):
        yield from (node.name for node in walk(value.tree) if isinstance(node, Name))
