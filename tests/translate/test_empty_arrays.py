# SPDX-License-Identifier: Apache-2.0
"""Arrays of which only `[]` is sent, which does not show the type of their elements."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from explore import Explorer
from translating import errors, loaded

from roaml import api
from roaml.jani.typecheck import check_model

MAIN = """\
<roaml>
    <parameters><max_time value="1" unit="s" /><max_array_size value="3" /></parameters>
    <node_models>
        <input type="node-ascxml" src="from.ascxml" />
        <input type="node-ascxml" src="to.ascxml" />
    </node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""
FROM = """\
<ascxml name="From" version="1.0" initial="first">
    {declaration}
    <state id="first"><transition target="{second}">{send}</transition></state>
    {more}
    <state id="last" />
</ascxml>
"""
TO = """\
<ascxml name="To" version="1.0" initial="first">
    <datamodel>
        <data id="list" type="{type}[2]" expr="[{zero}]" />
        <data id="one" type="{type}" expr="{zero}" />
    </datamodel>
    {declaration}
    <state id="first">{handler}</state>
    <state id="last" />
</ascxml>
"""
USES = {
    "assigned": ("true", '<assign location="list" expr="{data}" />'),
    "compared": ("{data} != list", ""),
    "guarded": ("!({data}.length &gt; 0 &amp;&amp; {data}[0] == {one})", ""),
    "element": ("true", '<if cond="{data}.length &gt; 0"><assign location="one" expr="{data}[0]" /></if>'),
    "sent on": ("true", '<send event="again"><param name="data" expr="{data}" /></send>'),
}
ZEROS = {"string": "''", "bool": "false", "float64": "0.0", "int32": "0", "int32[1]": "[]"}


def _topic(use: str, type_: str, interface: str, field: str) -> dict[str, str]:
    cond, body = (text.format(data=f"_msg.{field}", one=ZEROS[type_]) for text in USES[use])
    declared = f'name="t" topic="t" type="{interface}" />'
    publish = f'<ros_topic_publish name="t"><field name="{field}" expr="[]" /></ros_topic_publish>'
    return {
        "from.ascxml": FROM.format(
            declaration=f"<ros_topic_publisher {declared}", second="last", send=publish, more=""
        ),
        "to.ascxml": TO.format(
            type=type_,
            zero=ZEROS[type_],
            declaration=f"<ros_topic_subscriber {declared}",
            handler=f'<ros_topic_callback name="t" cond="{cond}" target="last">{body}<send event="ok" />'
            "</ros_topic_callback>",
        ),
    }


def _service(use: str, type_: str, interface: str, field: str) -> dict[str, str]:
    cond, body = (text.format(data=f"_req.{field}", one=ZEROS[type_]) for text in USES[use])
    declared = f'name="s" service_name="s" type="{interface}" />'
    return {
        "from.ascxml": FROM.format(
            declaration=f"<ros_service_client {declared}",
            second="waiting",
            send=f'<ros_service_send_request name="s"><field name="{field}" expr="[]" /></ros_service_send_request>',
            more='<state id="waiting"><ros_service_handle_response name="s" target="last" /></state>',
        ),
        "to.ascxml": TO.format(
            type=type_,
            zero=ZEROS[type_],
            declaration=f"<ros_service_server {declared}",
            handler=f'<ros_service_handle_request name="s" cond="{cond}" target="last">{body}<send event="ok" />'
            '<ros_service_send_response name="s"><field name="types" expr="[]" /></ros_service_send_response>'
            "</ros_service_handle_request>",
        ),
    }


def _event(use: str, type_: str, _interface: str, _field: str) -> dict[str, str]:
    cond, body = (text.format(data="_event.data.list", one=ZEROS[type_]) for text in USES[use])
    send = '<send event="e"><param name="list" expr="[]" /></send>'
    handler = f'<transition event="e" cond="{cond}" target="last">{body}<send event="ok" /></transition>'
    return {
        "from.ascxml": FROM.format(declaration="", second="last", send=send, more=""),
        "to.ascxml": TO.format(type=type_, zero=ZEROS[type_], declaration="", handler=handler),
    }


SENT = [
    *((use, _topic, "string", "rcl_interfaces/ListParametersResult", "names") for use in USES),
    *((use, _service, "string", "rcl_interfaces/GetParameterTypes", "names") for use in USES),
    *((use, _event, type_, "", "") for use in ("assigned", "compared", "sent on") for type_ in ZEROS),
]


def _files(sent: dict[str, str]) -> dict[str, str]:
    return {"main.xml": MAIN, "properties.jani": '{"properties": []}', **sent}


@pytest.mark.parametrize(("use", "make", "type_", "interface", "field"), SENT)
def test_an_array_that_is_always_empty_can_be_used_like_any_array(
    use: str, make: Callable[[str, str, str, str], dict[str, str]], type_: str, interface: str, field: str
) -> None:
    """The model is sound, its variables are those that properties may use, and the receiver finds no elements."""
    system = loaded(_files(make(use, type_, interface, field)))
    model = api.to_jani(system)
    assert check_model(model) == ()
    assert set(system.analysis.globals(system.path)) == {variable.name for variable in model.variables}
    explorer = Explorer(model)
    states = explorer.reachable(1000)
    assert any(explorer.globals(state)["ok.valid"] for state in states)


def test_an_element_of_an_event_whose_array_is_always_empty_is_an_error() -> None:
    found = errors(_files(_event("guarded", "string", "", "")))
    assert [finding.message for finding in found] == [
        "this array has no elements, because its value is always `[]`"
    ] * 1
