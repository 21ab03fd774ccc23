# SPDX-License-Identifier: Apache-2.0
"""Stories of properties in XML name the property and what it observes, not its observer."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api
from roaml.verification.counterexample import counterexample, witness
from roaml.views.observed import observed_property

BUTTON = """<ascxml name="Button" version="1.0" initial="up">
    <ros_time_rate name="second" rate_hz="1" />
    <ros_topic_publisher name="stop" topic="/stop" type="std_msgs/Empty" />
    <ros_topic_publisher name="still" topic="/still" type="std_msgs/Empty" />
    <state id="up">
        <ros_rate_callback name="second" target="down"><ros_topic_publish name="stop" /></ros_rate_callback>
    </state>
    <state id="down">
        <ros_rate_callback name="second">
            <target id="late" prob="0.5" />
            <target id="done"><ros_topic_publish name="still" /></target>
        </ros_rate_callback>
    </state>
    <state id="late" />
    <state id="done" />
</ascxml>"""
MAIN = """<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="button.ascxml" /></node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>"""
PROPERTIES = """<properties>
    <ports>
        <ros_topic topic_name="/stop" type="std_msgs/Empty" event="publish"><event_var id="stop" /></ros_topic>
        <ros_topic topic_name="/still" type="std_msgs/Empty" event="publish"><event_var id="still" /></ros_topic>
    </ports>
    <guarantees>
        <property id="stops" pattern="response">
            <events><event>stop</event><event>still</event></events>
            <scope type="globally" />
            <time_interval within="2" time_unit="s" />
        </property>
        <property id="never_still" pattern="absence"><event>still</event><scope type="globally" /></property>
    </guarantees>
</properties>"""


def told(folder: Path, name: str, *, holds: bool) -> list[str]:
    """Who does what, with which effects, in the shortest trace in which a property holds or fails."""
    for file, text in (("button.ascxml", BUTTON), ("main.xml", MAIN), ("properties.xml", PROPERTIES)):
        (folder / file).write_text(text, encoding="utf-8")
    options = api.Options(method=api.EstimationMethod.FIXED, max_traces=50)
    (result,) = api.verify(api.load(str(folder / "main.xml")), [name], options, only_uniform=True)
    found = witness(result) if holds else counterexample(result)
    assert found is not None
    assert "__" not in found.heading
    return [f"{line.who} {line.what}; {', '.join(line.details)}".removesuffix("; ") for line in found.lines]


PRESSED = [
    "Button receives the tick of its timer `second` in up → down; sends /stop",
    "stops observes a message on the topic `/stop`; the property requires an event from now on",
]


def test_a_deadline_passes(tmp_path: Path) -> None:
    assert told(tmp_path, "stops", holds=False) == [
        *PRESSED,
        "Button receives the tick of its timer `second` in down → late; by chance, 0.5",
        "the clock advances the time",
        "stops observes a step of the clock; the property is violated",
    ]


def test_the_required_event_occurs(tmp_path: Path) -> None:
    """The trace is decided by its end. The observer of the other property is not shown."""
    lines = told(tmp_path, "stops", holds=True)
    assert lines[:2] == PRESSED
    assert "stops observes a message on the topic `/still`; the required event has occurred" in lines
    assert not [line for line in lines if "observer" in line or line.startswith("never_still")]


def test_an_event_violates_a_property_at_once(tmp_path: Path) -> None:
    lines = told(tmp_path, "never_still", holds=False)
    assert lines[-1] == "never_still observes a message on the topic `/still`; the property is violated"


@pytest.mark.parametrize(
    ("observer", "name"),
    [
        ("stops__observer", "stops"),
        ("stops___observer", "stops"),
        ("assumed__observer", "assumed"),
    ],
)
def test_the_property_of_an_observer(observer: str, name: str) -> None:
    assert observed_property(observer, "stops") == name
    assert observed_property("may_follow__observer", "may follow") == "may follow"


def test_the_tree_ends_with_a_status() -> None:
    main = Path(__file__).parents[2] / "examples" / "delivery_robot" / "main.xml"
    options = api.Options(method=api.EstimationMethod.FIXED, max_traces=5, seed=1)
    (result,) = api.verify(api.load(str(main)), ["docks_only_when_low"], options, only_uniform=True)
    found = witness(result)
    assert found is not None
    assert (found.lines[-1].who, found.lines[-1].what) == ("the tree", "ends with SUCCESS")
