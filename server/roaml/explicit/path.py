# SPDX-License-Identifier: Apache-2.0
"""A trace to a state: the shortest one if the search has left nothing out. `path_recorder` records it."""

from __future__ import annotations

from typing import NamedTuple

from roaml.explicit import codes
from roaml.explicit.space import Space
from roaml.record import Record
from roaml.smc.goal import NOT
from roaml.smc.program import AT_END, FALSE, TRUE, UNKNOWN


class PathStep(NamedTuple):
    """A step.

    Attributes:
        vector: the number of the synchronisation vector.
        edges: for each slot of the vector that has an effect, the number of its edge among the enabled edges.
        ways: for each of these slots, the number of the destination of the edge.
    """

    vector: int
    edges: list[int]
    ways: list[int]


class Path(Record, frozen=True):
    """The steps to a state, and the verdict on the goal for a trace with these steps.

    Attributes:
        state: the number of the state in which the path ends.
        is_end: whether a trace ends at the end of the path without a decision.
        root: the number of the initial state in which the path begins.
    """

    state: int
    steps: tuple[PathStep, ...]
    verdict: int
    is_end: bool
    root: int = 0


class EndlessTrace(Record, frozen=True):
    """An endless trace.

    Attributes:
        path: the steps to the cycle, with the verdict on the goal for the endless trace.
        cycle: the steps that are repeated.
    """

    path: Path
    cycle: tuple[PathStep, ...]


def shortest(space: Space, verdict: int) -> Path | None:
    """The shortest trace with the given verdict on the goal; `None` if no trace has this verdict after finitely many
    steps. If the space is reduced, a shorter trace may exist that contains choices which were left out. If the goal has
    bounds on the steps, `None` also means that the path of the search to the first such state is no example."""
    state = _first(space, verdict)
    if state is None or not _is_example(space, state, verdict):
        return None
    first, steps = path_to(space, state)
    label = space.search.label_of(state)
    is_end = bool(label & codes.ENDED) and label & codes.STATUS == UNKNOWN
    return Path(state, tuple(steps), verdict, is_end, space.roots.index(first))


def _is_example(space: Space, state: int, verdict: int) -> bool:
    """Whether the bounds on the steps of the goal permit its verdict after the path of the search to a state. The
    states do not count steps, so their labels are without these bounds."""
    goal = space.compiled_property.goal
    if len(goal.left) != 1 or goal.lower[0] == AT_END:
        return True
    lower, upper = goal.lower[0], goal.upper[0]
    path = _states_to(space, state)
    last = len(path) - 1
    if (verdict == TRUE) is not (goal.formula.count(NOT) % 2 == 1):
        return lower <= last and (upper < 0 or last <= upper)
    # Without a lower bound, the search ends where the right side holds.
    end = last if upper < 0 else upper
    return lower == 0 or not any(space.search.label_of(place) & codes.HOLDS for place in path[lower : end + 1])


def _states_to(space: Space, state: int) -> list[int]:
    """The states of the path of the search to a state."""
    states = [state]
    while (state := space.search.parent_of(state)) >= 0:
        states.append(state)
    return states[::-1]


def path_to(space: Space, state: int) -> tuple[int, list[PathStep]]:
    """The initial state and the steps of a path to a state, which is a shortest one if the space is not reduced."""
    search = space.search
    steps: list[PathStep] = []
    while (parent := search.parent_of(state)) >= 0:
        choices = search.steps_to(parent, state)
        assert choices is not None
        steps += (PathStep(*choice) for choice in reversed(choices))
        state = parent
    return state, steps[::-1]


def _first(space: Space, verdict: int) -> int | None:
    """The first state in which the goal is decided, or a trace ends, with this verdict; `None` if there is none."""
    labels = bytes(memoryview(space.search.label)[: space.search.expanded])
    is_stuck = space.compiled_property.question.is_stuck
    matching = bytes(label for label in range(256) if _verdict(label, is_stuck) == verdict)
    places = (labels.find(label) for label in matching)
    return min((place for place in places if place >= 0), default=None)


def _verdict(label: int, is_stuck: bool) -> int:
    status = label & codes.STATUS
    if status in (FALSE, TRUE) or not label & codes.ENDED:
        return status
    if is_stuck:
        return TRUE if label & codes.GETS_STUCK else FALSE
    if label & codes.OPEN:
        return UNKNOWN
    return TRUE if label & (codes.LASTS if label & codes.HOLDS else codes.FAILS) else FALSE
