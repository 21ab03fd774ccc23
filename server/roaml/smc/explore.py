# SPDX-License-Identifier: Apache-2.0
"""All states of a model, where there are few: for exact answers, and for tests of the engine itself."""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from roaml.smc.batch import Problem
from roaml.smc.kernel import Kernel
from roaml.smc.program import FALSE, FAULTY, TRUE, Compiled


class State(NamedTuple):
    """Where all instances are, and the values of all variables."""

    place: tuple[int, ...]
    ints: tuple[int, ...]
    reals: tuple[float, ...]


class Branch(NamedTuple):
    """A successor with its probability."""

    probability: float
    state: State


class TooManyStatesError(Exception):
    """There are more states than allowed."""


class StateFaultError(Exception):
    """Something that has no meaning happens in a state."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem)
        self.problem = problem


class Explorer:
    """Looks at all states that can be reached before a goal without step bounds is decided."""

    def __init__(self, compiled: Compiled) -> None:
        self._kernel = Kernel(compiled.program, compiled.goal)
        self._instances = compiled.program.instances
        self._kernel.begin(0, 0)
        self.initial = self._state()

    def verdict(self, state: State) -> int:
        """What is known of the goal in a state that is reached first."""
        self._kernel.restore(*state)
        return self._kernel.look()

    def choices(self, state: State) -> Iterator[list[Branch]]:
        """The choices of a state, as often as each counts, with their successors."""
        for times, branches in self._choices(state):
            for _ in range(times):
                yield branches

    def ways(self, state: State) -> Iterator[list[Branch]]:
        """The choices of a state, with their successors.

        Raises:
            StateFaultError: one of them goes wrong.
        """
        for _, branches in self._choices(state):
            yield branches

    def _choices(self, state: State) -> Iterator[tuple[int, list[Branch]]]:
        self._kernel.restore(*state)
        for vector, times, slots in self._kernel.choices():
            for picks in itertools.product(*(range(len(edges)) for edges in slots)):
                ways = [slots[i][pick] for i, pick in enumerate(picks)]
                branches = []
                for taken in itertools.product(*(range(len(each)) for each in ways)):
                    probability = 1.0
                    for i, way in enumerate(taken):
                        probability *= ways[i][way]
                    if probability > 0:
                        self._kernel.restore(*state)
                        if self._kernel.go(vector, list(picks), list(taken)) == FAULTY:
                            raise StateFaultError(Problem(0, *self._kernel.problem()))
                        branches.append(Branch(probability, self._state()))
                yield times, branches

    def reachable(self, limit: int) -> dict[State, int]:
        """All states with what is known of the goal there; beyond a decided one nothing is looked at.

        Raises:
            TooManyStatesError: there are more than `limit`.
        """
        found = {self.initial: self.verdict(self.initial)}
        waiting = deque(found)
        while waiting:
            state = waiting.popleft()
            if found[state] in (TRUE, FALSE):
                continue
            for branches in self.choices(state):
                for _, successor in branches:
                    if successor not in found:
                        if len(found) >= limit:
                            raise TooManyStatesError
                        found[successor] = self.verdict(successor)
                        waiting.append(successor)
        return found

    def _state(self) -> State:
        ints, reals = self._kernel.snapshot()
        place = tuple(self._kernel.location(i) for i in range(self._instances))
        return State(place, tuple(ints), tuple(reals))
