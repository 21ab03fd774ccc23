# SPDX-License-Identifier: Apache-2.0
"""Random trees over the nodes of BehaviorTree.CPP, tick by exact tick beside the library itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import util
from random import Random

from random_trees import Drawn, SeededChoices, as_xml
from real_library import RANDOM, difference_from_library

from fuzz.strategy import Failure, Strategy

IS_INSTALLED = util.find_spec("behaviortreepy") is not None


@dataclass
class RealTree:
    seed: int
    drawn: Drawn

    def description(self) -> Iterator[str]:
        yield f"a tree with {self.drawn.type} at its top"
        if not IS_INSTALLED:
            yield "behaviortreepy is not installed, so the tree is not compared"

    def files(self) -> dict[str, str | bytes]:
        return {"tree.xml": as_xml(self.drawn)}

    def run(self) -> Iterator[Failure]:
        if not IS_INSTALLED:
            return
        import behaviortreepy  # noqa: PLC0415 - not everywhere

        difference = difference_from_library(behaviortreepy, self.drawn, self.seed)
        if difference:
            yield Failure("a tree with mocks differs from BehaviorTree.CPP", difference)


def make(seed: int) -> RealTree:
    return RealTree(seed, RANDOM.tree(SeededChoices(Random(f"real trees {seed}"))))


STRATEGY = Strategy("real-trees", "compares random trees with BehaviorTree.CPP itself, tick by tick", make)
