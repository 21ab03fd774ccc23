# SPDX-License-Identifier: Apache-2.0
"""Files of properties in XML while they are typed, and ports of every kind."""

from __future__ import annotations

import json
import os

import pytest
from test_observers_in_traces import FILES, FOLDER, PORTS

from roaml import api
from roaml.diagnostics import Diagnostic, Severity
from roaml.project.settings import Settings

PROPERTIES = f"""<properties>{PORTS}
<guarantees>
    <property id="one" pattern="precedence">
        <events><event>value &lt;= 2</event><event>alarm || looked</event></events>
        <scope type="between" event="asked" until="answered &amp;&amp; answer" />
        <time_interval after="0.5" within="2" time_unit="s" />
    </property>
    <property id="two" logic="pmtl" expr="{{ measured }} -&gt; O[1:3] {{ words == 'on' &amp;&amp; urgent }}" />
    <property id="three" pattern="absence"><event>ticked &amp;&amp; status == 1</event>
        <scope type="globally" /></property>
</guarantees>
</properties>"""


def diagnostics(properties: str, jani: str = '{"properties": []}') -> tuple[Diagnostic, ...]:
    files = {name: text.replace("{time}", "2000") for name, text in FILES.items()}
    inputs = '<input type="xml" src="properties.xml" /><input type="jani" src="more.jani" />'
    files["main.xml"] = files["main.xml"].replace('<input type="xml" src="properties.xml" />', inputs)
    files |= {"properties.xml": properties, "more.jani": jani}
    texts = {os.path.join(FOLDER, name): text for name, text in files.items()}
    return tuple(api.check([os.path.join(FOLDER, "main.xml")], settings=Settings(), texts=texts).diagnostics)


def checked(properties: str, jani: str = '{"properties": []}') -> list[tuple[str, str]]:
    return [(d.code, d.message) for d in diagnostics(properties, jani)]


def test_a_complete_file_has_no_findings() -> None:
    findings = checked(PROPERTIES)
    assert {code for code, _ in findings} <= {"topic-without-subscriber", "late-event-data"}  # of other files


@pytest.mark.parametrize("start", range(7))
def test_incomplete_files_cause_no_internal_error(start: int) -> None:
    for end in range(start, len(PROPERTIES), 49):
        assert "internal-error" not in {code for code, _ in checked(PROPERTIES[:end])}


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ('topic_name="/alarm"', 'topic_name="/ask"', "unknown-property-port"),
        ('service_name="/ask"', 'service_name="/aks"', "unknown-property-port"),
        ('node="look"', 'node="lock"', "unknown-property-port"),
        ('type="std_srvs/SetBool" event="request"', 'type="std_srvs/Trigger" event="request"', "port-type"),
        ('type="std_msgs/Bool"', 'type="std_msgs/Boolean"', "port-type"),
        (
            'event="publish">\n        <event_var id="alarm"',
            'event="response">\n        <event_var id="alarm"',
            "invalid-value",
        ),
        ('field="success"', 'field="succes"', "port-variable"),
        ('type="int32" field="data"', 'type="bool" field="data"', "port-variable"),
        ('expr="3"', 'expr="three"', "port-variable"),
        ('id="urgent"', 'id="alarm"', "repeated-property-id"),
        ('id="two"', 'id="one"', "repeated-property-id"),
        ("value &lt;= 2", "valeu &lt;= 2", "property-condition"),
        ("value &lt;= 2", "value + 2", "property-condition"),
        ("value &lt;= 2", "value &lt;=", "property-condition"),
        ("<event>value &lt;= 2</event>", "", "property-form"),
        ('until="answered &amp;&amp; answer"', "", "property-form"),
        ('<scope type="globally" />', "", "property-form"),
        ("O[1:3]", "O[3:1]", "property-form"),
        ('after="0.5" within="2"', 'after="3" within="2"', "property-time"),
        ('after="0.5" within="2"', 'after="0.3" within="0.4"', "property-time"),
        ('pattern="absence"', 'pattern="recurrence"', "property-time"),
        ("alarm || looked", "alarm &amp;&amp; looked", "events-never-together"),
        (
            'pattern="absence"><event>ticked &amp;&amp; status == 1',
            'pattern="universality"><event>ticked',
            "event-false-at-start",
        ),
        (" &amp;&amp; urgent", "", "unused-port-variable"),
    ],
)
def test_an_inserted_error_is_reported(old: str, new: str, code: str) -> None:
    assert old in PROPERTIES
    assert code in {reported for reported, _ in checked(PROPERTIES.replace(old, new, 1))}


@pytest.mark.parametrize(
    ("declared", "severity"),
    [
        ("int64", Severity.WARNING),
        ("int8", Severity.ERROR),
        ("uint32", Severity.ERROR),
        ("float64", Severity.WARNING),
        ("string", Severity.ERROR),
    ],
)
def test_a_wider_type_of_a_variable_is_harmless(declared: str, severity: Severity) -> None:
    assert 'type="int32" field="data"' in PROPERTIES
    text = PROPERTIES.replace('type="int32" field="data"', f'type="{declared}" field="data"', 1)
    assert [d.severity for d in diagnostics(text) if d.code == "port-variable"] == [severity]


PLAIN = '<scxml_event_send event="topic_alarm_msg"><event_var id="ticked" />{}</scxml_event_send>'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '<bt_node node="Look" event="tick"><event_var id="ticked" /></bt_node>',
            PLAIN.format('<state_var id="on" type="bool" param="dat" expr="false" />'),
            "the event `topic_alarm_msg` has no parameter `dat`; did you mean `ros_fields__data`?",
        ),
        (
            '<bt_node node="Look" event="tick"><event_var id="ticked" /></bt_node>',
            PLAIN.format('<state_var id="on" type="bool" expr="false" />'),
            "`param` is missing; add the name of the parameter whose value the variable gets",
        ),
        (' field="success"', "", "`field` is missing; add the name of the field whose value the variable gets"),
        ('field="status"', 'field="code"', "a response of a node has no field `code`; did you mean `status`?"),
        ("value &lt;= 2", "words - 2 == 1", "`-` takes a number, not a value of type `string`"),
        ("value &lt;= 2", "value &amp;&amp; alarm", "`&&` takes a boolean, not a value of type `int32`"),
    ],
)
def test_messages_name_what_the_file_contains(old: str, new: str, message: str) -> None:
    assert old in PROPERTIES
    assert message in {text for _, text in checked(PROPERTIES.replace(old, new, 1))}


def test_names_are_unique_over_all_files() -> None:
    probability = {"op": "Pmin", "exp": {"op": "F", "exp": True}}
    expression = {"op": "filter", "fun": "values", "values": probability, "states": {"op": "initial"}}
    findings = checked(PROPERTIES, json.dumps({"properties": [{"name": "one", "expression": expression}]}))
    assert (
        "repeated-property-id",
        "another property of the system is called `one`, in `properties.xml`; rename one of them",
    ) in findings
