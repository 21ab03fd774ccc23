# SPDX-License-Identifier: Apache-2.0
"""Searches with and without reductions have the same answers on networks in which messages are sent while timers and a
clock wait for empty buffers, under all kinds of reaction times."""

from __future__ import annotations

from clocked_networks import STEP, is_local
from compared_spaces import both, check, is_smaller
from hypothesis import given, settings
from messaging_networks import MARKS, messaging
from slow_explorer import SlowExplorer

from examples import examples
from roaml.durations import ANY_TIME, AT_ONCE, ReactionTime
from roaml.explicit.space import LimitError, StateLimits
from roaml.jani.model import Model
from roaml.jani.reaction import reacting
from roaml.smc.model import ModelChecker

LIMITS = StateLimits(states=3_000)
TIMES = [ANY_TIME, AT_ONCE, ReactionTime(STEP)]


def races(model: Model) -> bool | None:
    """Whether a message and a tick that waits for its buffer are possible in the same state; `None` if there are too
    many states."""
    checker = ModelChecker(model)
    explorer = SlowExplorer(checker, ANY_TIME)
    states = explorer.reachable(LIMITS.states)
    if states is None:
        return None
    names = list(checker.automata)
    parts = [
        {(names[checker.legend.slots[slot].instance], checker.legend.slots[slot].action) for slot in slots}
        for slots, _ in checker.legend.vectors
    ]
    for state in states:
        explorer.kernel.restore(*state.state)
        possible = set().union(*(parts[vector] for vector, _, _ in explorer.kernel.choices()))
        if any(action == f"{name}_on_send" and (name, "calm") in possible for name, action in possible):
            return True
    return False


def test_reductions_keep_the_answers() -> None:
    found: list[bool] = []
    smaller: list[bool] = []

    @given(messaging())
    @settings(max_examples=examples(100), deadline=None)
    def run(model: Model) -> None:
        for time in TIMES if is_local(model) else TIMES[:2]:
            checker = ModelChecker(reacting(model, time), marks=MARKS, includes_stuck=True)
            for property_ in checker.compiled_properties:
                try:
                    spaces = both(checker, property_, limits=LIMITS)
                except LimitError:
                    continue
                if spaces is not None:
                    check(*spaces)
                    smaller.append(is_smaller(*spaces))
        has_race = races(model)
        if has_race is not None:
            found.append(has_race)

    run()
    assert len(found) > examples(100) * 0.9
    assert sum(found) > len(found) / 2
    assert sum(smaller) > len(smaller) / 2
