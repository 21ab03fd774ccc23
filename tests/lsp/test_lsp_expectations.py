# SPDX-License-Identifier: Apache-2.0
"""Expectations set from results: a known result is compared with them at once, without new traces."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

from client import Client, connect
from lsprotocol import types
from test_lsp_verify import QUICK, WINDOW, ask, estimates, hints, lenses, plain, verify, why

import clock
from as2fm_lsp.handlers.expectation import EXPECTATIONS, SET_EXPECTATION
from as2fm_lsp.handlers.results import COUNTEREXAMPLE, PROPERTIES
from fixture import split_files

COIN = split_files(
    """\
-- main.xml --
<roaml>
    <parameters>
        <max_time value="5" unit="s" />
    </parameters>
    <node_models>
        <input type="node-ascxml" src="coin.ascxml" />
    </node_models>
    <properties>
        <input type="xml" src="properties.xml" />
    </properties>
</roaml>
-- coin.ascxml --
<ascxml name="Coin" version="1.0" initial="ready">
    <ros_topic_publisher name="heads" topic="/heads" type="std_msgs/Bool" />
    <ros_topic_publisher name="thrown" topic="/thrown" type="std_msgs/Bool" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="ready">
        <ros_rate_callback name="second">
            <target id="lying" prob="0.5">
                <ros_topic_publish name="heads"><field name="data" expr="true" /></ros_topic_publish>
                <ros_topic_publish name="thrown"><field name="data" expr="true" /></ros_topic_publish>
            </target>
            <target id="lying">
                <ros_topic_publish name="thrown"><field name="data" expr="true" /></ros_topic_publish>
            </target>
        </ros_rate_callback>
    </state>
    <state id="lying" />
</ascxml>
-- properties.xml --
<properties>
    <ports>
        <ros_topic topic_name="/heads" type="std_msgs/Bool" event="publish"><event_var id="heads" /></ros_topic>
        <ros_topic topic_name="/thrown" type="std_msgs/Bool" event="publish"><event_var id="thrown" /></ros_topic>
    </ports>
    <guarantees>
        <property id="heads_up" pattern="existence">
            <event>heads</event>
            <scope type="globally" />
        </property>
        <property id="it_is_thrown" pattern="existence">
            <event>thrown</event>
            <scope type="globally" />
        </property>
    </guarantees>
</properties>
"""
)
HEADS, THROWN = "heads_up", "it_is_thrown"
COMMANDS = {
    "showCounterexample": "editor.show",
    "showWitness": "editor.witness",
    "setExpectation": "editor.expect",
}


def coin(folder: Path) -> tuple[Path, Path]:
    for name, text in COIN.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "main.xml", folder / "properties.xml"


async def set_expectation(client: Client, main: Path, name: str, expected: str) -> Any:
    params = {"textDocument": {"uri": main.as_uri()}, "property": name, "expected": expected}
    return await ask(client, SET_EXPECTATION, params)


async def suggested(client: Client, main: Path, name: str) -> Any:
    return await ask(client, EXPECTATIONS, {"textDocument": {"uri": main.as_uri()}, "property": name})


def changed(text: str, edits: list[Any]) -> str:
    """A text after edits in one line each."""
    lines = text.splitlines(keepends=True) or [""]
    for edit in reversed(edits):
        start, end = edit["range"]["start"], edit["range"]["end"]
        assert start["line"] == end["line"]
        line = lines[start["line"]]
        lines[start["line"]] = line[: start["character"]] + edit["newText"] + line[end["character"] :]
    return "".join(lines)


async def test_an_expectation_is_set_beside_a_property_in_xml(tmp_path: Path) -> None:
    main, file = coin(tmp_path)
    text = file.read_text(encoding="utf-8")
    async with connect(tmp_path, options=COMMANDS) as client:
        client.open(file, text, language="xml")
        assert (await suggested(client, main, HEADS))["suggestions"] == []
        first = (await verify(client, main, [HEADS], QUICK))["results"][0]
        assert first["verdict"] == "no expectation set"
        ((hint, _),) = await hints(client, file)
        assert hint.startswith("= 0.")
        assert hint.endswith("], no expectation set")
        shown = await lenses(client, file)
        assert {"Set expectation", "Show counterexample", "Show witness"} <= set(shown)
        known = await suggested(client, main, HEADS)
        assert known["file"] == "properties.xml"
        lower, upper = known["suggestions"]
        assert lower.startswith(">= 0.4")
        assert upper.startswith("<= 0.5")
        answer = await set_expectation(client, main, HEADS, ">= 0.9")
        assert answer["problem"] == ""
        assert answer["uri"] == file.as_uri()
        (edits,) = answer["edit"]["changes"].values()
        expected = changed(text, edits)
        assert '<property id="heads_up" pattern="existence" expect=">= 0.9">' in expected
        # The known result is compared at once. It is not stale, because its traces are the same.
        client.replace(file, expected)
        ((hint, _),) = await hints(client, file)
        assert hint.startswith("✗ 0.")
        assert hint.endswith("], not ≥ 0.9")
        assert "Set expectation" not in await lenses(client, file)
        ((row, _),) = [system["properties"] for system in await ask(client, PROPERTIES, None)]
        assert row["stale"] is False
        assert (row["result"]["verdict"], row["result"]["traces"]) == ("not met", first["traces"])
        assert (row["result"]["probability"], row["result"]["lower"]) == (first["probability"], first["lower"])
        # A weaker expectation is met. A text that is not a number is not an expectation.
        refused = await set_expectation(client, main, HEADS, "often")
        assert refused["problem"].startswith("`often` is not an expectation")
        (edits,) = (await set_expectation(client, main, HEADS, "< 0.9"))["edit"]["changes"].values()
        assert 'expect="&lt; 0.9"' in changed(expected, edits)
        client.replace(file, changed(expected, edits), 3)
        ((hint, _),) = await hints(client, file)
        assert hint.startswith("✓ 0.")
        # A change of the property itself makes the result stale.
        client.replace(file, expected.replace("<event>heads<", "<event>thrown<"), 4)
        ((hint, _),) = await hints(client, file)
        assert hint.endswith("stale")


async def test_an_expectation_is_set_in_the_configuration(tmp_path: Path) -> None:
    clock.write(tmp_path)
    main, file, configuration = tmp_path / "main.xml", tmp_path / "properties.jani", tmp_path / "as2fm.toml"
    async with connect(tmp_path, options=COMMANDS) as client:
        client.open(file, language="jani")
        await verify(client, main, ["ticks"], {"silent": True, "seed": 0})
        known = await suggested(client, main, "ticks")
        assert (known["file"], known["suggestions"][0]) == ("as2fm.toml", ">= 1")
        answer = await set_expectation(client, main, "ticks", known["suggestions"][0])
        create, edit = answer["edit"]["documentChanges"]
        assert (create["kind"], create["uri"]) == ("create", configuration.as_uri())
        configuration.write_text(edit["edits"][0]["newText"], encoding="utf-8")
        client.changed(configuration, kind=types.FileChangeType.Created)
        ((hint, _),) = await hints(client, file)
        assert hint == "✓ 1 [0.98, 1]", "the exact value of all schedulers is known, and is 1"
        (edits,) = (await set_expectation(client, main, "ticks", "< 0.5"))["edit"]["changes"].values()
        configuration.write_text(changed(configuration.read_text(encoding="utf-8"), edits), encoding="utf-8")
        client.changed(configuration)
        ((hint, _),) = await hints(client, file)
        assert hint.endswith("not < 0.5")
        configuration.write_text('verify = "much"\n', encoding="utf-8")
        client.changed(configuration)
        problem = (await set_expectation(client, main, "ticks", "< 0.5"))["problem"]
        assert problem == 'cannot change as2fm.toml; add `ticks = "< 0.5"` to `verify.expect`'


async def test_a_hint_begins_with_the_value_and_its_system_if_there_are_several(tmp_path: Path) -> None:
    """Editors cut long hints."""
    clock.write(tmp_path)
    main, other, file = (tmp_path / name for name in ("main.xml", "other.xml", "properties.jani"))
    other.write_text(main.read_text(encoding="utf-8"), encoding="utf-8")
    async with connect(tmp_path, options=COMMANDS) as client:
        client.open(file, language="jani")
        await verify(client, main, ["ticks"], {"silent": True})
        ((hint, _),) = await hints(client, file)
        assert hint == "= 1, exact in main.xml, no expectation set"


async def test_exact_values_are_shown_and_judged_again(tmp_path: Path) -> None:
    """The system is small, so its value is exact. The traces remain as examples."""
    clock.write(tmp_path)
    main, file, configuration = tmp_path / "main.xml", tmp_path / "properties.jani", tmp_path / "as2fm.toml"
    async with connect(tmp_path, options=COMMANDS) as client:
        client.open(file, language="jani")
        (row,) = (await verify(client, main, ["ticks"], {"silent": True}))["results"]
        assert (row["short"], row["method"], row["probability"], row["exact"]["least"]) == ("1, exact", "exact", 1, 1)
        ((hint, _),) = await hints(client, file)
        assert hint == "= 1, exact, no expectation set"
        assert (await suggested(client, main, "ticks"))["suggestions"] == [">= 1"]
        assert "Show witness" in await lenses(client, file)
        for expected, judged in ((">= 1", "✓ 1, exact"), ("< 0.5", "✗ 1, exact, not < 0.5")):
            configuration.write_text(f'[verify.expect]\nticks = "{expected}"\n', encoding="utf-8")
            client.changed(configuration)
            ((hint, _),) = await hints(client, file)
            assert hint == judged
    settings: dict[str, object] = {"verify": {"exactIfSmall": False}}
    async with connect(tmp_path, options={"settings": settings}) as client:
        (row,) = (await verify(client, main, ["ticks"], {"silent": True}))["results"]
        assert row["short"].startswith("1 [0.9")


async def test_the_editors_settings_judge_as_well(tmp_path: Path) -> None:
    clock.write(tmp_path)
    main, file = tmp_path / "main.xml", tmp_path / "properties.jani"
    async with connect(tmp_path) as client:
        client.open(file, language="jani")
        await verify(client, main, ["ticks"], {"silent": True})
        settings = {"as2fm": {"verify": {"expectations": {"ticks": "< 0.5"}}}}
        client.workspace_did_change_configuration(types.DidChangeConfigurationParams(settings))
        ((hint, _),) = await hints(client, file)
        assert hint.endswith("not < 0.5")


async def test_code_actions_set_what_the_result_suggests(tmp_path: Path) -> None:
    main, file = coin(tmp_path)
    line = next(i for i, text in enumerate(file.read_text(encoding="utf-8").splitlines()) if THROWN in text)
    async with connect(tmp_path) as client:
        client.open(file, language="xml")

        async def actions() -> dict[str, types.CodeAction]:
            place = types.Range(types.Position(line, 20), types.Position(line, 20))
            context = types.CodeActionContext([], only=[types.CodeActionKind.Refactor])
            params = types.CodeActionParams(types.TextDocumentIdentifier(file.as_uri()), place, context)
            offered = await client.text_document_code_action_async(params) or ()
            return {action.title: action for action in offered if isinstance(action, types.CodeAction)}

        assert await actions() == {}
        await verify(client, main, [THROWN], {**QUICK, "epsilon": 0.01})
        known = await actions()
        assert list(known) == [f"Expect >= 1 of `{THROWN}`", f"Expect >= 0.98 of `{THROWN}`"]
        edit = known[f"Expect >= 1 of `{THROWN}`"].edit
        assert edit is not None
        assert edit.changes is not None
        ((text_edit,),) = edit.changes.values()
        assert text_edit.new_text == ' expect=">= 1"'


async def test_a_quick_fix_moves_expectations_to_the_configuration(tmp_path: Path) -> None:
    _, file = coin(tmp_path)
    configuration = tmp_path / "as2fm.toml"
    configuration.write_text('exclude = ["attic/"]\n', encoding="utf-8")
    text = COIN["properties.xml"].replace('id="heads_up"', 'id="heads_up" expect="&gt;= 0.4"')
    line = next(i for i, row in enumerate(text.splitlines()) if HEADS in row)
    async with connect(tmp_path, options=COMMANDS) as client:
        client.open(file, text, language="xml")
        place = types.Range(types.Position(line, 0), types.Position(line + 1, 0))
        context = types.CodeActionContext([], only=[types.CodeActionKind.QuickFix])
        params = types.CodeActionParams(types.TextDocumentIdentifier(file.as_uri()), place, context)
        offered = await client.text_document_code_action_async(params) or ()
        (action,) = (a for a in offered if isinstance(a, types.CodeAction) and a.title.startswith("Move"))
        assert action.title == "Move the expectation to `as2fm.toml`"
        assert action.diagnostics is not None
        assert [diagnostic.code for diagnostic in action.diagnostics] == ["unportable-expectation"]
        assert action.edit is not None
        assert set(action.edit.changes or {}) == {file.as_uri(), configuration.as_uri()}


async def test_both_sides_are_explained(tmp_path: Path) -> None:
    main, _ = coin(tmp_path)
    async with connect(tmp_path) as client:
        await verify(client, main, [HEADS, THROWN], {**QUICK, "expectations": {HEADS: ">= 0.3"}})
        assert (await why(client, main, HEADS))["verdict"] == "failed"
        params = {"textDocument": {"uri": main.as_uri()}, "property": HEADS, "witness": True}
        witness = await ask(client, COUNTEREXAMPLE, params)
        assert (witness["verdict"], witness["property"]) == ("passed", HEADS)
        assert any("/heads" in detail for step in witness["steps"] for detail in step["details"])
        assert await why(client, main, THROWN) is None
        assert (await ask(client, COUNTEREXAMPLE, {**params, "property": THROWN}))["verdict"] == "passed"


async def test_shared_traces_give_the_results_of_separate_ones(tmp_path: Path) -> None:
    main, _ = coin(tmp_path)
    async with connect(tmp_path, capabilities=types.ClientCapabilities(window=WINDOW)) as client:
        together = await verify(client, main, [HEADS, "none", THROWN], {**QUICK, "partialResultToken": "tests"})
        alone = [(await verify(client, main, [name], QUICK))["results"][0] for name in (HEADS, THROWN)]
        said = [getattr(r, "message", "") or "" for reports in client.progress_reports.values() for r in reports]
    first, missing, second = together["results"]
    assert "2 properties from the same traces" in said
    assert missing["error"]["message"].startswith("the model has no property `none`")
    for row in (first, second, *alone):
        row.pop("seconds")
    assert [first, second] == alone
    parts = [plain(part) for part in client.parts["tests"]]
    assert [part["property"] for part in parts] == ["none", HEADS, THROWN]


async def test_cancelled_work_keeps_what_is_complete(tmp_path: Path) -> None:
    main, file = coin(tmp_path)
    options = {"silent": True, "epsilon": 0.0005, "partialResultToken": "tests"}
    async with connect(tmp_path, capabilities=types.ClientCapabilities(window=WINDOW)) as client:
        client.open(file, language="xml")
        working = asyncio.ensure_future(verify(client, main, [HEADS, THROWN], options))
        await client.until(lambda: any(said.startswith("1 of 2 properties") for _, said in estimates(client)))
        token = next(token for token, said in estimates(client) if said.startswith("1 of 2 properties"))
        client.window_work_done_progress_cancel(types.WorkDoneProgressCancelParams(token))
        assert await working is None
        parts = [plain(part) for part in client.parts["tests"]]
        assert [(part["property"], part["interrupted"]) for part in parts] == [(THROWN, False)]
        ((hint, _),) = await hints(client, file)
        assert hint.startswith("? minimum undecided; uniform 1 [0.99")
