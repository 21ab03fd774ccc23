# SPDX-License-Identifier: Apache-2.0
"""Infers the types of the parameters of events (docs/spec/jani.md#global-variables).

The types depend on each other, because a `<send>` may forward the data of the received event. So they are inferred in
rounds. Each round uses the types of the previous round, until the types of forwarded parameters no longer change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Generic, TypeVar

from roaml.expr.types import UNKNOWN, Type, join, unwrap
from roaml.record import Record

T = TypeVar("T")
D = TypeVar("D")

MAX_DIMENSIONS = 100
"""The maximum number of dimensions of an inferred array. An event that forwards its own data in an array would add a
dimension in each round."""


class Round(Record, Generic[T, D], frozen=True):
    """The result of one round.

    Attributes:
        result: the result of the computation, in which the types of the previous round were used.
        data: event -> the types of its data.
        forwarded: the events whose data is forwarded, so that the parameters of other events depend on it.
    """

    result: T
    data: Mapping[str, D]
    forwarded: frozenset[str]


def infer_in_rounds(infer: Callable[[Mapping[str, D]], Round[T, D]]) -> T:
    """The result of the last round.

    Args:
        infer: computes one round from the known types: event -> the types of its data. In the first round, no types are
            known.
    """
    known: Mapping[str, D] = {}
    last = infer(known)
    # The type of a parameter can change only twice: from unknown to int, and from int to real.
    for _ in range(2 * len(last.forwarded) + 1):
        if all(last.data.get(event) == known.get(event) for event in last.forwarded):
            break
        known = last.data
        last = infer(known)
    return last.result


def parameter_types(sent: Iterable[tuple[str, Type]]) -> dict[str, Type]:
    """Parameter of an event -> its type, in the order of the first occurrences. If the values of a parameter have
    incompatible types, the first known type is used.

    Args:
        sent: the parameter and the type of each value that is sent.
    """
    types: dict[str, Type] = {}
    for name, type_ in sent:
        known = types.get(name, UNKNOWN)
        joined = join(known, type_) or known
        types[name] = joined if len(unwrap(joined)[1]) <= MAX_DIMENSIONS else known
    return types
