# SPDX-License-Identifier: Apache-2.0
"""The expected reward among the traces that reach the condition of the reward, under uniform choices.

With h(s), the probability that the condition is reached from the state s, it is the sum of all rewards of steps from s
to t, weighted with the expected number of these steps and with h(t), divided by h of the initial state. The sums are
solved by elimination (`chain`), once with the lower and once with the upper bounds of h, so both bounds are certain.

The search stores the expected reward of each choice, not that of each destination. The rewards of the destinations are
known if they are equal, 0 or 1, or earned only where the condition is reached; otherwise, there is no value.
"""

from __future__ import annotations

import enum
from collections.abc import Collection, Sequence
from typing import Any

from roaml.explicit import codes, solver
from roaml.explicit.chain import Chain
from roaml.explicit.space import Space
from roaml.explicit.values import MEAN, NOTHING
from roaml.jani.expressions import Conditional, Integer, Name
from roaml.jani.properties import Expectation, Property, identifiers, walk
from roaml.record import Record
from roaml.smc.program import TRUE, UNKNOWN
from roaml.smc.statistics import Bounds

MAX_STATES = 200_000
"""The maximum number of states; the equations are set up in Python, which takes some µs for each."""
_ROUNDING = 1e-9
"""The difference up to which an expected reward is 0 or 1."""


class RewardKind(enum.Enum):
    """What is known about the rewards of the destinations of a choice."""

    EQUAL = "equal"
    BINARY = "0 or 1"
    AT_END = "earned only where the condition is reached"
    OTHER = "unknown"


class ReachedReward(Record, frozen=True):
    """The expected reward among the traces that reach the condition, enclosed by bounds.

    Attributes:
        share: the bounds of the probability to reach the condition.
        is_deterministic: whether no state has several choices, so that the value is that of all schedulers.
    """

    value: Bounds
    share: Bounds
    is_deterministic: bool


def reached_reward(space: Space, counters: Collection[str]) -> ReachedReward | None:
    """The value of the reward of `space`; `None` if its states do not determine it.

    Args:
        space: all states; nothing may be left out.
        counters: the names of the transient variables that are 0 or 1.
    """
    if space.is_reduced or len(space.roots) != 1 or space.states > MAX_STATES or space.problem is not None:
        return None
    own: Any = solver.Solver(space.search, MEAN)
    own.probability(TRUE, 0, NOTHING)
    low, high = (list(part[: space.states]) for part in (own.low, own.high))
    root = space.roots[0]
    if own.has_ended_early or low[root] <= 0.0:
        return None
    system = _System(space, kind_of(space.compiled_property.property, counters), low, high)
    ends = [system.solved(chances) for chances in (low, high)]
    if ends[0] is None or ends[1] is None:
        return None
    share = Bounds(low[root], high[root])
    value = Bounds(ends[0].lower / share.upper, ends[1].upper / share.lower)
    return ReachedReward(value, share, system.is_deterministic)


def kind_of(property_: Property, counters: Collection[str]) -> RewardKind:
    """What is known about the reward of a property. `counters` are as for `reached_reward`."""
    formula = next((part for part in walk(property_.expression) if isinstance(part, Expectation)), None)
    assert formula is not None
    match formula.reward:
        case Conditional(test=test, otherwise=Integer(value=0)) if test == formula.reach:
            return RewardKind.AT_END
        case Name(identifier=name) if name in counters:
            return RewardKind.BINARY
        case reward if not list(identifiers(reward)):
            return RewardKind.EQUAL
    return RewardKind.OTHER


class _System:
    """The equations of the states from which the condition can be reached and is not reached yet."""

    def __init__(self, space: Space, kind: RewardKind, low: Sequence[float], high: Sequence[float]) -> None:
        self.search = space.search
        self.kind = kind
        self.root = space.roots[0]
        labels = bytes(memoryview(self.search.label)[: space.states])
        states = [s for s in range(space.states) if labels[s] & codes.STATUS == UNKNOWN and high[s] > 0.0]
        self.is_solvable = all(low[state] > 0.0 for state in states)
        self.place = {state: number for number, state in enumerate(states)}
        self.choices = {state: self.search.choices_of(state) for state in states}
        self.is_deterministic = all(len(choices) <= 1 for choices in self.choices.values())

    def solved(self, reached: Sequence[float]) -> Bounds | None:
        """The bounds of the weighted sum of all rewards.

        Args:
            reached: the probability that the condition is reached, for each state.
        """
        if self.root not in self.place:
            return Bounds(0.0, 0.0)
        chain = Chain(len(self.place))
        for state, number in self.place.items():
            choices = self.choices[state]
            total = sum(weight for weight, _, _ in choices)
            leaves = gain = 0.0
            for weight, reward, branches in choices:
                earned = self._earned(reward, branches, reached)
                if earned is None or earned < 0.0:
                    return None
                gain += weight / total * earned
                for chance, successor in branches:
                    if successor in self.place:
                        chain.add(number, self.place[successor], weight / total * chance)
                    else:
                        leaves += weight / total * chance
            chain.leaves[number] = leaves
            chain.gain[number] = gain
        error = chain.solve() if self.is_solvable else -1.0
        if error < 0.0:
            return None
        value = chain.values[self.place[self.root]]
        return Bounds(value * (1 - error), value * (1 + error))

    def _earned(self, reward: float, branches: Sequence[tuple[float, int]], reached: Sequence[float]) -> float | None:
        """The expected reward of a choice, weighted with the probability that the condition is reached afterwards;
        `None` if it is not known."""
        chances = {reached[successor] for _, successor in branches}
        if len(chances) == 1:
            return reward * chances.pop()
        mean = sum(chance * reached[successor] for chance, successor in branches)
        match self.kind:
            case RewardKind.EQUAL:
                return reward * mean
            case RewardKind.AT_END:
                return reward
            case RewardKind.BINARY if abs(reward) <= _ROUNDING or abs(reward - 1) <= _ROUNDING:
                return round(reward) * mean
        return None
