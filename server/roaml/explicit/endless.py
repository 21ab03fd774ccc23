# SPDX-License-Identifier: Apache-2.0
"""An endless trace in which a property is never decided. It consists of a path and of a cycle that is repeated. Such
traces are the reason why a minimum is 0 or a maximum is 1 although no trace shows that in finitely many steps."""

from __future__ import annotations

from collections import defaultdict

from roaml.explicit import codes
from roaml.explicit.path import EndlessTrace, Path, PathStep, path_to
from roaml.explicit.space import Space
from roaml.smc.goal import NOT
from roaml.smc.program import FALSE, TRUE, UNKNOWN

MAX_STATES = 50_000
"""The maximum number of states among which an endless trace is looked for. These take about 0.3 s."""


def endless(space: Space) -> EndlessTrace | None:
    """An endless trace that some scheduler can produce for certain, once the path is taken; `None` if there is none, if
    there are too many states, or if such a trace does not decide the goal.

    The states of these traces are the greatest set of undecided states each of which has a choice whose destinations
    are all in the set.
    """
    verdict = _verdict(space)
    if verdict is None or space.states > MAX_STATES:
        return None
    stays = _stays(space)
    state = min(stays, default=None)
    if state is None:
        return None
    root, steps = path_to(space, state)
    cycle: list[PathStep] = []
    begins: dict[int, int] = {}
    while state not in begins:
        begins[state] = len(cycle)
        following = stays[state]
        choices = space.search.steps_to(state, following)
        assert choices is not None
        cycle += (PathStep(*choice) for choice in choices)
        state = following
    begin = begins[state]
    path = Path(state, (*steps, *cycle[:begin]), verdict, is_end=False, root=space.roots.index(root))
    return EndlessTrace(path, tuple(cycle[begin:]))


def _verdict(space: Space) -> int | None:
    """The verdict on the goal for a trace that never decides it; `None` if that depends on more than the goal."""
    goal = space.compiled_property.goal
    question = space.compiled_property.question
    if question.is_reward or question.is_stuck or len(goal.left) != 1 or goal.lower[0] != 0 or goal.upper[0] >= 0:
        return None
    return TRUE if goal.formula.count(NOT) % 2 == 1 else FALSE


def _stays(space: Space) -> dict[int, int]:
    """Each state from which a scheduler can avoid a decision for ever, and a state that follows it then."""
    search = space.search
    choices: dict[int, list[list[int]]] = {}
    before: defaultdict[int, list[int]] = defaultdict(list)
    for state in range(search.expanded):
        label = search.label_of(state)
        if label & codes.STATUS != UNKNOWN or label & codes.ENDED:
            continue
        choices[state] = [[to for _, to in branches] for _, _, branches in search.choices_of(state)]
        for successors in choices[state]:
            for successor in successors:
                before[successor].append(state)
    leaving = [state for state, ways in choices.items() if not _lasting(ways, choices)]
    while leaving:
        gone = leaving.pop()
        if choices.pop(gone, None) is None:
            continue
        leaving += (state for state in before[gone] if state in choices and not _lasting(choices[state], choices))
    return {state: _lasting(ways, choices)[0] for state, ways in choices.items()}


def _lasting(ways: list[list[int]], choices: dict[int, list[list[int]]]) -> list[int]:
    """The successors of the first choice that stays among some states; empty if there is none."""
    return next((successors for successors in ways if all(state in choices for state in successors)), [])
