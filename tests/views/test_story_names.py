# SPDX-License-Identifier: Apache-2.0
"""Stories contain the names that users have chosen for timers, clients and goals, not those of the translation."""

from __future__ import annotations

from pathlib import Path

import drive_robot
from roaml import api
from roaml.scxml.names import InterfaceEvent, InterfaceEventKind, client_of, read_interface_event
from roaml.verification.counterexample import counterexample
from roaml.views.event_words import event_phrase, goal_phrases


def story(folder: Path, name: str) -> list[str]:
    """The lines and details of the shortest trace in which a property fails."""
    main = drive_robot.written(folder)
    options = api.Options(method=api.EstimationMethod.FIXED, max_traces=20)
    (result,) = api.verify(api.load(str(main)), [name], options, only_uniform=True)
    failed = counterexample(result)
    assert failed is not None
    return [text for line in failed.lines for text in (f"{line.who} {line.what}", *line.details)]


def test_a_timer_has_its_handle(tmp_path: Path) -> None:
    lines = story(tmp_path, "no_result")
    assert "Operator 1 receives the tick of its timer `second` in waiting → stopping" in lines
    assert not [line for line in lines if "ros_time_rate" in line]


def test_a_server_executes_a_goal(tmp_path: Path) -> None:
    """A variable of the machine with a similar name keeps its name."""
    lines = story(tmp_path, "no_result")
    assert "executes goal 0 of /arm/drive: false → true" in lines
    assert "executes goal 0 of /arm/drive: true → false" in lines
    assert "executes_second_0: 0 → 1" in story(tmp_path, "no_beat")


def test_a_variable_of_the_machine_with_the_name_of_the_translation() -> None:
    variables = ["executes_drive_0", "executes_drive_0_", "executes_other_0", "goal"]
    assert goal_phrases(variables, {"cancel_action_drive"}.__contains__) == {
        "executes_drive_0_": "executes goal 0 of /drive"
    }


def test_a_client_has_its_name(tmp_path: Path) -> None:
    """Events contain the names of clients without characters that are not allowed there."""
    lines = story(tmp_path, "no_result")
    assert any(line.startswith("sends a goal of /arm/drive (") for line in lines)
    assert not [line for line in lines if "Operator_1" in line]
    event = "action_arm__drive_goal_req_client_Operator_1"
    goal = InterfaceEvent(InterfaceEventKind.GOAL, "arm__drive")
    assert read_interface_event(event, {"Robot", "Operator 1"}) == goal
    assert read_interface_event(event, {"Operator_1"}) == goal
    assert event_phrase(event, ["Operator 1"]) == "a goal of the action `/arm/drive`"


def test_an_interface_and_a_client_contain_the_separator() -> None:
    event = "srv_a_client_b_req_client_x_client_y"
    assert client_of(event, ["y", "x client y"]) == "x client y"
    request = InterfaceEvent(InterfaceEventKind.REQUEST, "a_client_b")
    assert read_interface_event(event, ["y", "x client y"]) == request
    assert client_of("srv_a_client_b_request", ["b"]) == ""
