# SPDX-License-Identifier: Apache-2.0
"""`as2fm.verify`, with its lenses and hints, `as2fm/properties` and `as2fm/counterexample`."""

from __future__ import annotations

import asyncio
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from client import Client, connect
from lsprotocol import types
from pygls.exceptions import JsonRpcRequestCancelled

import clock
from as2fm_lsp.cli.main import run
from as2fm_lsp.handlers.results import COUNTEREXAMPLE, PROPERTIES, TRACE_STATE
from as2fm_lsp.handlers.results import VERIFY as COMMAND
from stuck_models import hospital

EXAMPLE = Path(__file__).parents[2] / "examples" / "assembly_robot"
PLACED = "block_placed"
QUICK = {"epsilon": 0.05, "silent": True}
ENDLESS = {"epsilon": 0.00001, "silent": True}
WHOLE = types.Range(types.Position(0, 0), types.Position(1000, 0))
WINDOW = types.WindowClientCapabilities(work_done_progress=True)


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """The assembly robot with its bug: every second block is lost."""
    shutil.copytree(EXAMPLE, tmp_path / "robot")
    return tmp_path / "robot"


async def verify(client: Client, main: Path, *arguments: Any) -> Any:
    params = types.ExecuteCommandParams(COMMAND, [main.as_uri(), *arguments])
    return await client.workspace_execute_command_async(params)


async def ask(client: Client, method: str, params: object) -> Any:
    """Send a custom request."""
    return plain(await client.protocol.send_request_async(method, params))


def plain(value: Any) -> Any:
    """Objects of the client's library as plain data."""
    if hasattr(value, "_asdict"):
        return {key: plain(member) for key, member in value._asdict().items()}
    return [plain(item) for item in value] if isinstance(value, list) else value


async def why(client: Client, main: Path, name: str) -> Any:
    return await ask(client, COUNTEREXAMPLE, {"textDocument": {"uri": main.as_uri()}, "property": name})


async def lenses(client: Client, path: Path) -> list[str]:
    params = types.CodeLensParams(types.TextDocumentIdentifier(path.as_uri()))
    code_lenses = await client.text_document_code_lens_async(params) or ()
    return [lens.command.title for lens in code_lenses if lens.command is not None]


async def hints(client: Client, path: Path) -> list[tuple[str, types.Position]]:
    params = types.InlayHintParams(types.TextDocumentIdentifier(path.as_uri()), WHOLE)
    inlay_hints = await client.text_document_inlay_hint_async(params) or ()
    return [(str(hint.label), hint.position) for hint in inlay_hints if hint.tooltip is not None]


async def test_results_are_those_of_the_command_line(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = robot / "main_with_bug.xml"
    run(["verify", str(main), "--epsilon", "0.05", "--format", "json", "--property", PLACED])
    (expected,) = json.loads(capsys.readouterr().out)["results"]
    async with connect(robot) as client:
        answer = await verify(client, main, [PLACED], QUICK)
    (result,) = answer["results"]
    assert answer["errors"] == []
    assert {key: result[key] for key in expected if key != "seconds"} == {
        key: value for key, value in expected.items() if key != "seconds"
    }
    assert result["lower"] < 0.5 < result["upper"]
    assert result["undecided"] == 0
    assert result["counterexample"] is True


async def test_all_properties_and_messages(robot: Path) -> None:
    main = robot / "main.xml"
    settings: dict[str, object] = {"verify": {"epsilon": 0.1, "expectations": {PLACED: "> 0.9", "nonsense": "much"}}}
    async with connect(robot, options={"settings": settings}) as client:
        answer = await verify(client, main)
        messages = [(message.type, message.message.splitlines()[0]) for message in client.messages]
    names = [row["property"] for row in answer["results"]]
    assert PLACED in names
    assert len(names) == len(set(names)) > 1
    placed = next(row for row in answer["results"] if row["property"] == PLACED)
    assert placed["expectations"][0]["expected"] == "> 0.9"
    assert messages[0] == (
        types.MessageType.Warning,
        "The expectation of nonsense must have a form like '>= 0.95', not 'much'.",
    )
    assert [text.split(":")[0] for kind, text in messages[1:] if kind is types.MessageType.Info] == names


async def test_properties_of_instances_have_a_lens_each(tmp_path: Path) -> None:
    """They are at the same place, so that their lenses and results name them."""
    folder = shutil.copytree(EXAMPLE.parent / "fleet", tmp_path / "fleet")
    main, properties = folder / "main.xml", folder / "delivers.xml"
    async with connect(folder) as client:
        client.open(properties, language="xml")
        names = [f"{robot}_delivers" for robot in ("anna", "bert", "carl")]
        assert await lenses(client, properties) == [f"Verify {name}" for name in names]
        rows = (await verify(client, main, ["bert_delivers"], QUICK))["results"]
        assert [row["property"] for row in rows] == ["bert_delivers"]
        ((text, _),) = await hints(client, properties)
        assert text.split()[1] == "bert_delivers"


async def test_lens_and_hint_show_the_result_until_it_is_stale(robot: Path) -> None:
    main, properties = robot / "main_with_bug.xml", robot / "properties.jani"
    (robot / "main.xml").unlink()
    arm = robot / "arm.ascxml"
    commands = {"showCounterexample": "editor.show", "debugCounterexample": "editor.debug"}
    async with connect(robot, options=commands) as client:
        client.open(properties, language="jani")
        before = await lenses(client, properties)
        assert before == ["Verify"] * len(before)
        assert "Verify all" in await lenses(client, main)
        assert await hints(client, properties) == []
        await verify(client, main, [PLACED], {**QUICK, "expectations": {PLACED: ">= 0.95"}})
        (known,) = (title for title in await lenses(client, properties) if " · " in title)
        assert known.startswith("Verify · minimum ≤ 0.")
        assert known.endswith("], not ≥ 0.95")
        assert {"Show counterexample", "Debug counterexample"} <= set(await lenses(client, properties))
        ((text, position),) = await hints(client, properties)
        assert text == known.replace("Verify · ", "✗ ")
        line = properties.read_text().splitlines()[position.line]
        assert line[: position.character].endswith(f'"{PLACED}"')
        text = arm.read_text()
        client.open(arm, text.replace("<state", "<state ", 1))
        assert f"{known}, stale" in await lenses(client, properties)
        client.replace(arm, text, 3)
        assert known in await lenses(client, properties)


async def test_a_result_is_shown_once_on_its_line(tmp_path: Path) -> None:
    """The result is in the hint if the client shows hints, otherwise in the lens."""
    clock.write(tmp_path)
    main, properties = tmp_path / "main.xml", tmp_path / "properties.jani"
    shows = types.TextDocumentClientCapabilities(inlay_hint=types.InlayHintClientCapabilities())
    capabilities = types.ClientCapabilities(text_document=shows)
    expected: dict[str, object] = {"verify": {"expectations": {"ticks": "< 0.5"}}}
    for settings in (expected, {**expected, "inlayHints": {"results": False}}):
        async with connect(tmp_path, capabilities=capabilities, options={"settings": settings}) as client:
            await verify(client, main, ["ticks"], {"silent": True})
            said = [*await lenses(client, properties), *(text for text, _ in await hints(client, properties))]
            assert len([text for text in said if "not < 0.5" in text]) == 1
            assert ("Verify" in said) is ("inlayHints" not in settings)


async def test_hints_can_be_left_out(tmp_path: Path) -> None:
    clock.write(tmp_path)
    main, properties = tmp_path / "main.xml", tmp_path / "properties.jani"
    async with connect(tmp_path, options={"settings": {"inlayHints": {"results": False}}}) as client:
        await verify(client, main, ["ticks"], {"silent": True})
        assert await hints(client, properties) == []
        assert any("Verify · 1, exact" in title for title in await lenses(client, properties))


async def test_the_client_is_asked_to_look_again(tmp_path: Path) -> None:
    clock.write(tmp_path)
    asked = types.CodeLensWorkspaceClientCapabilities(refresh_support=True)
    capabilities = types.ClientCapabilities(workspace=types.WorkspaceClientCapabilities(code_lens=asked))
    async with connect(tmp_path, capabilities=capabilities) as client:
        client.open(tmp_path / "main.xml", language="xml")
        await client.until(lambda: client.refreshed)
        for further in ({"silent": True}, {"silent": True, "seed": 1}):
            client.refreshed.clear()
            await verify(client, tmp_path / "main.xml", ["ticks"], further)
            await client.until(lambda: client.refreshed)
        client.refreshed.clear()
        client.open(tmp_path / "clock.ascxml", clock.CLOCK.replace("<ascxml ", "<ascxml  "))
        await client.until(lambda: client.refreshed)


async def test_properties_that_can_be_verified(tmp_path: Path) -> None:
    clock.write(tmp_path)
    main = tmp_path / "main.xml"
    async with connect(tmp_path) as client:
        (system,) = await ask(client, PROPERTIES, None)
        assert system["uri"] == main.as_uri()
        (ticks,) = system["properties"]
        start, end = ticks["range"]["start"], ticks["range"]["end"]
        line = clock.PROPERTIES.splitlines()[start["line"]]
        assert line[start["character"] : end["character"]] == ticks["name"] == "ticks"
        assert ticks["uri"] == (tmp_path / "properties.jani").as_uri()
        assert "stale" not in ticks
        await verify(client, main, ["ticks"], {"silent": True})
        ((ticks,),) = [row["properties"] for row in await ask(client, PROPERTIES, None)]
        assert ticks["stale"] is False
        client.open(tmp_path / "clock.ascxml", clock.CLOCK.replace("% 10", "% 9"))
        ((ticks,),) = [row["properties"] for row in await ask(client, PROPERTIES, None)]
        assert ticks["stale"] is True


async def test_systems_with_properties_are_in_the_order_of_their_paths(tmp_path: Path) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        clock.write(tmp_path / name)
    mains = [(tmp_path / name / "main.xml").as_uri() for name in ("one", "two")]
    async with connect(tmp_path) as client:
        client.open(tmp_path / "two" / "clock.ascxml")
        assert [system["uri"] for system in await ask(client, PROPERTIES, None)] == mains


async def test_counterexample_leads_to_the_models(robot: Path) -> None:
    main = robot / "main_with_bug.xml"
    async with connect(robot) as client:
        assert await why(client, main, PLACED) is None
        await verify(client, main, [PLACED], {**QUICK, "expectations": {PLACED: ">= 0.95"}})
        explanation = await why(client, main, PLACED)
    assert (explanation["property"], explanation["verdict"], explanation["stale"]) == (PLACED, "failed", False)
    assert explanation["expected"] == "≥ 0.95"
    assert explanation["heading"].startswith(
        "The block reaches its place. By chance (0.5), Arm sends /block/dropped (data: "
    )
    assert f"; {PLACED} fails at " in explanation["heading"]
    assert f". {PLACED} failed in trace {explanation['trace']} after " in explanation["heading"]
    steps = explanation["steps"]
    assert " turns matter" in explanation["heading"]
    summary = explanation["summary"]
    assert summary.startswith(f"{PLACED} failed in trace {explanation['trace']} after ")
    assert summary.endswith(" turns matter")
    numbers = [step["step"] for step in steps]
    assert numbers == sorted(numbers)
    arm = (robot / "arm.ascxml").as_uri()
    first = next(step for step in steps if step["who"] == "Arm")
    assert first["uri"] == arm
    line = (robot / "arm.ascxml").read_text().splitlines()[first["range"]["start"]["line"]]
    assert line[first["range"]["start"]["character"] :].startswith("<")
    nodes = [mark["node"] for step in steps for mark in step["highlights"] if mark["uri"] == arm]
    assert "/still" in nodes
    assert {mark["kind"] for step in steps for mark in step["highlights"]} == {"machine", "tree"}
    assert all(step["time"].endswith(" s") for step in steps if step["who"])


async def test_the_sentence_of_a_property_is_before_the_cause(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLE.parent / "delivery_robot", tmp_path / "robot")
    main, name = tmp_path / "robot" / "main.xml", "never_delivers_when_empty"
    tree = tmp_path / "robot" / "tree.xml"
    tree.write_text(tree.read_text().replace('level="30"', 'level="0"'))
    async with connect(tmp_path / "robot") as client:
        await verify(client, main, [name], {**QUICK, "expectations": {name: ">= 0.95"}})
        explanation = await why(client, main, name)
    assert explanation["heading"].startswith("hands_over && battery <= 10 never holds. By chance (0.2), Building ")


async def test_the_whole_state_at_a_step_of_a_counterexample(robot: Path) -> None:
    main = robot / "main_with_bug.xml"
    async with connect(robot) as client:
        await verify(client, main, [PLACED], {**QUICK, "expectations": {PLACED: ">= 0.95"}})
        explanation = await why(client, main, PLACED)
        drop = next(step for step in explanation["steps"] if "holding: true → false" in step["details"])
        params = {"textDocument": {"uri": main.as_uri()}, "property": PLACED, "trace": explanation["trace"]}
        steps = {"step": drop["lastStep"], "earlier": drop["step"] - 1}
        groups = {group["name"]: group for group in await ask(client, TRACE_STATE, {**params, **steps})}
        same = {"step": drop["step"], "earlier": drop["step"]}
        unchanged = await ask(client, TRACE_STATE, {**params, **same})
        beyond = await ask(client, TRACE_STATE, {**params, "step": 1 << 40, "earlier": 0})
    arm = groups["Arm"]
    assert (arm["value"], arm["hasChanged"], arm["before"]) == ("moving", True, None)
    holding = next(row for row in arm["rows"] if row["name"] == "holding")
    assert (holding["value"], holding["before"], holding["hasChanged"]) == ("false", "true", True)
    assert not groups["PickUp"]["hasChanged"]
    assert {"Tree", "Messages", "Time"} <= groups.keys()
    assert not any(group["hasChanged"] for group in unchanged)
    assert beyond


async def test_tree_nodes_are_lit(tmp_path: Path) -> None:
    robot = tmp_path / "robot"
    shutil.copytree(EXAMPLE.parent / "delivery_robot", robot)
    (robot / "as2fm.toml").write_text('[verify]\nscheduler = "uniform"\n')
    main, name = robot / "main.xml", "all_delivered"
    async with connect(robot) as client:
        await verify(client, main, [name], {**QUICK, "expectations": {name: "<= 0.5"}})
        explanation = await why(client, main, name)
        document = {"textDocument": {"uri": main.as_uri()}}
        tree = await ask(client, "as2fm/picture", {**document, "kind": "tree"})
        at = {"trace": explanation["trace"], "step": 1, "earlier": 0}
        groups = await ask(client, TRACE_STATE, {**document, "property": name, **at})
    # The property holds, which is not expected, so the story is that of a trace in which it holds.
    assert (explanation["verdict"], explanation["expected"]) == ("passed", "≤ 0.5")
    nodes = {mark["node"] for step in explanation["steps"] for mark in step["highlights"] if mark["kind"] == "tree"}
    assert nodes
    assert nodes <= {node["id"] for node in tree["nodes"]}
    # The observers of other properties are not a part of the user's model.
    machines = {group["name"] for group in groups}
    assert "Battery" in machines
    assert not any(name.endswith("__observer") for name in machines)


async def test_progress_contains_the_estimate(robot: Path) -> None:
    async with connect(robot, capabilities=types.ClientCapabilities(window=WINDOW)) as client:
        working = asyncio.ensure_future(verify(client, robot / "main_with_bug.xml", [PLACED], ENDLESS))
        token, said = await until_estimate(client, working)
        client.window_work_done_progress_cancel(types.WorkDoneProgressCancelParams(token))
        assert await working is None
        reports = client.progress_reports[token]
    assert isinstance(reports[0], types.WorkDoneProgressBegin)
    assert (reports[0].title, reports[0].cancellable) == ("Verifying main_with_bug.xml", True)
    assert isinstance(reports[-1], types.WorkDoneProgressEnd)
    assert said.startswith(f"{PLACED}: 0.")
    assert said.endswith(" traces")


async def until_estimate(client: Client, working: asyncio.Future[object]) -> tuple[str | int, str]:
    """The token of the verification's progress, and an estimate that was shown. The check of the models may also show
    its progress."""
    working.add_done_callback(lambda _: client.news.set())
    await client.until(lambda: working.done() or any(estimates(client)))
    for estimate in estimates(client):
        return estimate
    raise AssertionError(f"no estimate was told before the end: {await working}")


def estimates(client: Client) -> Iterator[tuple[str | int, str]]:
    """The published estimates, each with the token of its progress."""
    for token, reports in client.progress_reports.items():
        for report in reports:
            if isinstance(report, types.WorkDoneProgressReport) and "traces" in (report.message or ""):
                yield token, str(report.message)


async def test_the_server_answers_during_verification_and_can_cancel_it(robot: Path) -> None:
    main, properties = robot / "main_with_bug.xml", robot / "properties.jani"
    async with connect(robot, capabilities=types.ClientCapabilities(window=WINDOW)) as client:
        working = asyncio.ensure_future(verify(client, main, [PLACED], ENDLESS))
        await until_estimate(client, working)
        before = await lenses(client, properties)
        assert before
        assert not working.done()
        request = next(iter(client.protocol._request_futures))
        client.protocol.notify(types.CANCEL_REQUEST, types.CancelParams(request))
        with pytest.raises((JsonRpcRequestCancelled, asyncio.CancelledError)):
            await working
        assert await lenses(client, properties) == before


async def test_ending_does_not_wait_for_the_answer(robot: Path) -> None:
    async with connect(robot, capabilities=types.ClientCapabilities(window=WINDOW)) as client:
        working = asyncio.ensure_future(verify(client, robot / "main_with_bug.xml", [PLACED], ENDLESS))
        await until_estimate(client, working)
        assert not working.done()
    await asyncio.gather(working, return_exceptions=True)
    assert client._server is not None
    assert client._server.returncode == 0


async def test_errors_of_the_model_have_their_place(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    async with connect(tmp_path) as client:
        answer = await verify(client, tmp_path / "main.xml")
        (error,) = answer["errors"]
        assert answer["results"] == []
        assert (error["code"], error["uri"]) == ("undeclared-variable", (tmp_path / "clock.ascxml").as_uri())
        assert error["range"]["start"] == {"line": 8, "character": 30}
        missing = await verify(client, tmp_path / "none.xml", [], {"silent": True})
        assert missing["errors"][0]["message"].endswith("none.xml: not a system file")
        assert [message.message for message in client.messages] == ["main.xml has 1 error and was not verified."]


async def test_a_property_that_is_not_there_does_not_keep_others_from_being_verified(tmp_path: Path) -> None:
    clock.write(tmp_path)
    async with connect(tmp_path) as client:
        answer = await verify(client, tmp_path / "main.xml", ["tocks", "ticks"], {"silent": True})
        tocks, ticks = answer["results"]
        assert tocks["error"]["message"] == "the model has no property `tocks`; its properties are: ticks, stuck"
        assert ticks["probability"] > 0.9
        assert await client.workspace_execute_command_async(types.ExecuteCommandParams(COMMAND, [])) is None
        assert [message.type for message in client.messages] == [types.MessageType.Error]


async def test_a_stuck_system_is_reported_with_its_waiting_automata(tmp_path: Path) -> None:
    for name, text in hospital().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    main, properties = tmp_path / "main.xml", tmp_path / "properties.jani"
    async with connect(tmp_path, options={"showCounterexample": "editor.show"}) as client:
        answer = await verify(client, main, ["delivered"], {"epsilon": 0.05})
        (result,) = answer["results"]
        assert result["ends"]["stuck"] == result["failed"] > 0
        known = answer["stuck"]
        assert known["level"] == "warning"
        last = known["example"]["waits"][-1]
        assert (last["who"], last["uri"]) == ("Pharmacy", (tmp_path / "pharmacy.ascxml").as_uri())
        lines = (tmp_path / "pharmacy.ascxml").read_text(encoding="utf-8").splitlines()
        assert "ros_rate_callback" in lines[last["range"]["start"]["line"]]
        messages = [message for message in client.messages if message.type is types.MessageType.Warning]
        assert [message.message for message in messages] == [known["text"]]
        assert "Fetch waits in `asked` for the response of the service `/ward/prepare`" in known["text"]
        assert known["text"].startswith("probability of getting stuck: ")
        assert known["text"].endswith(" [answer-needs-time]")
        assert "traces got stuck, because machines wait for each other for ever; they say" in result["warning"]
        (own,) = (message.message for message in client.messages if message.message.startswith("delivered: "))
        assert own.splitlines()[1].endswith(
            "so its value is doubtful; who waits for whom is shown in a separate message"
        )
        # The lens of the property and the lens of the system.
        assert f"{result['ends']['stuck']:,} traces got stuck" in " ".join(await lenses(client, properties))
        assert "Show counterexample" in await lenses(client, properties)
        assert "Gets stuck: show the waiting automata" in await lenses(client, main)
        ((hint, _),) = await hints(client, properties)
        assert hint.startswith("⚠ ")
        for name in ("delivered", "stuck"):
            explanation = await why(client, main, name)
            assert [step["who"] for step in explanation["steps"]][-4:] == [
                "the clock",
                "the tree",
                "Fetch",
                "Pharmacy",
            ]
            assert explanation["steps"][-1]["highlights"][0]["node"] == "/busy"
        silent = await verify(client, main, ["delivered"], {**QUICK, "stuck": "error"})
        assert silent["stuck"]["level"] == "error"
        asked = await verify(client, main, ["stuck"], QUICK)
        assert asked["results"][0]["property"] == "stuck"
        assert asked["stuck"]["example"]["waits"] == known["example"]["waits"]
        # After the fix, the old result is stale and the new one is as expected.
        fetch = tmp_path / "fetch.ascxml"
        client.open(fetch, hospital(mended=True)["fetch.ascxml"])
        assert "Gets stuck, stale: show the waiting automata" in await lenses(client, main)
        mended = await verify(client, main, ["delivered"], QUICK)
        assert mended["stuck"]["example"] is None
        assert [title for title in await lenses(client, main) if "stuck" in title] == []


async def test_a_level_that_is_none(tmp_path: Path) -> None:
    clock.write(tmp_path)
    async with connect(tmp_path, options={"settings": {"verify": {"stuck": "loud"}}}) as client:
        answer = await verify(client, tmp_path / "main.xml")
        assert answer["stuck"]["level"] == "warning"
        messages = [message.message for message in client.messages if message.type is types.MessageType.Warning]
        assert messages == ["verify.stuck must be one of warning, error, not 'loud'."]
