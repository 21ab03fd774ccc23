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


SHOP_SYSTEM = """
<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="shop.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
SHOP = """
<ascxml name="Shop" version="1.0" initial="open">
    <datamodel>
        <data id="part" type="int32" expr="4" />
        <data id="stock" type="int32[4]" expr="[9, 9, 9, 9]" />
    </datamodel>
    <state id="open">
        <transition cond="part &gt; 3" target="refused" />
        <transition cond="stock[part] &lt; 3" target="sold_out" />
        <transition target="sold" />
    </state>
    <state id="refused">
        <onentry>
            <if cond="part &gt; 3"><assign location="part" expr="5" /><elseif cond="stock[part] &lt; 3" />
            <assign location="part" expr="6" /></if>
        </onentry>
    </state>
    <state id="sold_out" />
    <state id="sold" />
</ascxml>
"""


def test_conditions_after_one_that_holds_are_not_evaluated() -> None:
    """Those after `part > 3` would read an element outside of the array."""
    files = {"main.xml": SHOP_SYSTEM, "shop.ascxml": SHOP, "properties.jani": '{"properties": []}'}
    explorer = explore.Explorer(translate(lowered(files)))
    reached = {(state.locations[0], explorer.locals(state, 0)["part"]) for state in explorer.reachable(LIMIT)}
    assert ("refused", 5) in reached
    assert {place for place, _ in reached}.isdisjoint({"sold", "sold_out"})
