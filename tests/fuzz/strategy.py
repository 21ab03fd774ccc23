# SPDX-License-Identifier: Apache-2.0
"""The interface of the strategies of the fuzzer.

A strategy is a module in `fuzz/strategies` with a constant `STRATEGY`, which registers it. It makes a case from a seed.
A case describes itself, runs, and yields the invariants that do not hold. `fuzz.runner` detects exceptions, hangs and
the use of memory, so a strategy only checks other invariants.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Failure:
    """An invariant that does not hold. `kind` is the same for equal failures of different cases."""

    kind: str
    details: str


class Case(Protocol):
    """One input, which is determined by the seed."""

    def description(self) -> Iterable[str]:
        """A description of the case, as lines."""

    def files(self) -> Mapping[str, str | bytes]:
        """The input: file name or path -> text."""

    def run(self) -> Iterable[Failure]:
        """Run the case and yield the invariants that do not hold. An exception is also a failure.

        A case that runs several commands, each of which may take the whole time, calls `fuzz.limits.restart` between
        them.
        """


@dataclass(frozen=True)
class Strategy:
    """A strategy.

    Attributes:
        name: the name on the command line; a case is named `NAME:SEED`.
        summary: what it does, in one sentence.
        make: returns the case of a seed; it must not depend on anything else.
        share: the number of its cases in a run, relative to the other strategies.
    """

    name: str
    summary: str
    make: Callable[[int], Case]
    share: int = 1
