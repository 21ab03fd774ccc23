# SPDX-License-Identifier: Apache-2.0
"""The types of the parameters of events (docs/spec/jani.md#global-variables).

They depend on each other, because a `<send>` may forward what the received event carries. So they are inferred in
rounds: each round uses the types of the round before, until those of the forwarded parameters no longer change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

from roaml.expr.types import UNKNOWN, Type, join, unwrap

T = TypeVar("T")
D = TypeVar("D")

MAX_DIMENSIONS = 100
"""The maximum number of dimensions of an inferred array. An event that forwards itself in an array has no bound."""


@dataclass(frozen=True, slots=True)
class Round(Generic[T, D]):
    """
    Attributes:
        result: what the round computed.
        data: event -> the types of its data.
        forwarded: the events whose data the parameters of events depend on.
    """

    result: T
    data: Mapping[str, D]
    forwarded: frozenset[str]


def infer_in_rounds(infer: Callable[[Mapping[str, D]], Round[T, D]]) -> T:
    """The result of the last round. The first one knows no data of events."""
    known: Mapping[str, D] = {}
    last = infer(known)
    # The type of a parameter can change twice: unknown, int, real.
    for _ in range(2 * len(last.forwarded) + 1):
        if all(last.data.get(event) == known.get(event) for event in last.forwarded):
            break
        known = last.data
        last = infer(known)
    return last.result


def parameter_types(sent: Iterable[tuple[str, Type]]) -> dict[str, Type]:
    """The types of the parameters of an event, in the order of their first occurrence. If the types of the values of a
    parameter do not fit, the first known one is used.

    Args:
        sent: name and type of each value that is sent.
    """
    types: dict[str, Type] = {}
    for name, type_ in sent:
        known = types.get(name, UNKNOWN)
        joined = join(known, type_) or known
        types[name] = joined if len(unwrap(joined)[1]) <= MAX_DIMENSIONS else known
    return types
