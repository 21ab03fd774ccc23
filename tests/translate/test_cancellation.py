# SPDX-License-Identifier: Apache-2.0
"""Clients cancel their goals (docs/spec/ros.md#cancel): Storm computes what must come out of it.

The systems are in `cancellation.txt`. The lines `VARIABLE = VALUE: LEAST GREATEST` below a title are the probabilities
over all schedulers that the variable ever has the value.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest
from storm import exact
from test_translate_storm import reaches, system
from translating import loaded, translated

from fixture import split_files
from roaml import api
from roaml.jani.typecheck import check_model
from roaml.scxml.names import is_synchronising, role_of

_TITLE = re.compile(r"^## (.+)\n", re.MULTILINE)
_, *_PARTS = _TITLE.split((Path(__file__).parent / "cancellation.txt").read_text(encoding="utf-8"))
_SYSTEMS = dict(zip(_PARTS[::2], _PARTS[1::2], strict=True))
_VALUE = re.compile(r"(\w+) = (\d+): (\S+) (\S+)")
QUESTIONS = [
    pytest.param(text, *value, id=f"{title}: {value[0]} = {value[1]}")
    for title, text in _SYSTEMS.items()
    for value in _VALUE.findall(text)
]


SPEC = Path(__file__).resolve().parents[2] / "docs" / "spec" / "ros.md"


def files_of(title: str, properties: str) -> dict[str, str]:
    text = _SYSTEMS[title]
    return system(*split_files(text[text.index("-- ") :]).values(), properties=properties)


@pytest.mark.parametrize(("text", "variable", "value", "least", "greatest"), QUESTIONS)
def test_probability(text: str, variable: str, value: str, least: str, greatest: str) -> None:
    machines = split_files(text[text.index("-- ") :]).values()
    model = translated(system(*machines, properties=reaches(variable, int(value))))
    assert check_model(model) == ()
    answer = exact(model, "p")
    assert (answer.least, answer.greatest) == pytest.approx((float(Fraction(least)), float(Fraction(greatest))))


@pytest.mark.parametrize("title", _SYSTEMS)
def test_names(title: str) -> None:
    """Properties may use the variables of requests, and the name of a request says that it does not wait."""
    model = loaded(files_of(title, '{"properties": []}'))
    names = {variable.name for variable in api.to_jani(model).variables}
    assert set(model.analysis.globals(model.path)) == names
    requests = [name.removesuffix(".valid") for name in names if re.fullmatch(r"cancel_action_\w+\.valid", name)]
    assert len(requests) == 1
    assert not is_synchronising(requests[0])
    sent = {
        event
        for automaton in api.to_scxml(model).automata
        for state in automaton.states
        for transition in state.transitions
        if (event := transition.event) and event.name in requests
    }
    assert [event.role for event in sent] == [role_of(requests[0])]


TREE = {
    "tree.xml": """<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main">
        <ReactiveSequence><Condition ID="Charged" /><Action ID="Navigate" /></ReactiveSequence>
    </BehaviorTree>
</root>""",
    "charged.ascxml": """<ascxml name="Charged" version="1.0" initial="idle">
    <state id="idle">
        <bt_tick>
            <target id="idle" prob="0.75"><bt_return_status status="SUCCESS" /></target>
            <target id="idle"><bt_return_status status="FAILURE" /></target>
        </bt_tick>
        <bt_halt target="idle"><bt_return_halted /></bt_halt>
    </state>
</ascxml>""",
    "server.ascxml": """<ascxml name="Navigator" version="1.0" initial="ready">
    <datamodel><data id="goal" type="int32" expr="0" /></datamodel>
    <ros_action_server name="navigate" action_name="/navigate" type="example_interfaces/Fibonacci" />
    <state id="ready">
        <ros_action_handle_goal name="navigate" target="driving">
            <assign location="goal" expr="_action.goal_id" />
            <ros_action_accept_goal name="navigate" goal_id="goal" />
        </ros_action_handle_goal>
    </state>
    <state id="driving">
        <ros_action_handle_cancel_goal name="navigate" target="ready">
            <ros_action_canceled name="navigate" goal_id="goal" />
        </ros_action_handle_cancel_goal>
    </state>
</ascxml>""",
    "main.xml": """<roaml>
    <parameters><max_time value="3" unit="s" /><bt_tick_rate value="1.0" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="navigate.ascxml" />
        <input type="bt-plugin-ascxml" src="charged.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="server.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>""",
}


def test_a_node_cancels_its_goal_when_it_is_halted() -> None:
    """The node of the definition: it is started with 0.75 and halted if one of the next two ticks finds the battery
    empty."""
    shown = re.search(r"\*\*`navigate\.ascxml`\*\*\n\n```xml\n(.*?)```", SPEC.read_text(encoding="utf-8"), re.DOTALL)
    assert shown is not None
    files = {**TREE, "navigate.ascxml": shown[1], "properties.jani": reaches("action_navigate_result__code", 5)}
    answer = exact(translated(files), "p")
    assert (answer.least, answer.greatest) == pytest.approx((21 / 64, 21 / 64))
