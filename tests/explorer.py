# SPDX-License-Identifier: Apache-2.0
"""All states of a model, if there are few, in plain data. Tests compare the engines with it."""

from __future__ import annotations

import itertools
import math
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from roaml.smc.batch import TraceProblem
from roaml.smc.kernel import Kernel
from roaml.smc.program import FALSE, FAULTY, TRUE, Compiled

MAX_COMBINATIONS = 1 << 20
"""The maximum number of combinations of edges and destinations in one state. Exploring this many takes a few
seconds."""


class ExploredState(NamedTuple):
    """The current locations of all instances, and the values of all variables."""

    place: tuple[int, ...]
    ints: tuple[int, ...]
    reals: tuple[float, ...]


class Successor(NamedTuple):
    """A successor with its probability."""

    probability: float
    state: ExploredState


class TooManyStatesError(Exception):
    """There are more states than allowed."""


class TooManyChoicesError(Exception):
    """One state has more combinations of edges and their destinations than allowed."""


class StateFaultError(Exception):
    """A state executes an undefined operation."""

    def __init__(self, problem: TraceProblem) -> None:
        super().__init__(problem)
        self.problem = problem


class Explorer:
    """Explores all states that can be reached before a goal without step bounds is decided.

    Args:
        limit: the maximum number of combinations of edges and destinations that are enumerated in one state. With n
            automata of k edges on one action there are kⁿ of them.
    """

    def __init__(self, compiled: Compiled, limit: int = MAX_COMBINATIONS) -> None:
        self._limit = limit
        self._kernel = Kernel(compiled.program, compiled.goal)
        self._instances = compiled.program.instances
        self._kernel.begin(0, 0)
        self.initial = self._state()

    def verdict(self, state: ExploredState) -> int:
        """The verdict on the goal in the first state of a trace."""
        self._kernel.restore(*state)
        return self._kernel.look()

    def choices(self, state: ExploredState) -> Iterator[tuple[int, list[Successor]]]:
        """The choices of a state. For each: the number of choices that are equal to it, and its successors.

        Raises:
            StateFaultError: a choice executes an undefined operation.
            TooManyChoicesError: there are more than `limit`; nothing has been enumerated.
        """
        self._kernel.restore(*state)
        vectors = self._kernel.choices()
        # Each combination of edges is a choice, and each combination of their destinations is a successor of this
        # choice.
        if sum(math.prod(sum(map(len, edges)) for edges in slots) for _, _, slots in vectors) > self._limit:
            raise TooManyChoicesError
        for vector, times, slots in vectors:
            for picks in itertools.product(*(range(len(edges)) for edges in slots)):
                ways = [slots[i][pick] for i, pick in enumerate(picks)]
                branches = []
                for taken in itertools.product(*(range(len(options)) for options in ways)):
                    probability = 1.0
                    for i, way in enumerate(taken):
                        probability *= ways[i][way]
                    if probability > 0:
                        self._kernel.restore(*state)
                        if self._kernel.go(vector, list(picks), list(taken)) == FAULTY:
                            raise StateFaultError(TraceProblem(0, *self._kernel.problem()))
                        branches.append(Successor(probability, self._state()))
                yield times, branches

    def reachable(self, limit: int) -> dict[ExploredState, int]:
        """All states with their verdicts on the goal. States after a decided one are not explored.

        Raises:
            TooManyStatesError: there are more than `limit`.
            TooManyChoicesError, StateFaultError: see `choices`.
        """
        verdicts = {self.initial: self.verdict(self.initial)}
        waiting = deque(verdicts)
        while waiting:
            state = waiting.popleft()
            if verdicts[state] in (TRUE, FALSE):
                continue
            for _, branches in self.choices(state):
                for _, successor in branches:
                    if successor not in verdicts:
                        if len(verdicts) >= limit:
                            raise TooManyStatesError
                        verdicts[successor] = self.verdict(successor)
                        waiting.append(successor)
        return verdicts

    def _state(self) -> ExploredState:
        ints, reals = self._kernel.snapshot()
        place = tuple(self._kernel.location(i) for i in range(self._instances))
        return ExploredState(place, tuple(ints), tuple(reals))
