# SPDX-License-Identifier: Apache-2.0
"""The minimum and the maximum probability of a goal over all schedulers, from all states of a model, if there are few.

- Every value is enclosed from below and above: from below by value iteration, from above by Park induction, as in
  optimistic value iteration (Hartmanns and Kaminski 2020). Values that no step increases are upper bounds. Strongly
  connected components are solved in reverse topological order, so that most need one iteration.
- Goals of one path operator without step bounds are solved. For all others, only the existence of choices is
  determined.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TypeAlias

from roaml.smc.explore import NO_REGISTERS, ExploredState, Explorer, Registers, StateFaultError, TooManyChoicesError
from roaml.smc.goal import NOT, STUCK
from roaml.smc.program import AT_END, FALSE, TRUE, Compiled
from roaml.smc.statistics import Bounds

MAX_EXPLORED_STATES = 4000
"""The maximum number of explored states."""
MAX_WORK = 400_000
"""The maximum number of values, counted over all states and choices."""
_MAX_BOUNDS_DISTANCE = 1e-6
_MIN_CHANGE = 1e-13
_MAX_UPDATES = 1_000_000
"""The maximum number of additions for a component. After that, its bounds stay as wide as they are."""

_Choice: TypeAlias = tuple[tuple[float, int], ...]
"""The destinations of a choice: pairs of a probability and the number of a state."""


@dataclass(frozen=True, slots=True)
class Solution:
    """The result of the exploration.

    Attributes:
        minimum, maximum: enclose the least and the greatest probability; `None` if the goal cannot be solved.
        states: the number of states.
        has_choices: whether some state has choices with different effects.
    """

    minimum: Bounds | None
    maximum: Bounds | None
    states: int
    has_choices: bool

    @property
    def agrees(self) -> bool:
        """Whether the probability is the same for all schedulers."""
        if not self.has_choices:
            return True
        return (
            self.minimum is not None
            and self.maximum is not None
            and self.maximum.upper - self.minimum.lower <= _MAX_BOUNDS_DISTANCE
        )


def solve(
    compiled: Compiled, limit: int = MAX_EXPLORED_STATES, work: int = MAX_WORK, ignored: Registers = NO_REGISTERS
) -> Solution | None:
    """Explore all states.

    Args:
        limit: the maximum number of states.
        ignored: see `Explorer`.
        work: the maximum number of values, counted over all states and choices.

    Returns:
        `None` if a limit is exceeded, or a choice executes an undefined operation.
    """
    goal = compiled.goal
    is_reward = goal.step_reward >= 0 or goal.exit_reward >= 0
    is_until = len(goal.left) == 1 and goal.right[0] != STUCK and goal.lower[0] != AT_END
    is_solvable = is_until and not goal.is_bounded and not is_reward
    try:
        graph = _explored(compiled, limit, work, is_solvable, ignored)
    except (StateFaultError, TooManyChoicesError):
        return None
    if graph is None:
        return None
    verdicts, choices = graph
    has_choices = any(len(set(options)) > 1 for options in choices)
    if not is_solvable:
        return Solution(None, None, len(verdicts), has_choices)
    is_negated = goal.formula.count(NOT) % 2 == 1
    target = FALSE if is_negated else TRUE
    low, high = (_solved(verdicts, choices, target, is_max) for is_max in (False, True))
    if is_negated:
        low, high = Bounds(1 - high.upper, 1 - high.lower), Bounds(1 - low.upper, 1 - low.lower)
    return Solution(low, high, len(verdicts), has_choices)


def _explored(
    compiled: Compiled, limit: int, work: int, stops: bool, ignored: Registers
) -> tuple[list[int], list[tuple[_Choice, ...]]] | None:
    """The verdict on the goal in each state, and the choices of each state; `None` if a limit is exceeded.

    Args:
        stops: whether states after one in which the goal is decided are irrelevant.
    """
    size = compiled.program.int_count + compiled.program.real_count + compiled.program.instances
    size -= len(ignored.ints) + len(ignored.reals)
    explorer = Explorer(compiled, work // max(1, size), ignored)
    number: dict[ExploredState, int] = {explorer.initial: 0}
    verdicts = [explorer.verdict(explorer.initial)]
    choices: list[tuple[_Choice, ...]] = []
    waiting = deque(number)
    while waiting:
        state = waiting.popleft()
        if stops and verdicts[len(choices)] in (TRUE, FALSE):
            choices.append(())
            continue
        different: dict[_Choice, None] = {}
        for _, branches in explorer.choices(state):
            work -= size * (1 + len(branches))
            if work < 0:
                return None
            reached: dict[int, float] = {}
            for probability, successor in branches:
                if successor not in number:
                    if len(number) >= limit:
                        return None
                    number[successor] = len(verdicts)
                    verdicts.append(explorer.verdict(successor))
                    waiting.append(successor)
                to = number[successor]
                reached[to] = reached.get(to, 0.0) + probability
            different[tuple((probability, to) for to, probability in sorted(reached.items()))] = None
        choices.append(tuple(different))
    return verdicts, choices


def _solved(verdicts: list[int], choices: list[tuple[_Choice, ...]], target: int, is_max: bool) -> Bounds:
    """The minimum or maximum probability to reach a state with the verdict `target`, from state 0."""
    low = [1.0 if verdict == target else 0.0 for verdict in verdicts]
    high = list(low)
    best = max if is_max else min
    for component in _components(choices):
        if len(component) == 1 and not any(to == component[0] for c in choices[component[0]] for _, to in c):
            (state,) = component
            if choices[state]:
                low[state] = best(_mean(choice, low) for choice in choices[state])
                high[state] = best(_mean(choice, high) for choice in choices[state])
            continue
        inner = [state for state in component if choices[state]]
        for _ in range(_MAX_UPDATES // (1 + sum(len(choice) for state in inner for choice in choices[state]))):
            change = 0.0
            for state in inner:
                value = best(_mean(choice, low) for choice in choices[state])
                change = max(change, value - low[state])
                low[state] = max(low[state], value)
            if change <= _MIN_CHANGE:
                break
        _enclose(inner, choices, low, high, is_max)
    return Bounds(low[0], high[0])


def _enclose(
    states: list[int], choices: list[tuple[_Choice, ...]], low: list[float], high: list[float], is_max: bool
) -> None:
    """Compute upper bounds for the states of a component, from the bounds of the components after it."""
    best = max if is_max else min
    slack = 1e-10
    while slack < _MAX_BOUNDS_DISTANCE:
        for state in states:
            high[state] = min(1.0, low[state] + slack)
        for _ in range(100):
            rises = False
            after = [best(_mean(choice, high) for choice in choices[state]) for state in states]
            for state, value in zip(states, after, strict=True):
                rises = rises or value > high[state] + _MIN_CHANGE
            for state, value in zip(states, after, strict=True):
                high[state] = min(1.0, value)
            if not rises:
                return
        slack *= 10
    for state in states:
        high[state] = 1.0


def _mean(choice: _Choice, values: list[float]) -> float:
    return sum(probability * values[to] for probability, to in choice)


def _components(choices: list[tuple[_Choice, ...]]) -> list[list[int]]:
    """The strongly connected components. Each comes after the components that can be reached from it (Tarjan 1972,
    without recursion)."""
    index = [-1] * len(choices)
    lowest = [0] * len(choices)
    open_ = [False] * len(choices)
    path: list[int] = []
    components: list[list[int]] = []
    count = 0
    for root in range(len(choices)):
        if index[root] >= 0:
            continue
        work = [(root, iter([to for choice in choices[root] for _, to in choice]))]
        index[root] = lowest[root] = count
        count += 1
        path.append(root)
        open_[root] = True
        while work:
            state, rest = work[-1]
            for to in rest:
                if index[to] < 0:
                    index[to] = lowest[to] = count
                    count += 1
                    path.append(to)
                    open_[to] = True
                    work.append((to, iter([target for choice in choices[to] for _, target in choice])))
                    break
                if open_[to]:
                    lowest[state] = min(lowest[state], index[to])
            else:
                work.pop()
                if work:
                    before = work[-1][0]
                    lowest[before] = min(lowest[before], lowest[state])
                if lowest[state] == index[state]:
                    component = []
                    while True:
                        last = path.pop()
                        open_[last] = False
                        component.append(last)
                        if last == state:
                            break
                    components.append(component)
    return components
