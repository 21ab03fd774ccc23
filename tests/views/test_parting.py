# SPDX-License-Identifier: Apache-2.0
"""Two traces part where an automaton does something else, not where only the order of independent automata differs."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api
from roaml.record import replace
from roaml.smc.story import Story
from roaml.verification.counterexample import unwanted_trace
from roaml.verification.nearest import nearest
from roaml.verification.results import Result
from roaml.views.cause import cause
from roaml.views.parting import alignment, parting, parting_text, read_trace
from roaml.views.turn_words import details

LAMP = """<ascxml name="{name}" version="1.0" initial="off">
    <ros_time_rate name="blink" rate_hz="1" />
    <ros_topic_publisher name="light" topic="/{name}" type="std_msgs/Bool" />
    <state id="off">
        <ros_rate_callback name="blink" target="on">
            <ros_topic_publish name="light"><field name="data" expr="true" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
    <state id="on">
        <ros_rate_callback name="blink">
{targets}
        </ros_rate_callback>
    </state>
    <state id="broken"><ros_rate_callback name="blink" target="broken" /></state>
</ascxml>"""
MAIN = """<roaml>
    <parameters><max_time value="6" unit="s" /></parameters>
    <node_models><input type="node-ascxml" src="a.ascxml" /><input type="node-ascxml" src="b.ascxml" /></node_models>
    <properties><input type="jani" src="p.jani" /></properties>
</roaml>"""
LATER = """{"properties": [{"name": "later", "expression": {"op": "filter", "fun": "values", "states":
{"op": "initial"}, "values": {"op": "Pmax", "exp": {"op": "F",
"exp": {"op": "=", "left": "topic_clock_msg__ros_fields__sec", "right": 5}}}}}]}"""


SURE = '<target id="off" />'
CHANCE = '<target id="off" prob="0.5" /><target id="broken" />'
EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def result() -> Result:
    target = api.target(str(EXAMPLES / "assembly_robot/main_with_bug.xml"))
    return next(iter(api.verify(target, ["never_placed_empty"], api.Options(max_traces=60))))


def story_of(result: Result) -> Story:
    seen = unwanted_trace(result)
    assert seen is not None
    assert result.traces is not None
    return result.traces.story(seen.trace)


def test_the_nearest_passing_trace_parts_where_the_block_is_dropped(result: Result) -> None:
    assert result.traces is not None
    near = nearest(result, story_of(result), result.traces.target.clock)
    assert near is not None
    here, there = near.parting.here, near.parting.there
    assert there is not None
    assert (here.who, here.time, there.who, there.time) == ("Arm", 5.0, "Arm", 5.0)
    assert "sends /block/dropped (data: true)" in tuple(details(here))
    assert "sends /block/dropped (data: true)" not in tuple(details(there))
    lines = parting_text(near.parting, near.story, lambda _: "arm.ascxml:38").splitlines()
    assert lines[0].endswith(f"passed: the first {near.parting.common} turns are the same, then Arm at 5.000 s")
    assert [line.split()[0] for line in lines[1:]] == ["here", "there"]


def test_the_first_line_begins_where_the_traces_part(result: Result) -> None:
    """The last outcome of chance is named as what decides, and not once more at the end of the sentence."""
    assert result.traces is not None
    story = story_of(result)
    near = nearest(result, story, result.traces.target.clock)
    assert near is not None
    first = cause(story, lambda _: "", (near.parting, near.story))
    other = near.story.recording.trace
    assert first == (
        "by chance (0.5), Arm sends /block/dropped (data: true) and /arm/gripper (data: false) at 5.000 s, "
        f"unlike in trace {other}, which passed; never_placed_empty fails at 10.000 s: "
        "Arm receives /arm/command (data: 3) in still and sends /block/placed (data: false)"
    )
    back = parting(near.story, story)
    assert back is not None
    assert "does not send /block/dropped (data: true) and /arm/gripper (data: false) at 5.000 s" in cause(
        near.story, lambda _: "", (back, story)
    )


def test_a_later_outcome_of_chance_decides(result: Result) -> None:
    """The turn in which traces part is not named if chance decides something after it."""
    assert result.traces is not None
    story = story_of(result)
    near = nearest(result, story, result.traces.target.clock)
    assert near is not None
    early = replace(near.parting.here, number=1)
    first = cause(story, lambda _: "", (replace(near.parting, here=early), near.story))
    assert first == cause(story, lambda _: "")
    assert first.endswith("; the last outcome of chance was that of Arm at 5.000 s (0.5)")


def test_no_other_trace_has_more_in_common(result: Result) -> None:
    assert result.traces is not None
    assert result.answer is not None
    story = story_of(result)
    near = nearest(result, story, result.traces.target.clock)
    assert near is not None
    passed = [result.traces.story(seen.trace) for seen in result.answer.tally.examples[1]]
    assert len(passed) == near.compared > 1
    others = [parting(story, other) for other in passed]
    assert max(other.common for other in others if other is not None and other.there) == near.parting.common


def test_states_that_belong_together_have_the_same_turns(result: Result) -> None:
    assert result.traces is not None
    story = story_of(result)
    near = nearest(result, story, result.traces.target.clock)
    assert near is not None
    assert near.parting.there is not None
    aligned = alignment(story, near.story, near.parting)
    here, there = read_trace(story), read_trace(near.story)
    assert (aligned.here, aligned.there) == (near.parting.here.number - 1, near.parting.there.number - 1)
    assert (aligned.here_time, aligned.there_time) == (5.0, 5.0)
    assert len(aligned.pairs) > near.parting.common // 2
    for step, other in aligned.pairs:
        assert step <= aligned.here
        assert other <= aligned.there
        for instance, lane in here.lanes.items():
            done = [here.keys[index] for index in lane if here.turns[index].last <= step]
            also = [there.keys[index] for index in there.lanes[instance] if there.turns[index].last <= other]
            assert also[: len(done)] == done or other == aligned.there


def test_a_trace_does_not_part_from_itself(result: Result) -> None:
    story = story_of(result)
    assert parting(story, story) is None


@pytest.mark.parametrize(("targets", "parts"), [(SURE, False), (CHANCE, True)])
def test_an_order_is_no_difference(tmp_path: Path, targets: str, *, parts: bool) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.ascxml").write_text(LAMP.format(name=name, targets=targets), encoding="utf-8")
    (tmp_path / "main.xml").write_text(MAIN, encoding="utf-8")
    (tmp_path / "p.jani").write_text(LATER, encoding="utf-8")
    result = next(iter(api.verify(api.target(str(tmp_path / "main.xml")), options=api.Options(max_traces=20))))
    assert result.traces is not None
    stories = [result.traces.story(trace) for trace in range(20)]
    orders = {tuple(part.automaton for step in story.steps for part in step.parts) for story in stories}
    assert len(orders) > 1
    differences = [parting(stories[0], other) for other in stories[1:]]
    assert any(d is not None and d.there is not None for d in differences) == parts
