# SPDX-License-Identifier: Apache-2.0
"""Publishing, calling and setting by hand."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from dap_client import Client

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "assembly_robot"
BUG = ROBOT / "main_with_bug.xml"


@pytest.fixture
def client() -> Iterator[Client]:
    with Client() as client:
        yield client


def test_a_message_is_published_and_received(client: Client) -> None:
    client.begin(BUG, property="never_placed_empty")
    start = client.step()
    events = {event["name"]: event for event in client.ask("events")["events"]}
    assert events["/arm/command"]["fields"] == "{data: 0}"
    assert events["/arm/command"]["types"] == {"data": "uint8"}
    assert events["/arm/command"]["isFree"]
    assert not client.ask("choices")["isChanged"]
    client.ask("publish", event="/arm/command", fields={"data": 1})
    client.event("stopped")
    state = client.ask("choices")
    assert (state["step"], state["isByHand"], state["isChanged"]) == (start + 1, True, True)
    assert "has been sent but not received yet" in client.refusal("publish", event="/arm/command", fields={"data": 2})
    (receives,) = (choice for choice in state["choices"] if choice["text"].startswith("Arm receives"))
    assert "(data: 1)" in receives["text"]
    client.ask("choose", choice=receives["number"])
    client.event("stopped")
    client.move("next")
    assert client.ask("evaluate", expression="Arm.holding")["result"] == "true"
    while client.ask("choices")["end"] is None:
        client.move()
    assert set(client.ask("choices")["verdicts"].values()) == {"undecided"}
    client.ask("goToStep", step=start)
    client.event("stopped")
    assert not client.ask("choices")["isChanged"]
    assert client.ask("evaluate", expression="Arm.holding")["result"] == "false"
    client.ask("goToStep", step=start + 1)
    client.event("stopped")
    assert client.ask("choices")["isChanged"]


def test_the_console_publishes_and_completes(client: Client) -> None:
    client.begin(BUG)
    start = client.step()
    (target,) = client.ask("completions", text="publish /arm/com", column=17)["targets"]
    assert target["text"] == "/arm/command {data: 0}"
    assert (target["start"], target["length"]) == (9, 8)
    result = client.ask("evaluate", expression="publish /arm/command {data: 1 + 1}", context="repl")["result"]
    assert "from here on, the run does not show the behaviour of the model" in result
    client.event("stopped")
    assert client.step() == start + 1
    frame = client.stack(2)[0]["id"]
    messages = client.scope(frame, "Messages")
    assert messages["a message on the topic `/arm/command`"]["value"] == "{data: 2}"


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"data": 300}, "`data` must be from 0 to 255, not 300"),
        ({"data": 0.5}, "`data` must be an integer"),
        ({"data": True}, "`data` must be a number, not true"),
        ({"x": 1}, "there is no field `x`; the only field is `data`"),
        ([1], "must be an object"),
        ("{data: ", "a value"),
    ],
)
def test_fields_that_do_not_fit(client: Client, fields: object, reason: str) -> None:
    client.begin(BUG)
    start = client.step()
    assert reason in client.refusal("publish", event="/arm/command", fields=fields)
    assert "there is no such topic, service, action or event" in client.refusal("publish", event="/nothing", fields={})
    assert client.step() == start


def test_variables_are_set_and_saved(client: Client, tmp_path: Path) -> None:
    client.begin(BUG, seed=3)
    client.ask("goToStep", step=40)
    client.event("stopped")
    scopes = client.ask("scopes", frameId=client.stack(2)[0]["id"])["scopes"]
    reference = scopes[0]["variablesReference"]
    assert "255" in client.refusal("setVariable", variablesReference=reference, name="way", value="256")
    assert client.ask("setVariable", variablesReference=reference, name="way", value="2 + 3")["value"] == "5"
    client.event("stopped")
    assert client.ask("evaluate", expression="Arm.way")["result"] == "5"
    client.move("stepBack")
    assert client.ask("evaluate", expression="Arm.way")["result"] == "0"
    client.move("stepIn")
    file = tmp_path / "run.json"
    file.write_text(client.ask("saveSession")["session"], encoding="utf-8")
    with Client() as other:
        other.begin(BUG, session=str(file))
        assert (other.step(), other.ask("choices")["isChanged"]) == (41, True)
        assert other.ask("evaluate", expression="Arm.way")["result"] == "5"


@pytest.mark.parametrize(
    ("expression", "value", "reason"),
    [
        ("Arm.way", "300", "`way` must be from 0 to 255, not 300"),
        ("Arm.way", "'far'", "`way` must be a number, not 'far'"),
        ("Arm.way", "nothing + 1", "there is no variable `nothing` here"),
        ("Arm.wya", "1", "{holding: false, way: 0, state: 'still'} has no member `wya`; did you mean `way`?"),
        ("time", "1", "`time` cannot be set; only variables and blackboard entries can be set"),
    ],
)
def test_expressions_that_cannot_be_set(client: Client, expression: str, value: str, reason: str) -> None:
    client.begin(BUG)
    response = client.response(client.send("setExpression", expression=expression, value=value))
    assert (response["success"], response["message"]) == (False, reason)
    # VS Code shows nothing for this request by itself.
    assert response["body"]["error"]["showUser"]


def test_entries_of_the_blackboard_have_the_types_of_their_ports(client: Client, tmp_path: Path) -> None:
    robot = tmp_path / "robot"
    shutil.copytree(ROBOT, robot)
    changes = (
        ("plugins/pick_up.ascxml", "    <state", '    <bt_declare_port_in key="force" type="int32" />\n    <state'),
        (
            "tree_with_bug.xml",
            "<PickUp />",
            '<SetBlackboard value="3" output_key="{force}" /><PickUp force="{force}" />',
        ),
    )
    for name, old, new in changes:
        file = robot / name
        file.write_text(file.read_text(encoding="utf-8").replace(old, new, 1), encoding="utf-8")
    client.begin(robot / "main_with_bug.xml")
    assert client.scope(client.stack(1)[0]["id"], "Blackboard")["force"]["type"] == "int32"
    refusal = client.refusal("setExpression", expression="force", value="3000000000")
    assert refusal == "`force` must be from -2147483648 to 2147483647, not 3000000000"
