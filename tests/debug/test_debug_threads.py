# SPDX-License-Identifier: Apache-2.0
"""Action threads have the names of their machines in all texts for users, and the names of their automata in
expressions."""

from __future__ import annotations

from pathlib import Path

import pytest

from as2fm_lsp.verification.run_files import csv_lines
from roaml import api
from roaml.debugging.by_hand import setting
from roaml.debugging.debugger import Debugger
from roaml.debugging.evaluate import evaluate, parsed
from roaml.debugging.sources import Sources
from roaml.debugging.start import Start, start
from roaml.timeline import Timeline
from roaml.views.actors import actors
from roaml.views.story import as_text

SYSTEM = """<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <node_models>
        <input type="node-ascxml" src="robot.ascxml" /><input type="node-ascxml" src="operator.ascxml" />
    </node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>"""
THREAD = """<ros_action_thread name="{handle}" n_threads="{count}" initial="free">
    <datamodel><data id="order" type="int32" expr="-1" /></datamodel>
    <state id="free">
        <onentry><ros_action_thread_free name="{handle}" /></onentry>
        <ros_action_handle_thread_start name="{handle}" target="busy">
            <assign location="order" expr="_goal.order" />
        </ros_action_handle_thread_start>
    </state>
    <state id="busy"><ros_action_handle_thread_start name="{handle}" target="busy" /></state>
</ros_action_thread>"""
HANDLERS = """<ros_action_handle_goal name="{handle}" target="ready">
    <assign location="goal" expr="_action.goal_id" />
    <ros_action_accept_goal name="{handle}" goal_id="goal" />
    <ros_action_start_thread name="{handle}" goal_id="goal" thread_id="0">
        <field name="order" expr="_goal.order" />
    </ros_action_start_thread>
</ros_action_handle_goal>
<ros_action_handle_thread_free name="{handle}" target="ready" />"""
DECLARATION = '<ros_action_{role} name="{handle}" action_name="/{handle}_to" type="example_interfaces/Fibonacci" />'


def debugger_of(folder: Path, threads: dict[str, int]) -> Debugger:
    """The debugger of a system with a server of actions.

    Args:
        threads: handle of each action -> the number of its threads.
    """

    def parts(text: str, **arguments: str) -> str:
        return "".join(text.format(handle=handle, count=count, **arguments) for handle, count in threads.items())

    robot = (
        f'<ascxml name="Robot" version="1.0" initial="ready">{parts(DECLARATION, role="server")}'
        f'<datamodel><data id="goal" type="int32" expr="0" /></datamodel>{parts(THREAD)}'
        f'<state id="ready">{parts(HANDLERS)}</state></ascxml>'
    )
    states = []
    for number, handle in enumerate(threads):
        states += [
            f'<state id="ask_{number}"><transition target="wait_{number}"><ros_action_send_goal name="{handle}">'
            f'<field name="order" expr="7" /></ros_action_send_goal></transition></state>',
            f'<state id="wait_{number}"><ros_action_handle_goal_response name="{handle}" '
            f'accept="ask_{number + 1}" reject="ask_{number + 1}" /></state>',
        ]
    operator = (
        f'<ascxml name="Operator" version="1.0" initial="ask_0">{parts(DECLARATION, role="client")}'
        f'{"".join(states)}<state id="ask_{len(threads)}" /></ascxml>'
    )
    texts = {
        "main.xml": SYSTEM,
        "robot.ascxml": robot,
        "operator.ascxml": operator,
        "properties.jani": '{"properties": []}',
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    system = api.load(str(folder / "main.xml"))
    return start(Sources(api.as_target(system), system.analysis), Start(), lambda *_: None)


@pytest.mark.parametrize(
    ("threads", "names"),
    [
        ({"drive": 2}, ["Robot, goal thread 0", "Robot, goal thread 1"]),
        (
            {"drive": 2, "turn": 1},
            ["Robot, goal thread 0 of drive", "Robot, goal thread 1 of drive", "Robot, goal thread 0 of turn"],
        ),
    ],
)
def test_threads_have_the_name_of_their_machine(tmp_path: Path, threads: dict[str, int], names: list[str]) -> None:
    debugger = debugger_of(tmp_path, threads)
    session = debugger.session
    assert [thread.name for thread in debugger.threads] == ["Robot", *names, "Operator"]
    assert {f"{name} starts" for name in names} <= {choice.text for choice in session.choices()}
    assert {f"`{name}`" for name in names} <= set(actors(debugger.sources.target.model).values())
    timeline = Timeline(session)
    while session.step():
        pass
    timeline.follow(session)
    assert [lane.name for lane in timeline.lanes] == ["Robot", *names, "Operator"]
    assert f"{names[0]}.order" in [plot.name for plot in timeline.plots]
    state = session.state()
    assert [machine.name for machine in state.machines] == ["Robot", *names, "Operator"]
    assert names[0] in [event.sender for event in state.events]
    story = as_text(session.story(), lambda _: "")
    assert names[0] in story
    assert "_to_thread_" not in story


def test_expressions_use_the_names_of_automata(tmp_path: Path) -> None:
    debugger = debugger_of(tmp_path, {"drive": 2})
    while debugger.session.step():
        pass
    debugger.go_to(debugger.session.position)

    def value(text: str) -> object:
        return evaluate(parsed(text), debugger.values.names(None))

    assert value("drive_to_thread_0.order") == 7
    assert value("drive_to_thread_0.state") == "busy"
    assert value("drive_to_thread_1.order + 1") == 0
    debugger.go_to(0)
    assert value("drive_to_thread_0.order") == -1
    entry = debugger.values.entry("drive_to_thread_0.order", None)
    assert entry is not None
    assert entry.variable is not None
    debugger.intervene(setting(debugger.session, debugger.sources, entry.variable, 3))
    assert value("drive_to_thread_0.order") == 3
    header = next(csv_lines(debugger.session)).strip().split(",")
    assert {"drive_to_thread_0.state", "drive_to_thread_1.order"} <= set(header)
