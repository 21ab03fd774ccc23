# SPDX-License-Identifier: Apache-2.0
"""Random trees over all nodes of the libraries, tick by exact tick beside a second model of the libraries: with mocks,
and in a system whose leaves are plugins."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from random import Random

from random_trees import ANY, WITH_WORLD, Drawn, SeededChoices, as_xml
from tree_comparison import difference_in_system, difference_with_mocks

from fuzz.limits import restart
from fuzz.strategy import Failure, Strategy

TICKS = 14


@dataclass
class RandomTree:
    """Attributes:
    happens: whether the events of the world that the nodes of Nav2 ask about always occur, or never.
    """

    seed: int
    with_mocks: Drawn
    in_system: Drawn
    happens: bool

    def description(self) -> Iterator[str]:
        yield f"a tree with {self.with_mocks.type} at its top, and a system with {self.in_system.type}"

    def files(self) -> dict[str, str | bytes]:
        return {"mocks.xml": as_xml(self.with_mocks), "system.xml": as_xml(self.in_system)}

    def run(self) -> Iterator[Failure]:
        difference = difference_with_mocks(self.with_mocks, TICKS, self.seed, happens=self.happens)
        if difference:
            yield Failure("a tree with mocks differs from the library", difference)
        restart()
        difference = difference_in_system(self.in_system, TICKS, self.seed, restart)
        if difference:
            yield Failure("a tree of a system differs from the library", difference)


def make(seed: int) -> RandomTree:
    choices = SeededChoices(Random(f"trees {seed}"))
    return RandomTree(seed, WITH_WORLD.tree(choices), ANY.tree(choices), choices.one_of((False, True)))


STRATEGY = Strategy("trees", "compares random trees with a second model of the libraries, tick by tick", make)
