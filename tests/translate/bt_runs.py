# SPDX-License-Identifier: Apache-2.0
"""What the nodes of a translated tree do, read off its events.

A step of a node is the sending of one of its events; it is seen as the event becoming pending. All else that happens -
time, the blackboard, the order of what does not depend on one another - is left to `explore` and `plain`.
"""

from __future__ import annotations

import itertools
import random
import re

import explore
import plain
from bt_model import Status, Step

from roaml.jani.model import Model
from roaml.record import replace
from roaml.scxml.model import Network

_EVENT = re.compile(r"bt_(\d+)_(tick|response|halt|halt_response)")
_WORDS = {"tick": "tick", "halt": "halt", "halt_response": "halted"}


def step(event: str, status: int) -> Step | None:
    """The step of a node that `event` describes; `status` is that of a response."""
    match = _EVENT.fullmatch(event)
    if match is None:
        return None
    return int(match[1]), Status(status).name if match[2] == "response" else _WORDS[match[2]]


# ----------------------------------------------------------------- plain SCXML


def of_network(network: Network, seed: int, most: int | None = None) -> tuple[list[Step], plain.Moment]:
    """One run until nothing is left to do, or so many steps are made, and how it ends.

    `seed` decides what is done before what, where that is left open.
    """
    interpreter, chance = plain.Interpreter(network), random.Random(seed)
    now, steps = interpreter.initial(), list[Step]()
    while len(steps) != most:
        # To know all that may happen takes long; mostly there is one thing or two.
        following = list(itertools.islice(interpreter.successors(now), chance.choice((1, 1, 2, 3))))
        if not following:
            break
        after = following[-1]
        for event in after.pending - now.pending:
            following = step(event, dict(dict(after.sent)[event]).get("status", 0))
            if following is not None:
                steps.append(following)
        now = after
    return steps, now


def data_of(network: Network, now: plain.Moment, automaton: str) -> dict[str, object]:
    names = [a.name for a in network.automata]
    return dict(now.machines[names.index(automaton)].data)


# ------------------------------------------------------------------------ JANI


def of_model(model: Model, seed: int) -> list[Step]:
    """One run of the JANI model until nothing is left to do. `seed` decides what is done before what."""
    syncs = random.Random(seed).sample(model.system.syncs, len(model.system.syncs))
    watched = _Watched(replace(model, system=replace(model.system, syncs=tuple(syncs))))
    state, steps = watched.explorer.initial(), list[Step]()
    while (after := next(watched.explorer.successors(state), None)) is not None:
        steps += watched.steps(state, after)
        state = after
    return steps


def of_model_in_any_order(model: Model, expected: list[Step], limit: int) -> None:
    """By whatever order things happen, the steps are the expected ones, and all of them.

    Raises:
        AssertionError: they are not.
        OverflowError: there are more than `limit` states.
    """
    watched = _Watched(model)
    seen = {(watched.explorer.initial(), 0)}
    left = list(seen)
    while left:
        state, done = left.pop()
        following = list(watched.explorer.successors(state))
        assert following or done == len(expected), expected[done]
        for after in following:
            steps = watched.steps(state, after)
            assert steps == expected[done : done + len(steps)]
            follower = (after, done + len(steps))
            if follower not in seen:
                if len(seen) >= limit:
                    raise OverflowError
                seen.add(follower)
                left.append(follower)


class _Watched:
    def __init__(self, model: Model) -> None:
        self.explorer = explore.Explorer(model)
        self.events = [
            (i, automaton.name) for i, automaton in enumerate(model.automata) if _EVENT.fullmatch(automaton.name)
        ]

    def steps(self, before: explore.State, after: explore.State) -> list[Step]:
        sent = [
            event for i, event in self.events if before.locations[i] != "received" and after.locations[i] == "received"
        ]
        values = self.explorer.globals(after) if sent else {}
        return [
            following for event in sent if (following := step(event, values.get(f"{event}__status", 0))) is not None
        ]
