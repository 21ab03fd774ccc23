# SPDX-License-Identifier: Apache-2.0
"""Sessions of a debugger over standard input and output, as an editor has them."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from dap_client import Client

ROOT = Path(__file__).resolve().parents[2]
ROBOT = ROOT / "examples" / "assembly_robot"
BUG = ROBOT / "main_with_bug.xml"
ARM = ROBOT / "arm.ascxml"
TREE = ROBOT / "tree_with_bug.xml"


@pytest.fixture
def client() -> Iterator[Client]:
    with Client() as client:
        yield client


def _line(path: Path, text: str) -> int:
    """The number of the first line with a text."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return next(number for number, line in enumerate(lines, 1) if text in line)


def _break(client: Client, path: Path, line: int, **options: str) -> dict[str, object]:
    answer = client.ask("setBreakpoints", source={"path": str(path)}, breakpoints=[{"line": line, **options}])
    (body,) = answer["breakpoints"]
    return dict(body)


@pytest.fixture
def real_client() -> Iterator[Client]:
    """The program as an editor starts it."""
    with Client((sys.executable, "-m", "as2fm_lsp")) as client:
        yield client


def test_a_session_from_its_start_to_its_end(real_client: Client) -> None:
    client = real_client
    stopped = client.begin(BUG, property="block_placed", seed=3)
    assert stopped["reason"] == "entry"
    threads = {thread["name"]: thread["id"] for thread in client.ask("threads")["threads"]}
    assert threads == {"tree": 1, "Arm": 2}
    assert client.top(2) == ("arm.ascxml", _line(ARM, '<state id="still">'))
    stopped = client.move()
    assert (stopped["reason"], stopped["description"]) == ("end of the run", "Paused: tree finished")
    assert "has not stopped at an exception" in client.refusal("exceptionInfo")


def test_the_dropped_block_and_the_other_choice(client: Client) -> None:
    client.launch(BUG, property="never_placed_empty", against=1, seed=3)
    line = _line(ARM, '<target id="moving">')
    assert _break(client, ARM, line)["verified"]
    client.ask("setExceptionBreakpoints", filters=["violated"])
    client.ask("configurationDone")
    stopped = client.event("stopped")
    assert stopped["reason"] == "breakpoint"
    before = client.step()
    assert client.top(stopped["threadId"]) == ("arm.ascxml", line)
    violated = client.move()
    # The stop says which sentence is violated, by which message, at the line that has sent it.
    assert (violated["reason"], violated["description"]) == ("violated", "Violated: never_placed_empty")
    what, sentence, message = violated["text"].splitlines()
    assert what == "the property never_placed_empty is violated"
    assert sentence == "The gripper is not opened at the goal without a block in it."
    assert re.fullmatch(r"a message on the topic `/block/placed`: \{data: false\}, sent by Arm in step \d+", message)
    shown = client.ask("exceptionInfo")
    assert (shown["exceptionId"], shown["description"]) == (what, f"{sentence}\n{message}")
    sent = _line(ARM, '<field name="data" expr="holding &amp;&amp; way == 6" />')
    frames = client.stack(violated["threadId"])
    assert [frame["name"] for frame in frames] == ["Arm: <field>, executed last", "Arm: still"]
    assert frames[0]["line"] == sent
    output = client.event("output")
    while not output["output"].startswith(what):
        output = client.event("output")
    assert (output["output"].split("\n    "), output["line"]) == ([what, sentence, f"{message}\n"], sent)
    back = client.move("reverseContinue")
    assert client.step() == before
    assert back["reason"] == "breakpoint"
    choices = client.ask("choices")["choices"]
    (chance,) = (choice for choice in choices if len(choice["outcomes"]) > 1)
    assert [outcome["probability"] for outcome in chance["outcomes"]] == [0.5, 0.5]
    client.ask("choose", choice=chance["number"], outcome=1)
    assert client.event("stopped")["reason"] == "step"
    _break(client, ARM, _line(ARM, '<target id="moving">'), condition="false")
    client.move()
    state = client.ask("choices")
    assert state["isByHand"]
    assert state["verdicts"]["never_placed_empty"] == "passed"
    assert state["verdicts"]["block_placed"] == "passed"


def test_the_tree_shows_the_path_of_ticked_nodes(client: Client) -> None:
    client.launch(BUG, seed=3)
    _break(client, ROBOT / "plugins" / "pick_up.ascxml", 11)
    client.ask("configurationDone")
    client.event("stopped")
    stopped = client.move()
    assert stopped["threadId"] == 1
    frames = [(frame["source"]["name"], frame["line"]) for frame in client.stack(1)]
    tree = "tree_with_bug.xml"
    lines = [_line(TREE, text) for text in ("<PickUp", "<RetryUntil", "<Sequence>")]
    retry = lines[1]
    assert frames == [
        ("pick_up.ascxml", 11),
        ("pick_up.ascxml", 10),
        (tree, lines[0]),
        (tree, retry + 1),
        (tree, retry),
        (tree, lines[2]),
    ]


def test_variables_messages_and_what_has_changed(client: Client) -> None:
    client.launch(BUG, seed=3)
    _break(client, ARM, _line(ARM, '<field name="data" expr="holding" />'))
    client.ask("configurationDone")
    client.event("stopped")
    assert client.move()["threadId"] == 2
    frame = client.stack(2)[0]["id"]
    assert client.scope(frame, "Message")["_msg"]["value"] == "{data: 1}"
    message = client.scope(frame, "Message")["_msg"]
    assert message["evaluateName"] == "_msg"
    (data,) = client.ask("variables", variablesReference=message["variablesReference"])["variables"]
    assert (data["name"], data["value"], data["evaluateName"]) == ("data", "1", "_msg.data")
    holding = client.scope(frame, "Variables")["holding"]
    assert holding["value"] == "true"
    assert holding["type"] == "bool, was false"
    assert "changed" in holding["presentationHint"]["attributes"]
    for expression, value in {
        "holding && way == 0": "true",
        "_msg.data + 1": "2",
        "Arm.state": "'still'",
        "bt_1003": "'RUNNING'",
        "time": "2",
        "Math.max(way, 7) % 4": "3",
    }.items():
        assert client.ask("evaluate", expression=expression, frameId=frame)["result"] == value
    for expression in ("nothing", "1 +", "holding + 1", "1 / 0", "Math.random()", "way.x", "way[0]", "!way"):
        assert client.refusal("evaluate", expression=expression, frameId=frame)


def test_conditions_hit_counts_and_log_points(client: Client) -> None:
    client.launch(BUG, seed=3)
    line = _line(ARM, '<assign location="way" expr="way + 1" />')
    log = {"line": line, "logMessage": "way is {way}, {unknown}"}
    third = {"line": line, "hitCondition": "3"}
    half = {"line": line, "condition": "way == 5"}
    wrong = {"line": line, "condition": "way ==="}
    unclear = {"line": line, "hitCondition": "often"}
    breakpoints = [log, third, half, wrong, unclear]
    bodies = client.ask("setBreakpoints", source={"path": str(ARM)}, breakpoints=breakpoints)["breakpoints"]
    assert [body["verified"] for body in bodies] == [True, True, True, False, False]
    client.ask("configurationDone")
    client.event("stopped")
    stopped = client.move()
    assert stopped["hitBreakpointIds"] == [bodies[1]["id"]]
    assert client.ask("evaluate", expression="Arm.way")["result"] == "3"
    stopped = client.move()
    assert stopped["hitBreakpointIds"] == [bodies[2]["id"]]
    outputs = [event["body"] for event in client.events if event["event"] == "output"]
    logged = [body["output"] for body in outputs if body["output"].startswith("way is")]
    assert [output.split(",")[0] for output in logged] == [f"way is {way}" for way in (0, 2, 3, 4, 5)]
    assert "there is no variable `unknown`" in logged[0]
    assert {body["line"] for body in outputs if body["output"] in logged} == {line}


def test_breakpoints_by_name_on_variables_and_on_nodes(client: Client) -> None:
    client.launch(BUG, seed=3)
    names = [{"name": "/arm/arrived"}, {"name": "HoldsBlock"}, {"name": "nothing"}]
    bodies = client.ask("setFunctionBreakpoints", breakpoints=names)["breakpoints"]
    assert [body["verified"] for body in bodies] == [True, True, False]
    client.ask("configurationDone")
    client.event("stopped")
    stopped = client.move()
    assert (stopped["reason"], stopped["text"]) == ("function breakpoint", "HoldsBlock")
    client.ask("setFunctionBreakpoints", breakpoints=names[:1])
    assert client.move()["text"] == "/arm/arrived"
    assert client.top(2) == ("arm.ascxml", _line(ARM, '<ros_topic_publish name="arrived">'))
    client.ask("setFunctionBreakpoints", breakpoints=[])
    client.ask("goToStep", step=0)
    client.event("stopped")
    frame = client.stack(2)[0]["id"]
    scopes = client.ask("scopes", frameId=frame)["scopes"]
    reference = scopes[0]["variablesReference"]
    info = client.ask("dataBreakpointInfo", variablesReference=reference, name="holding")
    assert info["dataId"] == "Arm/holding"
    assert client.ask("dataBreakpointInfo", variablesReference=reference, name="nothing")["dataId"] is None
    client.ask("setDataBreakpoints", breakpoints=[{"dataId": info["dataId"]}])
    assert client.move()["reason"] == "data breakpoint"
    assert client.ask("evaluate", expression="Arm.holding")["result"] == "true"


def test_data_breakpoints_and_values_of_expressions(client: Client) -> None:
    client.begin(BUG, seed=3)
    holding = client.ask("dataBreakpointInfo", name="Arm.holding")
    assert holding["description"] == "Arm.holding changes"
    frame = client.stack(2)[0]["id"]
    assert client.ask("dataBreakpointInfo", name="holding", frameId=frame)["dataId"] == holding["dataId"]
    for name in ("holding", "Arm.state", "Arm.holding.x", "1 + 1", "step"):
        assert client.ask("dataBreakpointInfo", name=name)["dataId"] is None, name
    known, unknown = client.ask(
        "setDataBreakpoints", breakpoints=[{"dataId": holding["dataId"]}, {"dataId": "Arm/nothing"}]
    )["breakpoints"]
    assert (known["verified"], unknown["verified"]) == (True, False)
    assert client.move()["text"] == "Arm.holding changes"
    first = client.step()
    client.ask("restart")
    assert client.event("stopped")["reason"] == "entry"
    assert client.move()["text"] == "Arm.holding changes"
    assert client.step() == first
    assert client.ask("evaluate", expression="Arm.holding")["result"] == "true"
    assert client.ask("setExpression", expression="Arm.holding", value="!Arm.holding")["value"] == "false"
    assert client.event("stopped")["reason"] == "step"
    assert client.ask("evaluate", expression="Arm.holding")["result"] == "false"
    assert client.ask("choices")["isChanged"]
    assert client.refusal("setExpression", expression="Arm.state", value="1") == (
        "`Arm.state` cannot be set; only variables and blackboard entries can be set"
    )


@pytest.mark.parametrize("unit", ["stepIn", "next", "stepOut"])
def test_each_step_forwards_is_undone_by_going_back(client: Client, unit: str) -> None:
    client.begin(BUG, seed=3)
    client.ask("goToStep", step=35)
    client.event("stopped")
    before = client.stack(1), client.stack(2)
    client.move(unit)
    steps = client.step() - 35
    assert steps == 1 if unit == "stepIn" else steps > 1
    for _ in range(steps):
        client.move("stepBack")
    after = client.stack(1), client.stack(2)
    assert [[(f["name"], f["line"]) for f in s] for s in after] == [[(f["name"], f["line"]) for f in s] for s in before]


def test_filters_of_exceptions(client: Client) -> None:
    client.launch(BUG, seed=3)
    client.ask("setExceptionBreakpoints", filters=["chance", "nothing"])
    client.ask("configurationDone")
    client.event("stopped")
    chance = client.move()
    assert (chance["reason"], chance["text"]) == ("chance", "the next step is decided by chance")
    client.ask("setExceptionBreakpoints", filters=[], filterOptions=[{"filterId": "time", "condition": "time >= 7"}])
    assert client.move()["text"] == "time advances to 7 s"
    client.ask("setExceptionBreakpoints", filters=["satisfied"])
    assert client.move()["text"].splitlines()[0] == "the property block_placed is satisfied"


def test_a_failing_node(client: Client) -> None:
    client.launch(ROBOT / "main.xml", property="block_dropped", inFavor=1)
    client.ask("setExceptionBreakpoints", filters=["failure"])
    client.ask("configurationDone")
    stopped = client.event("stopped")
    assert (stopped["reason"], stopped["text"]) == ("failure", "HoldsBlock fails")
    assert client.stack(1)[0]["name"].startswith("HoldsBlock")
    client.move("stepBack")
    assert "executed last" not in client.stack(1)[0]["name"]


def test_the_line_of_a_property(client: Client) -> None:
    client.launch(ROBOT / "main.xml", property="block_dropped", against=1)
    client.ask("setExceptionBreakpoints", filters=[])
    properties = ROBOT / "properties.jani"
    assert _break(client, properties, _line(properties, '"block_dropped"'))["verified"]
    client.ask("configurationDone")
    stopped = client.event("stopped")
    assert (stopped["reason"], stopped["description"]) == ("breakpoint", "Violated: block_dropped")
    # The run has ended without the message: no line is the cause.
    assert stopped["text"].splitlines()[-1] == "the run has ended: tree finished"
    assert "executed last" not in client.stack(stopped["threadId"])[0]["name"]
    assert client.ask("choices")["verdicts"]["block_dropped"] == "failed"


def test_frames_restart_where_they_began(client: Client) -> None:
    client.launch(BUG, seed=3)
    _break(client, ARM, _line(ARM, '<ros_topic_publish name="gripper">'))
    client.ask("configurationDone")
    client.event("stopped")
    client.move()
    handler = client.stack(2)[1]
    client.move("restartFrame", frameId=handler["id"])
    assert client.ask("evaluate", expression="Arm.holding")["result"] == "false"
    assert client.top(2) == ("arm.ascxml", handler["line"])


def test_a_saved_run_continues_where_it_was(client: Client, tmp_path: Path) -> None:
    client.begin(BUG, seed=5)
    client.ask("goToStep", step=60)
    client.event("stopped")
    choice = client.ask("choices")["choices"][-1]
    client.ask("choose", choice=choice["number"])
    client.event("stopped")
    file = tmp_path / "run.json"
    file.write_text(client.ask("saveSession")["session"], encoding="utf-8")
    frames = [frame["name"] for frame in client.stack(1)]
    with Client() as other:
        other.begin(BUG, session=str(file))
        assert other.step() == 61
        assert [frame["name"] for frame in other.stack(1)] == frames
        other.ask("restart")
        other.event("stopped")
        assert other.step() == 61


def test_places_without_code_and_lists_of_places(client: Client) -> None:
    client.launch(BUG)
    last = len(ARM.read_text(encoding="utf-8").splitlines())
    unverified = _break(client, ARM, last)
    assert not unverified["verified"]
    assert _break(client, ARM, 1)["line"] == _line(ARM, '<state id="still">')
    places = client.ask("breakpointLocations", source={"path": str(TREE)}, line=1, endLine=7)["breakpoints"]
    assert [place["line"] for place in places] == [5, 6, 7]
    names = {source["name"] for source in client.ask("loadedSources")["sources"]}
    assert {"arm.ascxml", "tree_with_bug.xml", "main_with_bug.xml", "properties.jani"} <= names


def test_breakpoints_that_are_set_before_the_launch(client: Client) -> None:
    client.ask("initialize", adapterID="as2fm")
    assert not _break(client, ARM, 21)["verified"]
    client.ask("launch", program=str(BUG))
    changed = client.event("breakpoint")
    assert changed["breakpoint"]["verified"]
    assert changed["breakpoint"]["line"] == 21


def test_lines_that_begin_at_0(client: Client) -> None:
    client.ask("initialize", adapterID="as2fm", linesStartAt1=False, columnsStartAt1=False)
    client.ask("launch", program=str(BUG))
    assert _break(client, ARM, 20)["line"] == 20
    client.ask("configurationDone")
    client.event("stopped")
    frame = client.stack(2)[0]
    assert (frame["line"], frame["column"]) == (_line(ARM, '<state id="still">') - 1, 4)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"program": "nothing.xml"}, "there is no such file"),
        ({"program": str(BUG), "property": "nothing"}, "nothing"),
        ({"program": str(BUG), "seed": "x"}, "`seed` must be an integer"),
        ({"program": str(BUG), "maxTime": "soon"}, "`soon`"),
        ({"program": str(BUG), "parameters": {"speed": 2}}, "the system declares no parameter `speed`"),
        ({"program": str(BUG), "against": 1, "inFavor": 1}, "exclude"),
        ({"program": str(BUG), "session": "nothing.json"}, "nothing.json"),
        ({}, "`program` must be a string"),
    ],
)
def test_a_launch_that_is_not_possible(client: Client, arguments: dict[str, object], reason: str) -> None:
    client.ask("initialize", adapterID="as2fm")
    assert reason in client.refusal("launch", **arguments)


def test_a_model_with_errors_and_one_that_fails(client: Client, tmp_path: Path) -> None:
    broken = tmp_path / "main.xml"
    broken.write_text("<roaml><nothing/></roaml>", encoding="utf-8")
    client.ask("initialize", adapterID="as2fm")
    assert f"{broken}:1: " in client.refusal("launch", program=str(broken))
    client.ask("launch", program=str(BUG))


def test_pausing_a_long_run(client: Client, tmp_path: Path) -> None:
    model = tmp_path / "endless.jani"
    model.write_text(ENDLESS, encoding="utf-8")
    client.begin(model)
    client.ask("continue", threadId=2)
    assert client.refusal("stackTrace", threadId=2) == "the run is moving; pause it first"
    client.ask("pause", threadId=2)
    assert client.event("stopped")["reason"] == "pause"
    assert client.ask("evaluate", expression="x")["variablesReference"] == 0
    client.ask("reverseContinue", threadId=2)
    assert client.event("stopped")["reason"] in ("entry", "pause")


def test_going_to_a_step_of_an_endless_run_can_be_paused(client: Client, tmp_path: Path) -> None:
    model = tmp_path / "endless.jani"
    model.write_text(ENDLESS, encoding="utf-8")
    client.begin(model)
    client.ask("goToStep", step=10**12)
    assert client.event("continued")["allThreadsContinued"]
    client.ask("pause", threadId=2)
    assert client.event("stopped")["reason"] == "pause"
    length = client.step()
    assert 0 < length < 10**12
    client.ask("goToStep", step=length + 3)
    assert client.event("stopped")["reason"] == "goto"
    assert client.step() == length + 3


def test_going_behind_the_end_of_a_run(client: Client) -> None:
    client.begin(BUG, seed=3)
    client.ask("goToStep", step=10**6)
    stopped = client.event("stopped")
    assert (stopped["reason"], stopped["text"]) == ("goto", f"the run ends after {client.step()} steps")


def test_the_search_for_a_trace_shows_its_progress_and_is_cancelled(client: Client) -> None:
    client.ask("initialize", adapterID="as2fm", supportsProgressReporting=True)
    number = client.send("launch", program=str(ROBOT / "main.xml"), property="never_placed_empty", against=1)
    begin = client.event("progressStart")
    assert begin["requestId"] == number
    assert begin["cancellable"]
    assert client.event("progressUpdate")["percentage"] > begin["percentage"]
    cancel = client.send("cancel", progressId=begin["progressId"])
    refusal = client.response(number)
    assert refusal["message"].startswith("the search for a trace was cancelled: 0 of ")
    assert client.event("progressEnd")["progressId"] == begin["progressId"]
    assert client.response(cancel)["success"]
    client.ask("launch", program=str(BUG))


def test_a_file_that_changes_while_the_run_is_stopped(client: Client, tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    shutil.copytree(ROBOT, folder)
    client.begin(folder / BUG.name, seed=3)
    arm = folder / ARM.name
    client.ask("setFunctionBreakpoints", breakpoints=[{"name": "/arm/command"}])
    arm.write_text(f"{arm.read_text(encoding='utf-8')}<!-- a new line -->\n", encoding="utf-8")
    client.move()
    (text,) = _output(client, "has changed since it was read")
    assert text.startswith(str(arm))
    client.move()
    assert _output(client, "has changed since it was read") == []
    client.ask("restart")
    client.event("stopped")
    client.move()
    assert _output(client, "has changed since it was read") == []
    arm.write_text("<ascxml", encoding="utf-8")
    assert "arm.ascxml:" in client.refusal("restart")
    assert client.move()["reason"] == "function breakpoint"  # the run of the last version continues
    (folder / TREE.name).unlink()
    client.refusal("restart")


def _output(client: Client, part: str) -> list[str]:
    """The lines of the console that contain a text, since the last call."""
    events = [event for event in client.events if event["event"] == "output"]
    client.events = [event for event in client.events if event["event"] != "output"]
    return [event["body"]["output"] for event in events if part in event["body"]["output"]]


def test_the_session_ends(client: Client) -> None:
    client.begin(BUG)
    client.ask("terminate")
    client.event("terminated")
    client.ask("disconnect")
    assert client.process.wait() == 0


ENDLESS = """{
    "jani-version": 1, "name": "endless", "type": "mdp",
    "variables": [{"name": "x", "type": {"kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": 1},
        "initial-value": 0}],
    "automata": [{"name": "A", "locations": [{"name": "l"}], "initial-locations": ["l"], "edges": [
        {"location": "l", "destinations": [{"location": "l",
            "assignments": [{"ref": "x", "value": {"op": "-", "left": 1, "right": "x"}}]}]}]}],
    "system": {"elements": [{"automaton": "A"}]},
    "properties": []
}"""


def test_a_breakpoint_on_a_channel(client: Client, tmp_path: Path) -> None:
    """It stops when a message is sent and when it is delivered, not while the message is on its way."""
    page = (ROOT / "docs/spec/channels.md").read_text(encoding="utf-8")
    for name, text in re.findall(r"^\*\*`([\w.]+)`\*\*\n\n```xml\n(.*?)^```", page, re.MULTILINE | re.DOTALL):
        (tmp_path / name).write_text(text, encoding="utf-8")
    main = tmp_path / "main.xml"
    client.launch(main, property="notices", parameters={"loss": "0"})
    assert _break(client, main, _line(main, "<channel "))["verified"]
    client.ask("configurationDone")
    client.event("stopped")
    messages = []
    for _ in range(6):
        assert client.move()["reason"] == "breakpoint"
        messages.append(client.ask("evaluate", expression="channel_level_to_Monitor.waiting")["result"])
    # Sent; decided to be delivered, and delivered 0.2 s later; then the next message is sent.
    assert messages == ["0", "1", "1", "0", "1", "1"]
