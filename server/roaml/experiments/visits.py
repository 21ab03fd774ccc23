# SPDX-License-Identifier: Apache-2.0
"""The expected numbers of visits of the states of a finite Markov chain.

The numbers λ of visits, λ = e + λ P, are computed component by component in topological order: λ is propagated along
the steps, and within a component until the rest is negligible. A chain is given by its steps: state -> its
destinations, each with a number that stands for the probability of the step. Destinations without an entry are left
out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

MAX_PASSES = 100_000
"""The number of passes through a component after which the solution is given up."""
_NEGLIGIBLE = 1e-13
"""The expected number of further visits that is neglected, relative to that of the component."""

Steps = Mapping[int, Sequence[tuple[int, int]]]


class SlowChainError(ValueError):
    """Raised if the equations of a chain converge too slowly."""


def expected_visits(steps: Steps, root: int, chance: Callable[[int], float]) -> dict[int, float]:
    """The expected number of visits of each state, before the chain is left for ever.

    Args:
        steps: the chain. From each state, a state without steps, or a destination without an entry, must be reachable.
        root: the initial state.
        chance: the number of a step -> its probability.

    Raises:
        SlowChainError: see there.
    """
    visits = dict.fromkeys(steps, 0.0)
    if root in visits:
        visits[root] = 1.0
    for component in reversed(list(_components(steps, root))):
        _settle(steps, component, visits, chance)
        inside = set(component)
        for state in component:
            for successor, number in steps[state]:
                if successor in visits and successor not in inside:
                    visits[successor] += visits[state] * chance(number)
    return visits


def _components(steps: Steps, root: int) -> Iterator[list[int]]:
    """The strongly connected components, in reverse topological order (Tarjan 1972, without recursion)."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    is_open: set[int] = set()
    work = [(root, 0)] if root in steps else []
    while work:
        state, place = work.pop()
        if place == 0:
            index[state] = low[state] = len(index)
            stack.append(state)
            is_open.add(state)
        successors = [successor for successor, _ in steps[state] if successor in steps]
        if place > 0:
            low[state] = min(low[state], low[successors[place - 1]])
        while place < len(successors):
            successor = successors[place]
            place += 1
            if successor not in index:
                work += [(state, place), (successor, 0)]
                break
            if successor in is_open:
                low[state] = min(low[state], index[successor])
        else:
            if low[state] == index[state]:
                component: list[int] = []
                while not component or component[-1] != state:
                    component.append(stack.pop())
                    is_open.discard(component[-1])
                yield component


def _settle(steps: Steps, component: Sequence[int], visits: dict[int, float], chance: Callable[[int], float]) -> None:
    """Replace the numbers of entries into a component by the expected numbers of visits of its states: the rest that
    has not been propagated is passed on along the steps until it is negligible."""
    inside = set(component)
    order = component[::-1]
    rest = {state: visits[state] for state in order}
    if not any(successor in inside for state in order for successor, _ in steps[state]):
        return
    total = dict.fromkeys(order, 0.0)
    for _ in range(MAX_PASSES):
        for state in order:
            amount = rest[state]
            if amount:
                rest[state] = 0.0
                total[state] += amount
                for successor, number in steps[state]:
                    if successor in inside:
                        rest[successor] += amount * chance(number)
        if sum(rest.values()) <= _NEGLIGIBLE * sum(total.values()):
            visits.update(total)
            return
    raise SlowChainError("the equations converge too slowly")
