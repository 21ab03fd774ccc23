# SPDX-License-Identifier: Apache-2.0
"""What a strategy of the fuzzer is.

A strategy is one module in `fuzz/strategies` with a constant `STRATEGY`; that registers it. It makes a case of a seed.
A case says what it does, runs, and yields what does not hold. Exceptions, hangs and the use of memory are noticed by
those who run it (`fuzz.runner`), so a strategy looks only for what is wrong beyond that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Failure:
    """Something that does not hold. `kind` is equal for equal failures of different cases."""

    kind: str
    details: str


class Case(Protocol):
    """One input. The seed alone decides what it is."""

    def description(self) -> Iterable[str]:
        """What the case is, in lines."""

    def files(self) -> Mapping[str, str | bytes]:
        """The input: a name or path for each text."""

    def run(self) -> Iterable[Failure]:
        """What does not hold. Whatever it raises is a failure, too.

        A case that does several things of which each may take the whole time calls `fuzz.limits.restart` between them.
        """


@dataclass(frozen=True)
class Strategy:
    """Attributes:
    name: as the command line names it; a case is named `NAME:SEED`.
    summary: what it does, in one sentence.
    make: the case of a seed; must not depend on anything else.
    share: how many cases of a run it gets, relative to the other strategies.
    """

    name: str
    summary: str
    make: Callable[[int], Case]
    share: int = 1
