# SPDX-License-Identifier: Apache-2.0
"""Observers in the translation: the verdicts of traces are compared with the naive evaluation of their events.

The events are read from the steps of the trace, without any observer or its variables.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Iterator

import naive
import pytest
from hypothesis import given, settings
from test_observer_random import windows

import kept_strategies as st
from examples import examples
from roaml import api
from roaml.observers.notation import read as read_formula
from roaml.observers.properties import (
    CLOSE,
    LEFT,
    OPEN,
    RIGHT,
    FormulaProperty,
    Pattern,
    PatternProperty,
    Property,
    ScopeKind,
    Window,
)
from roaml.observers.verdict import End, Verdict
from roaml.project.settings import Settings
from roaml.scxml.names import TIME_IS_OVER
from roaml.smc.end import End as TraceEnd
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.record import Recording

FOLDER = os.path.abspath(os.sep + "model")
FILES = {
    "main.xml": """
<roaml>
    <parameters>
        <max_time value="{time}" unit="ms" />
        <bt_tick_rate value="2" />
    </parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="look.ascxml" />
    </behavior_tree>
    <node_models>
        <input type="node-ascxml" src="sensor.ascxml" />
        <input type="node-ascxml" src="guard.ascxml" />
    </node_models>
    <properties>
        <input type="xml" src="properties.xml" />
    </properties>
</roaml>
""",
    "tree.xml": """
<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <KeepRunningUntilFailure><Look name="look" /></KeepRunningUntilFailure>
    </BehaviorTree>
</root>
""",
    "look.ascxml": """
<ascxml name="Look" version="1.0" initial="ready">
    <ros_service_client name="ask" service_name="/ask" type="std_srvs/SetBool" />
    <state id="ready">
        <bt_tick target="asked"><ros_service_send_request name="ask"><field name="data" expr="true" />
            </ros_service_send_request></bt_tick>
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
    <state id="asked">
        <ros_service_handle_response name="ask">
            <target id="ready" prob="0.8"><bt_return_status status="SUCCESS" /></target>
            <target id="ready"><bt_return_status status="FAILURE" /></target>
        </ros_service_handle_response>
    </state>
</ascxml>
""",
    "sensor.ascxml": """
<ascxml name="Sensor" version="1.0" initial="measure">
    <datamodel><data id="value" type="int32" expr="3" /></datamodel>
    <ros_time_rate name="sample" rate_hz="4" />
    <ros_topic_publisher name="value" topic="/value" type="std_msgs/Int32" />
    <state id="measure">
        <ros_rate_callback name="sample">
            <target id="measure" prob="0.4">
                <assign location="value" expr="value - 1" />
                <ros_topic_publish name="value"><field name="data" expr="value" /></ros_topic_publish>
            </target>
            <target id="measure" prob="0.2">
                <assign location="value" expr="5" />
                <ros_topic_publish name="value"><field name="data" expr="value" /></ros_topic_publish>
            </target>
            <target id="measure" />
        </ros_rate_callback>
    </state>
</ascxml>
""",
    "guard.ascxml": """
<ascxml name="Guard" version="1.0" initial="watch">
    <ros_topic_subscriber name="value" topic="/value" type="std_msgs/Int32" />
    <ros_topic_publisher name="alarm" topic="/alarm" type="std_msgs/Bool" />
    <ros_service_server name="ask" service_name="/ask" type="std_srvs/SetBool" />
    <state id="watch">
        <ros_topic_callback name="value" cond="_msg.data &lt; 3" target="watch">
            <ros_topic_publish name="alarm"><field name="data" expr="_msg.data &lt; 2" /></ros_topic_publish>
        </ros_topic_callback>
        <ros_service_handle_request name="ask" target="watch">
            <ros_service_send_response name="ask">
                <field name="success" expr="true" /><field name="message" expr="'on'" />
            </ros_service_send_response>
        </ros_service_handle_request>
    </state>
</ascxml>
""",
}
PORTS = """
<ports>
    <ros_topic topic_name="/value" type="std_msgs/Int32" event="publish">
        <state_var id="value" type="int32" field="data" expr="3" /><event_var id="measured" />
    </ros_topic>
    <ros_topic topic_name="/alarm" type="std_msgs/Bool" event="publish">
        <event_var id="alarm" /><state_var id="urgent" type="bool" field="data" expr="false" />
    </ros_topic>
    <ros_service service_name="/ask" type="std_srvs/SetBool" event="request"><event_var id="asked" /></ros_service>
    <ros_service service_name="/ask" type="std_srvs/SetBool" event="response">
        <event_var id="answered" /><state_var id="answer" type="bool" field="success" expr="false" />
        <state_var id="words" type="string" field="message" expr="''" />
    </ros_service>
    <bt_node node="look" event="response">
        <state_var id="status" type="int32" field="status" expr="0" /><event_var id="looked" />
    </bt_node>
    <bt_node node="Look" event="tick"><event_var id="ticked" /></bt_node>
</ports>
"""
EVENTS = {
    "topic_value_msg": "measured",
    "topic_alarm_msg": "alarm",
    "srv_ask_req_client_BT_plugin_1001_look": "asked",
    "srv_ask_response_client_BT_plugin_1001_look": "answered",
    "bt_1001_response": "looked",
    "bt_1001_tick": "ticked",
}
PORT_OF = {
    "measured": ("measured", "value"),
    "alarm": ("alarm", "urgent"),
    "asked": ("asked",),
    "answered": ("answered", "answer", "words"),
    "looked": ("looked", "status"),
    "ticked": ("ticked",),
}
START = {"value": 3, "urgent": False, "answer": False, "words": "", "status": 0}
VARIABLES = {
    "value": "topic_value_msg__ros_fields__data",
    "urgent": "topic_alarm_msg__ros_fields__data",
    "answer": "srv_ask_response_client_BT_plugin_1001_look__ros_fields__success",
    "status": "bt_1001_response__status",
}
CONDITIONS = {
    "alarm": ("alarm", lambda v: v["alarm"]),
    "measured": ("measured", lambda v: v["measured"]),
    "value &lt; 2": ("value", lambda v: v["value"] < 2),
    "measured &amp;&amp; value == 5": ("measured value", lambda v: v["measured"] and v["value"] == 5),
    "alarm || looked": ("alarm looked", lambda v: v["alarm"] or v["looked"]),
    "alarm &amp;&amp; urgent": ("alarm urgent", lambda v: v["alarm"] and v["urgent"]),
    "asked": ("asked", lambda v: v["asked"]),
    "answered": ("answered", lambda v: v["answered"]),
    "!answer": ("answer", lambda v: not v["answer"]),
    "looked &amp;&amp; status != 3": ("looked status", lambda v: v["looked"] and v["status"] != 3),
    "ticked || value &gt; 3": ("ticked value", lambda v: v["ticked"] or v["value"] > 3),
    "words == 'on'": ("words", lambda v: v["words"] == "on"),
}
STEP = 250
"""ms of a step of the clock: the greatest common divisor of 500 and 250."""

conditions = st.sampled_from(sorted(CONDITIONS))


@st.composite
def patterns(draw: st.DrawFn) -> tuple[PatternProperty, dict[str, str]]:
    pattern, scope = draw(st.sampled_from(Pattern)), draw(st.sampled_from(ScopeKind))
    window = Window(0, draw(st.integers(0, 4))) if pattern is Pattern.RECURRENCE else draw(windows())
    property_ = PatternProperty(pattern, scope, window)
    return property_, {name: draw(conditions) for name in property_.inputs}


def as_xml(property_: PatternProperty, written: dict[str, str]) -> str:
    events = "".join(f"<event>{written[name]}</event>" for name in (LEFT, RIGHT) if name in written)
    events = f"<events>{events}</events>" if property_.pattern.is_binary else events
    limits = f' event="{written[OPEN]}"' if OPEN in written else ""
    limits += f' until="{written[CLOSE]}"' if CLOSE in written else ""
    lower, upper = property_.window.lower, property_.window.upper
    times = f' after="{lower * STEP - STEP // 5}"' if lower else ""
    times += "" if upper is None else f' within="{upper * STEP + STEP // 5}"'
    interval = f'<time_interval{times} time_unit="ms" />' if times else ""
    scope = f'<scope type="{property_.scope.value}"{limits} />'
    return f'<property id="asked" pattern="{property_.pattern.value}">{events}{scope}{interval}</property>'


@functools.lru_cache(maxsize=8)
def target(property_: str, time: int) -> tuple[object, object]:
    files = {name: text.replace("{time}", str(time)) for name, text in FILES.items()}
    files["properties.xml"] = f"<properties>{PORTS}<guarantees>{property_}</guarantees></properties>"
    system = api.load(
        os.path.join(FOLDER, "main.xml"),
        settings=Settings(),
        texts={os.path.join(FOLDER, name): text for name, text in files.items()},
    )
    model = api.to_jani(system)
    checker = api.checker(model, ["asked", "stuck"])
    assert not checker.refused
    return checker, api.verifier(model)


def events(checker, trace: int) -> tuple[list[tuple[int, str, dict]], End]:  # type: ignore[no-untyped-def,type-arg]
    """Time, event and values after it for each sending and each step of the clock, and how the trace ends."""
    from roaml.smc.record import Recorder  # noqa: PLC0415

    recorder = Recorder(checker, checker.stuck, 5, 100_000)
    storages = {storage.name: storage for storage in recorder.shared}
    rows, time, recording = [], 0, Recording(trace)
    values = dict(START)
    for step in recorder.walk(recording):
        action = step.action or ""
        event = action.removesuffix("_on_send") if action.endswith("_on_send") else ""
        if event in EVENTS:
            name = EVENTS[event]
            for variable in PORT_OF[name][1:]:
                if variable == "words":
                    values["words"] = "on"
                else:
                    (values[variable],) = recorder.values([storages[VARIABLES[variable]]])
            rows.append((time, name, dict(values)))
        elif action == "global_timer_tick_action" and any(
            part.automaton == "autogenerated_global_timer" and part.destination.location != TIME_IS_OVER
            for part in step.parts
        ):
            time += 1
            rows.append((time, "", dict(values)))
    return rows, End.TIME if recording.end is TraceEnd.TIME else End.FINISHED


def letters(rows, written: dict[str, str]) -> Iterator[naive.Letter]:  # type: ignore[no-untyped-def]
    """The letters of the property: the start, the events of its ports, and the steps of the clock."""
    used = {name for text in written.values() for name in CONDITIONS[text][0].split()}
    heard = {event for event, names in PORT_OF.items() if used & set(names)}

    def letter(time: int, event: str, values: dict) -> naive.Letter:  # type: ignore[type-arg]
        known = {**values, **{name: name == event for name in PORT_OF}}
        return naive.Letter(time, frozenset(n for n, text in written.items() if CONDITIONS[text][1](known)))

    yield letter(0, "", START)
    yield from (letter(*row) for row in rows if not row[1] or row[1] in heard)


def check(property_: Property, written: dict[str, str], xml: str, time: int) -> None:
    checker, _ = target(xml, time)
    (compiled,) = (candidate for candidate in checker.compiled_properties if candidate.question.name == "asked")  # type: ignore[attr-defined]
    from roaml.smc.record import Recorder  # noqa: PLC0415

    recorder = Recorder(checker, compiled, 5, 100_000)  # type: ignore[arg-type]
    for trace in range(12):
        recording = Recording(trace)
        recorder.rush(recording)
        rows, end = events(checker, trace)
        expected = naive.verdict(property_, tuple(letters(rows, written)), end)
        verdicts = {FALSE: Verdict.VIOLATED, TRUE: Verdict.SATISFIED, UNKNOWN: Verdict.OPEN}
        assert verdicts[recording.verdict] is expected


@settings(max_examples=examples(40))
@given(patterns(), st.sampled_from([2000, 3100]))
def test_patterns(drawn: tuple[PatternProperty, dict[str, str]], time: int) -> None:
    property_, written = drawn
    check(property_, written, as_xml(property_, written), time)


@pytest.mark.parametrize(
    ("formula", "left", "right"),
    [
        ("{L} -> O[1:3] {R}", "alarm", "measured"),
        ("H[:2] !{L} || {R}", "looked &amp;&amp; status != 3", "value &lt; 2"),
        ("!({R} S[2:] {L})", "measured &amp;&amp; value == 5", "!answer"),
        ("{L} -> !{R} S {R}", "answered", "asked"),
    ],
)
def test_formulas(formula: str, left: str, right: str) -> None:
    plain = read_formula(formula.replace("L", "left").replace("R", "right")).formula
    assert plain is not None
    expr = formula.replace("L", left).replace("R", right).replace("->", "-&gt;").replace("&&", "&amp;&amp;")
    xml = f'<property id="asked" logic="pmtl" expr="{expr}" />'
    check(FormulaProperty(plain), {LEFT: left, RIGHT: right}, xml, 2000)


@pytest.mark.parametrize("scope", ScopeKind)
@pytest.mark.parametrize("pattern", Pattern)
def test_each_pattern_in_each_scope(pattern: Pattern, scope: ScopeKind) -> None:
    written = {LEFT: "measured", RIGHT: "alarm", OPEN: "looked &amp;&amp; status != 3", CLOSE: "alarm"}
    window = Window(0, 3)
    property_ = PatternProperty(pattern, scope, window)
    kept = {name: written[name] for name in property_.inputs}
    check(property_, kept, as_xml(property_, kept), 2000)


def test_the_traces_distinguish_properties() -> None:
    """The cases above have verdicts of all kinds, so a wrong verdict would be detected."""
    property_ = PatternProperty(Pattern.RESPONSE, ScopeKind.GLOBALLY, Window(0, 2))
    written = {LEFT: "measured", RIGHT: "alarm"}
    checker, _ = target(as_xml(property_, written), 2000)
    seen = set()
    for trace in range(40):
        rows, end = events(checker, trace)
        seen.add(naive.verdict(property_, tuple(letters(rows, written)), end))
    assert seen == {Verdict.SATISFIED, Verdict.VIOLATED, Verdict.OPEN}
