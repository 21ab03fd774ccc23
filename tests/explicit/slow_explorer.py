# SPDX-License-Identifier: Apache-2.0
"""All states of a model under a reaction time, by the definition (docs/spec/semantics.md#reaction-time).

The model itself assumes the reaction time `any`. Choices of the clock are left out here, one state after the other.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

from explorer import ExploredState
from roaml.durations import ReactionTime
from roaml.smc.kernel import Kernel
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE

Choice = list[tuple[float, "DelayedState"]]


class DelayedState(NamedTuple):
    """A state, and for each automaton how many steps of the clock it has waited with a possible step."""

    state: ExploredState
    waited: tuple[int, ...]


class SlowExplorer:
    """Explores a model with `Metadata.clock`, for its first property."""

    def __init__(self, checker: ModelChecker, time: ReactionTime) -> None:
        property_ = checker.compiled_properties[0]
        compiled = checker.compiled(property_)
        self.kernel = Kernel(compiled.program, compiled.goal)
        self.instances = compiled.program.instances
        legend, metadata = checker.legend, checker.model.metadata
        assert metadata is not None
        assert metadata.clock is not None
        names = list(checker.automata)
        clock = names.index(metadata.clock.automaton)
        self.begins: set[int] = set()
        self.owner: dict[int, int] = {}
        for vector, (slots, result) in enumerate(legend.vectors):
            parts = {legend.slots[slot].instance: legend.slots[slot].action for slot in slots}
            if clock in parts:
                if parts[clock] in metadata.clock.actions:
                    self.begins.add(vector)
                continue
            event = (result or "").removesuffix("_on_send").removesuffix("_on_receive")
            if (result or "").endswith("_on_receive") and event in names:
                self.owner[vector] = names.index(event)
            else:
                self.owner[vector] = min(i for i in parts if names[i] != event)
        self.time = time
        self.most = 0 if time.is_any or time.is_instant else time.steps(metadata.clock.step)
        self.kernel.begin(0, 0)
        self.initial = DelayedState(self._state(), (0,) * self.instances)

    def reachable(self, limit: int) -> dict[DelayedState, tuple[int, list[Choice]]] | None:
        """Each state with the verdict on the goal and its choices; `None` if there are more than `limit`."""
        found: dict[DelayedState, tuple[int, list[Choice]]] = {}
        waiting = [self.initial]
        known = {self.initial}
        while waiting:
            state = waiting.pop()
            self.kernel.restore(*state.state)
            verdict = self.kernel.look()
            choices = [] if verdict in (TRUE, FALSE) else self._choices(state)
            found[state] = verdict, choices
            for _, successor in itertools.chain.from_iterable(choices):
                if successor not in known:
                    known.add(successor)
                    waiting.append(successor)
            if len(known) > limit:
                return None
        return found

    def _choices(self, state: DelayedState) -> list[Choice]:
        self.kernel.restore(*state.state)
        vectors = self.kernel.choices()
        possible = {vector for vector, _, _ in vectors}
        held = self._is_held(state, possible)
        choices = []
        for vector, _, slots in vectors:
            if vector in self.begins and held:
                continue
            for picks in itertools.product(*(range(len(edges)) for edges in slots)):
                ways = [slots[i][pick] for i, pick in enumerate(picks)]
                choice: Choice = []
                for taken in itertools.product(*(range(len(way)) for way in ways)):
                    probability = 1.0
                    for i, way in enumerate(taken):
                        probability *= ways[i][way]
                    if probability > 0:
                        self.kernel.restore(*state.state)
                        self.kernel.go(vector, list(picks), list(taken))
                        choice.append((probability, self._after(state, vector, possible)))
                choices.append(choice)
        return choices

    def _is_held(self, state: DelayedState, possible: set[int]) -> bool:
        if self.time.is_any:
            return False
        if self.time.is_instant:
            return bool(possible - self.begins)
        return any(state.waited[self.owner[v]] >= self.most for v in possible if v in self.owner)

    def _after(self, before: DelayedState, taken: int, possible: set[int]) -> DelayedState:
        """The state of the kernel, with the counters after a step."""
        state = self._state()
        if not self.most:
            return DelayedState(state, before.waited)
        waited = list(before.waited)
        if taken in self.begins:
            for i in {self.owner[v] for v in possible if v in self.owner}:
                waited[i] += 1
        elif taken in self.owner:
            waited[self.owner[taken]] = 0
        self.kernel.restore(*state)
        able = {self.owner[v] for v, _, _ in self.kernel.choices() if v in self.owner}
        return DelayedState(state, tuple(n if i in able else 0 for i, n in enumerate(waited)))

    def _state(self) -> ExploredState:
        ints, reals = self.kernel.snapshot()
        place = tuple(self.kernel.location(i) for i in range(self.instances))
        return ExploredState(place, tuple(ints), tuple(reals))


def reach(states: dict[DelayedState, tuple[int, list[Choice]]], start: DelayedState, best: bool) -> float:
    """The greatest or the smallest probability to reach a state with the verdict TRUE, by value iteration from below.
    Undecided ends count as failures."""
    values = {state: 1.0 if verdict == TRUE else 0.0 for state, (verdict, _) in states.items()}
    extreme = max if best else min
    for _ in range(100_000):
        change = 0.0
        for state, (verdict, choices) in states.items():
            if verdict in (TRUE, FALSE) or not choices:
                continue
            value = extreme(sum(p * values[s] for p, s in choice) for choice in choices)
            change = max(change, abs(value - values[state]))
            values[state] = value
        if change < 1e-13:
            break
    return values[start]
