# SPDX-License-Identifier: Apache-2.0
"""Sessions that go forwards, backwards and by hand, and saved ones; compared with the traces of `verify`."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smc_models import at, automaton, document, edge, model, op, probability, variable, way, ways

import conformance
from roaml import api
from roaml.record import replace
from roaml.smc.record import VERDICTS, Recorder, Recording, TraceVerdict

EXAMPLES = Path(__file__).parents[2] / "examples"
ROBOT = EXAMPLES / "assembly_robot/main_with_bug.xml"
TRACES = 2
"""The number of traces of the first property that are replayed; one of each other property is."""


@pytest.fixture(scope="module")
def robot() -> api.VerificationTarget:
    return api.as_target(api.load(str(ROBOT)))


SYSTEMS = [ROBOT, *sorted({conformance.ROOT / case["model"] for case in conformance.verified()})]


@pytest.mark.parametrize("path", SYSTEMS, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_traces_of_verify_are_replayed_forwards_and_backwards(path: Path) -> None:
    target = api.as_target(api.load(str(path), [str(conformance.INTERFACES)] if path != ROBOT else []))
    checker = api.checker(target.model)
    for property_ in checker.compiled_properties:
        name = property_.question.name
        recorder = Recorder(checker, property_, 1, 2_000)
        session = api.session(target, name, seed=1)
        for trace in range(TRACES if property_ is checker.compiled_properties[0] else 1):
            recording = Recording(trace)
            steps = tuple(recorder.walk(recording))
            session = api.session(target, name, seed=1, trace=trace)
            session.until_decided(limit=2_000)
            assert tuple(session.steps[: len(steps)]) == steps
            assert session.verdict == VERDICTS[recording.verdict]
        states = {}
        session.jump(0)
        for position in range(0, len(session.steps), max(1, len(session.steps) // 7)):
            session.jump(position)
            states[position] = session.state()
        for position in sorted(states, reverse=True):
            session.jump(position)
            assert session.state() == states[position]


def test_state_in_the_terms_of_the_user(robot: api.VerificationTarget) -> None:
    session = api.session(robot, "block_placed", seed=3)
    assert session.until_time(4)
    state = session.state()
    assert state.time == 4
    arm, *_ = state.machines
    assert (arm.name, arm.state, arm.variables) == ("Arm", "moving", {"holding": True, "way": 0})
    assert {node.type: node.status.value for node in state.nodes}["MoveToGoal"] == "RUNNING"
    command = next(event for event in state.events if event.name == "topic_arm__command_msg")
    assert (command.text, command.sender, command.parameters) == (
        "a message on the topic `/arm/command`",
        "MoveToGoal",
        {"data": 2},
    )


def test_a_run_evaluates_a_property_that_its_start_does_not_decide() -> None:
    counter = automaton("A", "s", [edge("s", way("s", x=op("+", "x", 1)), guard=op("<", "x", 9))])
    reaches = {
        name: probability({"op": "F", "exp": op("≥", "x", least)}) for name, least in (("start", 0), ("later", 3))
    }
    subject = model(document(counter, variables=[variable("x")], properties=reaches))
    assert api.session(subject).save().property == "later"
    assert api.session(subject, "start").save().property == "start"
    assert api.session(replace(subject, properties=subject.properties[:1])).save().property == "start"


def test_a_turn_ends_where_a_machine_waits_again(robot: api.VerificationTarget) -> None:
    session = api.session(robot, "block_placed", seed=3)
    while session.turn():
        assert any(not machine.handles for machine in session.state().machines)
    assert session.end is not None


def test_a_tick_ends_with_the_answer_of_the_root(robot: api.VerificationTarget) -> None:
    session = api.session(robot, "block_placed", seed=3)
    assert session.tick()
    assert session.state().nodes[0].status is api.NodeStatus.RUNNING
    assert session.steps[session.position - 1].action == "bt_1000_response_on_receive"


def test_another_outcome_of_a_choice(robot: api.VerificationTarget) -> None:
    """Go back to the step in which the block was dropped by chance. With the other outcome, the arm still holds it."""
    session = next(
        session
        for trace in range(100)
        if (session := api.session(robot, "block_dropped", seed=1, trace=trace)).until_decided()
        and session.verdict is TraceVerdict.PASSED
    )
    chance: list[api.Choice] = []
    while not chance:
        session.back()
        chance = [choice for choice in session.choices() if len(choice.outcomes) > 1]
    (choice,) = chance
    assert [outcome.probability for outcome in choice.outcomes] == [0.5, 0.5]
    assert any("`/block/dropped`" in outcome.text for outcome in choice.outcomes)
    kept = next(outcome for outcome in choice.outcomes if "dropped" not in outcome.text)
    session.step(choice, kept)
    assert session.is_by_hand
    session.turn()
    assert session.state().machines[0].variables["holding"] is True


def test_choices_name_automata_and_messages(robot: api.VerificationTarget) -> None:
    session = api.session(robot, "block_placed", seed=3)
    assert session.until_sent("/arm/command")
    texts = [choice.text for choice in session.choices()]
    assert "Arm receives a message on the topic `/arm/command` (data: 1)" in texts
    assert sum(choice.probability for choice in session.choices()) == pytest.approx(1)


def test_choices_say_to_which_time_the_clock_goes(robot: api.VerificationTarget) -> None:
    """Listing the choices of a state does not change the run."""
    session, other = (api.session(robot, "block_placed", seed=3) for _ in range(2))
    times = set()
    while (session.time or 0) < 4:
        passing = [choice for choice in session.choices() if choice.text.startswith("time passes")]
        for choice in passing:
            fork = session.fork()
            fork.step(choice)
            assert choice.text == f"time passes to {fork.time:.3f} s"
            times.add(fork.time)
        session.step()
        other.step()
        assert session.state() == other.state()
    assert {1.0, 2.0, 3.0} <= times


def test_outcomes_show_computed_values() -> None:
    session = api.session(api.as_target(api.load(str(EXAMPLES / "grid_world/main.xml"))), "arrives")
    (choice,) = session.choices()
    assert [outcome.text for outcome in choice.outcomes] == [
        "x := 1, energy := 23",
        "y := 1, energy := 23",
        "energy := 23",
    ]


STRUCT = {
    "main.xml": """<roaml>
    <parameters><max_time value="9" unit="s" /></parameters>
    <data_declarations><input type="xml" src="types.xml" /></data_declarations>
    <node_models><input type="node-ascxml" src="robot.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>""",
    "properties.jani": '{"properties": []}',
    "types.xml": """<types>
    <struct id="Pose"><member id="x" type="int32" /><member id="y" type="int32" /></struct>
</types>""",
    "robot.ascxml": """<ascxml name="Robot" version="1.0" initial="driving">
    <datamodel>
        <data id="pose" type="Pose" expr="{'x': 3, 'y': 0}" />
        <data id="count" type="int32" expr="0" />
    </datamodel>
    <ros_time_rate name="second" rate_hz="1" />
    <state id="driving">
        <ros_rate_callback name="second">
            <target id="driving" prob="0.5"><assign location="pose.x" expr="pose.x + 1" /></target>
            <target id="driving" prob="0.5"><assign location="pose.y" expr="7" /></target>
        </ros_rate_callback>
    </state>
</ascxml>""",
}


def test_outcomes_name_members_of_structs(tmp_path: Path) -> None:
    for name, text in STRUCT.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    session = api.session(api.as_target(api.load(str(tmp_path / "main.xml"))))
    while not (drawn := [choice for choice in session.choices() if len(choice.outcomes) > 1]):
        session.step()
    texts = [outcome.text for outcome in drawn[0].outcomes]
    assert texts == ["pose.x := 4, Robot enters `driving`", "pose.y := 7, Robot enters `driving`"]


def test_outcomes_cut_arrays_to_their_lengths(tmp_path: Path) -> None:
    robot = """<ascxml name="Robot" version="1.0" initial="driving">
        <datamodel><data id="levels" type="int32[5]" expr="[7, 8]" /></datamodel>
        <ros_time_rate name="second" rate_hz="1" />
        <state id="driving">
            <ros_rate_callback name="second">
                <target id="driving" prob="0.5"><assign location="levels[1]" expr="levels[0] + 2" /></target>
                <target id="driving" prob="0.3"><assign location="levels[2]" expr="5" /></target>
                <target id="driving" prob="0.2"><assign location="levels.length" expr="0" /></target>
            </ros_rate_callback>
        </state>
    </ascxml>"""
    for name, text in {**STRUCT, "robot.ascxml": robot}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    session = api.session(api.as_target(api.load(str(tmp_path / "main.xml"))))
    while not (drawn := [choice for choice in session.choices() if len(choice.outcomes) > 1]):
        session.step()
    assert [outcome.text.partition(", Robot")[0] for outcome in drawn[0].outcomes] == [
        "levels := [7, 9]",
        "levels := [7, 8, 5]",
        "levels := []",
    ]


def test_outcomes_show_elements_of_arrays_and_failures() -> None:
    """The text of an outcome that fails states why. Listing the choices changes nothing."""
    array = {"kind": "array", "base": "int"}
    element = ways("a", [(at("cells", 1), op("+", "x", 5), 0)], 0.5)
    division = way("a", 0.5, x=op("floor", op("/", 1, "x")))
    constructor = {"op": "ac", "var": "i", "length": 2, "exp": 0}
    variables = [variable("x"), variable("cells", array, constructor)]
    session = api.session(model(document(automaton("A", "a", [edge("a", element, division)]), variables=variables)))
    for _ in range(2):
        (choice,) = session.choices()
        texts = [outcome.text for outcome in choice.outcomes]
        assert texts == ["cells := [0, 5]", "the step fails: division by zero"]
    session.step(choice, choice.outcomes[0])
    with pytest.raises(api.FaultError, match="division by zero"):
        session.step(choice, choice.outcomes[1])


def test_a_different_step_discards_later_steps(robot: api.VerificationTarget) -> None:
    session = api.session(robot, "block_placed", seed=3)
    session.until_decided()
    length = len(session.steps)
    session.jump(0)
    session.step(session.choices()[-1])
    assert len(session.steps) == 1 < length
    session.back()
    session.step()
    assert session.is_by_hand, "a step that was taken by hand is taken again"


def test_a_fork_is_independent(robot: api.VerificationTarget) -> None:
    session = api.session(robot, "block_placed", seed=3)
    session.jump(100)
    fork = session.fork()
    fork.step(fork.choices()[0])
    session.step()
    assert (session.position, fork.position) == (101, 101)
    assert fork.is_by_hand
    assert not session.is_by_hand


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(0, 30), max_size=30), st.integers(0, 50))
def test_a_saved_session_is_the_same_run(robot: api.VerificationTarget, picks: list[int], position: int) -> None:
    session = api.session(robot, "block_placed", seed=5, trace=2)
    for pick in picks:
        choices = session.choices()
        session.step(choices[pick % len(choices)] if choices and pick < 20 else None)
    session.jump(min(position, len(session.steps)))
    saved = api.SavedSession.from_json(session.save().to_json())
    again = api.session(robot, saved=saved)
    assert again.position == session.position
    assert again.state() == session.state()
    assert again.steps == session.steps


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"format": 2, "engine": 1}',
        '{"format": 1, "engine": 1, "property": "p", "seed": 0, "trace": 0, "position": 9, "decisions": [3]}',
        '{"format": 1, "engine": 1, "property": "p", "seed": 0, "trace": 0, "position": 0, "decisions": [{}]}',
        '{"format": 1, "engine": 1, "property": "p", "seed": 0, "trace": 0, "position": 0, "decisions": [99999999999]}',
        "[" * 100_000,
    ],
)
def test_invalid_saved_sessions_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"session|position"):
        api.SavedSession.from_json(text)


@pytest.mark.parametrize("wrong", ["Infinity", "NaN", "1.5", "1.0", "true", "-2", "1" + "0" * 30, '"1"', "null", "[]"])
@pytest.mark.parametrize(
    ("member", "value"),
    [
        ("seed", "?"),
        ("trace", "?"),
        ("position", "?"),
        ("decisions", "[?]"),
        ("decisions", '[{"vector": ?, "picks": [], "ways": []}]'),
        ("decisions", '[{"vector": 0, "picks": [?], "ways": []}]'),
        ("decisions", '[{"vector": 0, "picks": [], "ways": [?]}]'),
        ("decisions", '[{"event": "", "values": [[?, "a", 1]]}]'),
    ],
)
def test_wrong_numbers_in_saved_sessions_are_refused(member: str, value: str, wrong: str) -> None:
    members = {"seed": "0", "trace": "0", "position": "0", "decisions": "[1]", member: value.replace("?", wrong)}
    rest = ", ".join(f'"{name}": {text}' for name, text in members.items())
    with pytest.raises(ValueError, match="saved session"):
        api.SavedSession.from_json(f'{{"format": 1, "engine": 1, "property": "p", {rest}}}')


def test_the_versions_of_a_session_are_named() -> None:
    other = "saved in format 1 by engine 7, and this program repeats sessions of format 1 and engine 1"
    with pytest.raises(ValueError, match=other):
        api.SavedSession.from_json('{"format": 1, "engine": 7}')


def test_decisions_that_are_not_possible(robot: api.VerificationTarget) -> None:
    impossible = api.SavedSession("block_placed", 0, 0, 1, (api.Decision(10**6, (), ()),))
    with pytest.raises(api.RunError, match="step 1 is not possible"):
        api.session(robot, saved=impossible)


def test_a_fault_is_an_error_with_its_place() -> None:
    division = way("b", y=op("floor", op("/", 1, "x")))
    actual_model = model(
        document(automaton("A", "a b", [edge("a", division)]), variables=[variable("x"), variable("y")])
    )
    session = api.session(actual_model)
    with pytest.raises(api.FaultError, match="division by zero"):
        session.step()


def test_a_model_without_properties_can_run() -> None:
    actual_model = model(document(automaton("A", "a b", [edge("a", "b")])))
    session = api.session(actual_model)
    assert session.step() is not None
    assert session.step() is None
    assert session.end is api.End.DEADLOCK
