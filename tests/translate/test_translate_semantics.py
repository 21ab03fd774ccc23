# SPDX-License-Identifier: Apache-2.0
"""The translation says what plain SCXML means: both reach the same outcomes, by any interleaving."""

from __future__ import annotations

from typing import Any

import explore
import plain
from hypothesis import HealthCheck, assume, given, settings
from systems import systems
from translating import lowered

from examples import examples
from roaml import api
from roaml.scxml.model import Network
from roaml.to_jani import translate

LIMIT = 1500


def outcome(states: list[str], data: list[dict[str, Any]], sent: dict[str, Any], pending: set[str]) -> Any:
    """What can be told of a moment in both worlds; "" stands for a machine between two states."""
    return (
        tuple(states),
        tuple(tuple(sorted(values.items())) for values in data),
        tuple(sorted(sent.items())),
        frozenset(pending),
    )


def of_interpreter(network: Network, now: plain.Moment) -> Any:
    states = [machine.state if not machine.rest else "" for machine in now.machines]
    sent = {f"{event}__{name}": value for event, params in now.sent for name, value in params} | {
        f"{event}.valid": True for event, _ in now.sent
    }
    return outcome(states, [dict(machine.data) for machine in now.machines], sent, set(now.pending))


def of_model(explorer: explore.Explorer, network: Network, state: explore.State) -> Any:
    count = len(network.automata)
    states = [
        place if place in {s.id for s in automaton.states} else ""
        for place, automaton in zip(state.locations, network.automata, strict=False)
    ]
    data = [visible(explorer.locals(state, i)) for i in range(count)]
    values = visible(explorer.globals(state))
    sent = {name: value for name, value in values.items() if values[f"{event_of(name)}.valid"]}
    events = [automaton.name for automaton in explorer.model.automata[count:]]
    pending = {event for event, place in zip(events, state.locations[count:], strict=True) if place == "received"}
    return outcome(states, data, sent, pending)


def event_of(variable: str) -> str:
    return variable.removesuffix(".valid") if variable.endswith(".valid") else variable.partition("__")[0]


def visible(variables: dict[str, Any]) -> dict[str, Any]:
    """Arrays up to their lengths, and no lengths."""
    return {
        name: value[: variables[f"{name}.d1_len"]] if isinstance(value, tuple) else value
        for name, value in variables.items()
        if not name.endswith("_len")
    }


@settings(max_examples=examples(60), suppress_health_check=list(HealthCheck))
@given(systems())
def test_same_outcomes(files: dict[str, str]) -> None:
    try:
        network = lowered(files)
    except api.ModelError:
        assume(False)
    explorer = explore.Explorer(translate(network))
    try:
        moments = plain.Interpreter(network).reachable(LIMIT)
        states = explorer.reachable(LIMIT)
    except OverflowError:
        assume(False)
    assert {of_interpreter(network, now) for now in moments} == {of_model(explorer, network, s) for s in states}
