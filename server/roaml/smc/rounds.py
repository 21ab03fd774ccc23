# SPDX-License-Identifier: Apache-2.0
"""Detects traces that can never be decided, because they have entered a part of the model without exit.

Under uniform choices, a trace that has entered a finite set of states that no choice leaves, and in which each state
can be reached from each other one, visits all of these states again and again with probability 1. If none of them
decides the goal, the goal is never decided: F is false, G is true, and the reward until a condition holds is infinite.

A long trace is examined at some of its steps (`limits`). If a copy of it comes back to its current state, all states
that can be reached from there are collected, up to a number that depends on the number of steps. So the verdict depends
only on the model and on the trace.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterable, Iterator, Mapping
from math import prod
from typing import TypeAlias

from roaml.record import Record
from roaml.smc.kernel import Kernel
from roaml.smc.program import UNKNOWN, Compiled

FIRST_CHECK = 10_000
"""The number of steps after which a trace is examined for the first time."""
STEPS_BETWEEN_CHECKS = 200_000
"""The maximum number of steps between two examinations; up to then, each doubles the number of steps."""
STEPS_PER_RETURN_STEP = 32
"""The number of steps of the trace for each step in which its copy may come back."""
STEPS_PER_STATE = 100
"""The number of steps of the trace for each state that is collected at most."""
MAX_SUCCESSORS = 1_000
"""The maximum number of combinations of edges and destinations in a state that is collected."""
MAX_EXCLUDED = 10_000
"""The number of states from which on no further ones are remembered as excluded."""
ALWAYS = sys.maxsize

State: TypeAlias = tuple[tuple[int, ...], tuple[int, ...], tuple[float, ...]]
"""The locations of the instances, and the values of the integer and real variables."""


def limits(most: int) -> Iterator[int]:
    """The numbers of steps after which a trace with at most `most` steps is examined, in ascending order."""
    limit = 0
    while limit < most:
        limit = next_limit(limit, most)
        yield limit


def next_limit(limit: int, most: int) -> int:
    """The first number after `limit` that `limits` yields."""
    return min(most, limit + min(limit, STEPS_BETWEEN_CHECKS) if limit else FIRST_CHECK)


class Recurrent(Record, frozen=True):
    """States that a trace never leaves, and all of which it visits again and again.

    Attributes:
        size: their number.
        decidable: for each until of the goal, whether it is decided in one of the states.
        lasting: for each until, whether its right side holds in all of them.
    """

    size: int
    decidable: tuple[bool, ...]
    lasting: tuple[bool, ...]


class Rounds:
    """Examines the traces of a model. The sets of states that it has found are kept for further traces.

    States that are in no such set are *excluded*: a number `n` means that they are in none of at most `n` states,
    `ALWAYS` that they are in none at all. A state is also excluded if an excluded one can be reached from it, because
    the states that can be reached from a state of a set are exactly those of the set.
    """

    def __init__(self, compiled: Compiled) -> None:
        self._compiled = compiled
        self._copy: Kernel | None = None
        self._known: dict[State, Recurrent] = {}
        self._excluded: dict[State, int] = {}

    def check(self, kernel: Kernel, seed: int, trace: int) -> int:
        """The status of the goal; UNKNOWN if it can still be decided, or if nothing is known.

        Args:
            kernel: in a state of the trace with this seed and number, in which the goal is not decided.
        """
        if self._copy is None:
            self._copy = Kernel(self._compiled.program, self._compiled.goal)
        steps = kernel.outcome()[0]
        most = steps // STEPS_PER_STATE
        state = _state_of(kernel, self._compiled.program.instances)
        if self._excluded.get(state, -1) >= most:
            return UNKNOWN
        self._copy.begin(seed, trace)
        self._copy.restore(*state)
        if not self._copy.returns(steps // STEPS_PER_RETURN_STEP):
            return UNKNOWN
        found = self._known.get(state) or self._collect(state, most)
        if found is None or found.size > most:
            return UNKNOWN
        return kernel.repeat(found.decidable, found.lasting)

    def _collect(self, start: State, most: int) -> Recurrent | None:
        """The states that can be reached from `start`; `None` if there are more than `most`, if `start` cannot be
        reached from all of them, or if a trace can end there."""
        kernel = self._copy
        assert kernel is not None
        conditions = []
        before: dict[State, list[State]] = {start: []}
        waiting = [start]
        while waiting:
            state = waiting.pop()
            limit = ALWAYS if state in self._known else self._excluded.get(state, -1)
            if limit >= most:
                self._exclude(_reaching(state, before) - {state}, limit)
                return None
            kernel.restore(*state)
            conditions.append(kernel.conditions())
            successors = self._successors(kernel, state)
            if not successors:
                self._exclude(_reaching(state, before), ALWAYS)
                return None
            for successor in successors:
                if successor not in before:
                    before[successor] = []
                    waiting.append(successor)
                before[successor].append(state)
            if len(before) > most:
                self._exclude(_reaching(start, before), most)
                return None
        reaching = _reaching(start, before)
        if len(reaching) < len(before):
            self._exclude(reaching, ALWAYS)
            return None
        found = Recurrent(
            len(before),
            tuple(any(not left or right for left, right in of_leaf) for of_leaf in zip(*conditions, strict=True)),
            tuple(all(right for _, right in of_leaf) for of_leaf in zip(*conditions, strict=True)),
        )
        self._known.update(dict.fromkeys(before, found))
        return found

    def _exclude(self, states: set[State], most: int) -> None:
        """Remember that the states are in no set of at most `most` states."""
        for state in states:
            if state in self._excluded or len(self._excluded) < MAX_EXCLUDED:
                self._excluded[state] = max(most, self._excluded.get(state, -1))

    def _successors(self, kernel: Kernel, state: State) -> set[State]:
        """The states to which a step can lead; none if a step has an error, or if there are too many."""
        instances = self._compiled.program.instances
        successors = set()
        choices = kernel.choices()
        if sum(prod(sum(map(len, edges)) for edges in slots) for _, _, slots in choices) > MAX_SUCCESSORS:
            return set()
        for vector, _, slots in choices:
            for picks in itertools.product(*(range(len(edges)) for edges in slots)):
                ways = [edges[pick] for edges, pick in zip(slots, picks, strict=True)]
                possible = ([way for way, chance in enumerate(chances) if chance > 0] for chances in ways)
                for chosen in itertools.product(*possible):
                    kernel.restore(*state)
                    if kernel.go(vector, list(picks), list(chosen)) != UNKNOWN:
                        return set()
                    successors.add(_state_of(kernel, instances))
        return successors


def _reaching(target: State, before: Mapping[State, Iterable[State]]) -> set[State]:
    """The states from which `target` can be reached, with `target`. `before`: the predecessors of each state."""
    reaching = {target}
    waiting = [target]
    while waiting:
        for state in before[waiting.pop()]:
            if state not in reaching:
                reaching.add(state)
                waiting.append(state)
    return reaching


def _state_of(kernel: Kernel, instances: int) -> State:
    ints, reals = kernel.snapshot()
    return tuple(kernel.location(i) for i in range(instances)), tuple(ints), tuple(reals)
