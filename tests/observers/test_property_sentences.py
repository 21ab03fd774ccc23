# SPDX-License-Identifier: Apache-2.0
"""Properties as English sentences and formulas."""

from __future__ import annotations

import pytest

from roaml.model.property_file import build_property_file
from roaml.model.property_sentences import formula, sentence
from roaml.xml_syntax import parse

PORTS = """<ports>
<ros_topic topic_name="/alarm" type="std_msgs/Bool" event="publish"><event_var id="alarm"/></ros_topic>
<ros_service service_name="/charge" type="std_srvs/SetBool" event="request"><event_var id="ask"/></ros_service>
<ros_service service_name="/charge" type="s/S" event="response" target="me"><event_var id="told"/></ros_service>
<ros_action action_name="/go" type="n/Go" event="goal_request"><event_var id="goal"/></ros_action>
<ros_action action_name="/go" type="n/Go" event="goal_response"><event_var id="reply"/></ros_action>
<ros_action action_name="/go" type="n/Go" event="feedback"><event_var id="news"/></ros_action>
<ros_action action_name="/go" type="n/Go" event="result"><event_var id="done"/></ros_action>
<ros_action action_name="/go" type="n/Go" event="cancel_request"><event_var id="stop"/></ros_action>
<bt_node node="pick" event="tick"><event_var id="tick"/></bt_node>
<bt_node node="pick" event="response"><event_var id="answer"/></bt_node>
<bt_node node="pick" event="halt"><event_var id="halt"/></bt_node>
<scxml_event_send event="full" origin="Battery"><event_var id="full"/></scxml_event_send>
</ports>"""


def sentences_of(inside: str, section: str = "guarantees") -> tuple[str, str]:
    document = parse(f"<properties>{PORTS}<{section}>{inside}</{section}></properties>")
    file = build_property_file(document)
    assert file is not None
    (written,) = file.properties
    return sentence(file, written), formula(written)


def of(pattern: str, events: str, scope: str = 'type="globally"', interval: str = "") -> tuple[str, str]:
    conditions = [f"<event>{event}</event>" for event in events.split(" | ")]
    body = conditions[0] if len(conditions) == 1 else f"<events>{''.join(conditions)}</events>"
    time = f"<time_interval {interval}/>" if interval else ""
    return sentences_of(f'<property id="p" pattern="{pattern}">{body}<scope {scope}/>{time}</property>')


@pytest.mark.parametrize(
    ("pattern", "events", "interval", "expected", "notation"),
    [
        ("universality", "x &gt; 1", "", "`x > 1` always holds.", "G (x > 1)"),
        ("absence", "alarm", "", "A message is never published on `/alarm`.", "G ¬alarm"),
        ("absence", "stop", "", "Cancelling a goal of `/go` is never requested.", "G ¬stop"),
        ("existence", "done", "", "A result of `/go` is sent at some time.", "F done"),
        (
            "existence", "done", 'within="5" time_unit="s"',
            "A result of `/go` is sent within 5 s from the beginning.", "F[0, 5 s] done",
        ),
        (
            "absence", "halt", 'after="2" within="5" time_unit="s"',
            "`pick` is never halted from 2 s to 5 s after the beginning.", "G[2 s, 5 s] ¬halt",
        ),
        ("response", "x &gt; 1 | alarm", "", None, "G ((x > 1) ⇒ F alarm)"),
        (
            "response", "ask | told", 'time="10" time_unit="ms"',
            "Whenever `/charge` is called, a response of `/charge` is sent to `me` within 10 ms.",
            "G (ask ⇒ F[0, 10 ms] told)",
        ),
        (
            "response", "goal | reply", 'after="1" time_unit="s"',
            "Whenever a goal is sent to `/go`, a goal for `/go` is accepted or rejected at least 1 s later.",
            "G (goal ⇒ F[1 s, ∞] reply)",
        ),
        (
            "precedence", "tick | answer", "",
            "Whenever `pick` answers, `pick` is ticked then or before.", "G (answer ⇒ O tick)",
        ),
        (
            "precedence", "full | news", 'after="2" within="5" time_unit="s"',
            "Whenever feedback of `/go` is sent, `full` is sent by `Battery` 2 s to 5 s before.",
            "G (news ⇒ O[2 s, 5 s] full)",
        ),
        (
            "recurrence", "alarm", 'time="1" time_unit="s"',
            "A message is published on `/alarm` at least once every 1 s.", "G F[0, 1 s] alarm",
        ),
    ],
)  # fmt: skip
def test_patterns(pattern: str, events: str, interval: str, expected: str | None, notation: str) -> None:
    text, shown = of(pattern, events, interval=interval)
    assert text == (expected or "Whenever `x > 1` holds, a message is published on `/alarm` then or later.")
    assert shown == notation


@pytest.mark.parametrize(
    ("scope", "expected"),
    [
        ('type="after" event="goal"', "From the first time that a goal is sent to `/go`, `x` always holds."),
        (
            'type="before" event="goal"',
            "Before the first time that a goal is sent to `/go`, `x` always holds; nothing is required if that end "
            "never comes.",
        ),
        ('type="until" event="goal"', "Until a goal is sent to `/go` or the trace ends, `x` always holds."),
        (
            'type="between" event="goal" until="done"',
            "Each time from when a goal is sent to `/go` until a result of `/go` is sent, `x` always holds; nothing is "
            "required if that end never comes.",
        ),
        (
            'type="after-until" event="goal" until="done"',
            "Each time from when a goal is sent to `/go` until a result of `/go` is sent or the trace ends, `x` always "
            "holds.",
        ),
    ],
)
def test_scopes(scope: str, expected: str) -> None:
    assert of("universality", "x", scope)[0] == expected


@pytest.mark.parametrize(
    ("formula_", "expected"),
    [
        ("{ alarm } -&gt; O[:3] { x &gt; 1 }",
         "At every step, if a message is published on `/alarm`, then (`x > 1` holds at most 3 steps ago)."),
        ("H { x }", "At every step, `x` holds always until now."),
        ("{ a } S[1:2] { b }", "At every step, `b` holds 1 to 2 steps ago and `a` holds ever since."),
        ("!{ a } &amp;&amp; ({ b } || H[:1] { c })",
         "At every step, not `a` holds and (`b` holds or (`c` holds always during the last 1 step))."),
    ],
)  # fmt: skip
def test_formulas(formula_: str, expected: str) -> None:
    assert sentences_of(f'<property id="p" logic="pmtl" expr="{formula_}"/>')[0] == expected


@pytest.mark.parametrize(
    ("inside", "expected"),
    [
        ('<property id="p"/>', ""),
        ('<property pattern="response"/>', "Whenever …, … then or later."),
        ('<property pattern="recurrence"><event></event></property>', "… at least once every …."),
        ('<property logic="pmtl" expr="{ a } S"/>', ""),
        ('<property pattern="absence"><event>`a`</event></property>', "`'a'` never holds."),
    ],
)
def test_incomplete_properties(inside: str, expected: str) -> None:
    assert sentences_of(inside)[0] == expected


def test_an_assumption_says_so() -> None:
    inside = '<property id="p" pattern="absence"><event>alarm</event><scope type="globally"/></property>'
    assert sentences_of(inside, "assumes")[0] == "Assumed: a message is never published on `/alarm`."


def test_the_expectation_is_part_of_the_sentence() -> None:
    body = '<event>alarm</event><scope type="globally"/>'
    text, _ = sentences_of(f'<property id="p" pattern="absence" expect="&gt;= 0.9">{body}</property>')
    assert text == "A message is never published on `/alarm`; the expected probability is `>= 0.9`."
