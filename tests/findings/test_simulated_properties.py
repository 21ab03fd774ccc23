# SPDX-License-Identifier: Apache-2.0
"""What a check finds in the properties of systems that have too many states to explore all of them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fixture import write_files
from roaml import api
from roaml.comparison import read_comparison
from roaml.diagnostics import Diagnostic
from roaml.jani.equal_probabilities import with_equal_probabilities
from roaml.jani.expressions import Integer
from roaml.jani.model import Clause, Destination
from roaml.project import exploration, explored_properties
from roaml.project.property_runs import RUNS
from roaml.project.settings import Settings
from roaml.project.simulated_properties import MIN_FAILED
from roaml.project.translation import network_of
from roaml.record import replace
from roaml.to_jani import translate

CODES = ("never-satisfied", "unmet-expectation", "vacuous-property")
SORTER = """
-- main.xml --
<roaml>
    <parameters>
        <max_time value="SECONDS" unit="s" />
    </parameters>
    <node_models>
        <input type="node-ascxml" src="camera.ascxml" />
        <input type="node-ascxml" src="arm.ascxml" />
    </node_models>
    <properties>
        <input type="xml" src="properties.xml" />
    </properties>
</roaml>
-- camera.ascxml --
<ascxml name="Camera" version="1.0" initial="looking">
    <ros_topic_publisher name="item" topic="/item" type="std_msgs/UInt8" />
    <ros_time_rate name="frame" rate_hz="1" />
    <datamodel>
        <data id="size" type="uint8" expr="0" />
    </datamodel>
    <state id="looking">
        <ros_rate_callback name="frame">
            <target id="looking" prob="0.5"><assign location="size" expr="2" /></target>
            <target id="looking" prob="0.4999"><assign location="size" expr="4" /></target>
            <target id="looking" prob="0.0001"><assign location="size" expr="(size + size) % 9" /></target>
        </ros_rate_callback>
        <onentry>
            <ros_topic_publish name="item"><field name="data" expr="size" /></ros_topic_publish>
        </onentry>
    </state>
</ascxml>
-- arm.ascxml --
<ascxml name="Arm" version="1.0" initial="waiting">
    <ros_topic_subscriber name="item" topic="/item" type="std_msgs/UInt8" />
    <ros_topic_publisher name="grasp" topic="/grasp" type="std_msgs/UInt8" />
    <state id="waiting">
        <ros_topic_callback name="item" target="waiting" cond="_msg.data &gt; 0">
            <ros_topic_publish name="grasp"><field name="data" expr="_msg.data" /></ros_topic_publish>
        </ros_topic_callback>
    </state>
</ascxml>
-- properties.xml --
<properties>
    <ports>
        <ros_topic topic_name="/item" type="std_msgs/UInt8" event="publish">
            <event_var id="item" />
            <state_var id="size" type="uint8" field="data" expr="0" />
        </ros_topic>
        <ros_topic topic_name="/grasp" type="std_msgs/UInt8" event="publish">
            <event_var id="grasps" />
            <state_var id="width" type="uint8" field="data" expr="0" />
        </ros_topic>
    </ports>
    <guarantees>
        PROPERTY
    </guarantees>
</properties>
"""
RESPONSE = """<property id="asked" pattern="response"EXPECT>
            <events><event>LEFT</event><event>RIGHT</event></events>
            <scope type="globally" />
            <time_interval TIME time_unit="s" />
        </property>"""
ONE = """<property id="asked" pattern="PATTERN"EXPECT>
            <event>LEFT</event>
            SCOPE
        </property>"""


def response(left: str, right: str, time: str = 'within="1"', expect: str = "") -> str:
    return RESPONSE.replace("LEFT", left).replace("RIGHT", right).replace("TIME", time).replace("EXPECT", expect)


def one(pattern: str, condition: str, scope: str = '<scope type="globally" />', expect: str = "") -> str:
    text = ONE.replace("PATTERN", pattern).replace("LEFT", condition)
    return text.replace("SCOPE", scope).replace("EXPECT", expect)


def found(folder: Path, property_: str, seconds: int = 20, settings: Settings | None = None) -> list[Diagnostic]:
    """The findings about a property of the sorter."""
    write_files(folder, SORTER.replace("PROPERTY", property_).replace("SECONDS", str(seconds)))
    result = api.check([str(folder / "main.xml")], settings=settings or Settings())
    return [d for d in result.diagnostics if d.code in CODES]


@pytest.fixture(autouse=True)
def _too_many_states(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exploration, "MAX_STATES", 1)


@pytest.mark.parametrize(
    ("property_", "code", "place", "message"),
    [
        (response("size == 3", "grasps"), "vacuous-property", "size == 3", "is 0, 2 or 4), so the property"),
        (
            one("absence", "width == 0", '<scope type="after" event="item &amp;&amp; size == 6" />'),
            "vacuous-property",
            "size == 6",
            "requires nothing in any of 100 simulated runs",
        ),
        (one("existence", "width == 3"), "never-satisfied", "width == 3", "(`width` is 2 or 4)"),
        (one("existence", "width == 3", expect=' expect="&gt;= 0.5"'), "never-satisfied", "width == 3", "none of 100"),
        (one("universality", "size &lt; 2"), "never-satisfied", "size &lt; 2", "false at some time in every one"),
        (
            response("size == 8 || item &amp;&amp; size == 4", "size == 6"),
            "never-satisfied",
            "size == 6",
            "none of 100 simulated runs of this system that test the property",
        ),
        (response("item", "grasps", 'after="30"'), "never-satisfied", "time_interval", "without this time interval"),
        (
            one("existence", "item &amp;&amp; size == 4", expect=' expect="&lt;= 0.5"'),
            "unmet-expectation",
            "&lt;= 0.5",
            "is satisfied in 100 of 100 simulated runs",
        ),
    ],
)
def test_a_property_that_nothing_tests_or_no_run_meets(
    tmp_path: Path, property_: str, code: str, place: str, message: str
) -> None:
    [finding] = found(tmp_path, property_)
    assert finding.code == code
    assert finding.source is not None
    assert finding.source.text[finding.span.start : finding.span.end] == place
    assert message in finding.message


@pytest.mark.parametrize(
    "property_",
    [
        response("size == 4", "grasps"),
        one("absence", "width == 3"),
        one("absence", "width == 0", '<scope type="after" event="item &amp;&amp; size == 4" />'),
        one("existence", "width == 4", expect=' expect="&gt;= 0.9"'),
        one("existence", "width == 3", expect=' expect="= 0"'),
        one("universality", "size &lt; 2", expect=' expect="= 0"'),
    ],
)
def test_a_right_property_is_not_reported(tmp_path: Path, property_: str) -> None:
    assert found(tmp_path, property_) == []


@pytest.mark.parametrize("property_", [response("size == 8", "grasps"), one("existence", "size == 8")])
def test_what_only_happens_rarely_is_no_mistake(tmp_path: Path, property_: str) -> None:
    assert found(tmp_path, property_) == []


def test_runs_that_do_not_test_a_property_do_not_count(tmp_path: Path) -> None:
    property_ = one("existence", "width == 6", '<scope type="after" event="item &amp;&amp; size == 4" />')
    [finding] = found(tmp_path, property_, 2)
    tested = re.search(r"none of (\d+) simulated runs of this system that test", finding.message)
    assert tested is not None
    assert MIN_FAILED <= int(tested[1]) < RUNS


@pytest.mark.parametrize(("seconds", "number"), [(1, 0), (5, 1)])
def test_a_trigger_needs_many_messages_before_it_is_missed(tmp_path: Path, seconds: int, number: int) -> None:
    assert len(found(tmp_path, response("grasps &amp;&amp; width == 3", "item"), seconds)) == number


@pytest.mark.parametrize(("expected", "number"), [(">= 0.4", 1), ("<= 0.1", 0)])
def test_an_expectation_of_the_settings(tmp_path: Path, expected: str, number: int) -> None:
    comparison = read_comparison(expected)
    assert comparison is not None
    rare = one("existence", "size == 4", '<scope type="globally" /><time_interval within="0.5" time_unit="s" />')
    assert len(found(tmp_path, rare, settings=Settings(expectations={"asked": comparison}))) == number


def test_a_search_that_is_too_long_is_replaced_by_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exploration, "MAX_STATES", 10_000)
    property_ = one("existence", "width == 3")
    [searched] = found(tmp_path, property_)
    monkeypatch.setattr(explored_properties, "MAX_STEPS", 1)
    [simulated] = found(tmp_path, property_)
    assert searched.span == simulated.span
    assert "simulated" not in searched.message
    assert "simulated" in simulated.message


def test_equal_probabilities_keep_what_is_impossible(tmp_path: Path) -> None:
    write_files(tmp_path, SORTER.replace("PROPERTY", one("absence", "item")).replace("SECONDS", "9"))
    path = str(tmp_path / "main.xml")
    model = translate(network_of(api.check([path]).snapshot.analysis, path), (), ())
    [(automaton, edge)] = [(a, e) for a in model.automata for e in a.edges if len(e.destinations) == 3]
    impossible = Destination(edge.source, Clause(Integer(0)))
    edge = replace(edge, destinations=(*edge.destinations, impossible))
    changed = with_equal_probabilities(replace(model, automata=(replace(automaton, edges=(edge,)),)))
    [[*possible, last]] = [each.destinations for each in changed.automata[0].edges]
    assert last == impossible
    assert len({d.probability for d in possible}) == 1
