# SPDX-License-Identifier: Apache-2.0
"""Code actions over standard input and output: restricted to the requested kinds, and resolved when they are
selected."""

from __future__ import annotations

from pathlib import Path

import attrs
from client import Client, connect
from lsprotocol import types
from test_lsp_navigate import place

from fixture import split_files

WARNED = """\
<!-- 🤖 --><ascxml name="A" version="1.0" initial="a">
    <state id="a">
        <transition event="e" target="a">
            <log expr="1" />
            <log expr="2" />
        </transition>
        <transition event="f" target="b" />
    </state>
</ascxml>
"""
SYSTEM = """\
-- main.xml --
<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
    </behavior_tree>
</roaml>
-- tree.xml --
<root BTCPP_format="4"><BehaviorTree ID="MainTree"><GoHome /></BehaviorTree></root>
"""

LAZY = types.ClientCapabilities(
    text_document=types.TextDocumentClientCapabilities(
        code_action=types.CodeActionClientCapabilities(
            data_support=True, resolve_support=types.ClientCodeActionResolveOptions(["edit"])
        )
    ),
    workspace=types.WorkspaceClientCapabilities(
        workspace_edit=types.WorkspaceEditClientCapabilities(
            document_changes=True,
            resource_operations=[types.ResourceOperationKind.Create, types.ResourceOperationKind.Rename],
        )
    ),
)


async def ask(client: Client, path: Path, text: str, at: str, *only: str) -> list[types.CodeAction]:
    """The code actions at a place, in the form of `place`."""
    position = place(path, text, at)[1]
    context = types.CodeActionContext([], only=list(only) or None)
    range_ = types.Range(position, position)
    params = types.CodeActionParams(types.TextDocumentIdentifier(path.as_uri()), range_, context)
    actions = await client.text_document_code_action_async(params)
    return [action for action in actions or () if isinstance(action, types.CodeAction)]


def applied(text: str, edits: list[types.TextEdit]) -> str:
    """The text after edits in UTF-16 positions."""
    lines = text.splitlines(keepends=True)

    def offset(position: types.Position) -> int:
        before = "".join(lines[: position.line])
        line = lines[position.line] if position.line < len(lines) else ""
        units = line.encode("utf-16-le")[: 2 * position.character]
        return len(before) + len(units.decode("utf-16-le"))

    for edit in sorted(edits, key=lambda e: offset(e.range.start), reverse=True):
        text = text[: offset(edit.range.start)] + edit.new_text + text[offset(edit.range.end) :]
    return text


def changed(action: types.CodeAction, path: Path, text: str) -> str:
    assert action.edit is not None
    assert action.edit.changes is not None
    return applied(text, list(action.edit.changes[path.as_uri()]))


async def test_a_client_that_does_not_resolve_gets_the_edits(tmp_path: Path) -> None:
    path = tmp_path / "a.ascxml"
    async with connect(tmp_path) as client:
        client.open(path, WARNED)
        actions = await ask(client, path, WARNED, 'target="|b"')
        added = next(action for action in actions if action.title == "Add the state `b`")
        assert added.kind == "quickfix"
        assert added.is_preferred
        assert [d.code for d in added.diagnostics or ()] == ["undefined-state"]
        assert changed(added, path, WARNED) == WARNED.replace("</state>", '</state>\n    <state id="b" />')


async def test_edits_are_made_when_an_action_is_resolved(tmp_path: Path) -> None:
    """An edit is computed for the text at the time of the resolution."""
    path = tmp_path / "a.ascxml"
    async with connect(tmp_path, capabilities=LAZY) as client:
        client.open(path, WARNED)
        actions = await ask(client, path, WARNED, "<l|og", "quickfix")
        assert [action.title for action in actions] == ["Remove `<log>`", "Fix all `ignored-element` in this file"]
        assert all(action.edit is None and action.data is not None for action in actions)
        resolved = await client.code_action_resolve_async(actions[1])
        assert "<log" not in changed(resolved, path, WARNED)
        later = WARNED.replace('<log expr="2" />', '<log expr="23" />')
        client.replace(path, later)
        one = changed(await client.code_action_resolve_async(actions[0]), path, later)
        assert one == later.replace('            <log expr="1" />\n', "")
        client.replace(path, WARNED.replace("<log", "<asign"), 3)
        gone = await client.code_action_resolve_async(actions[0])
        assert gone.edit is None


async def test_only_requested_kinds(tmp_path: Path) -> None:
    path = tmp_path / "a.ascxml"
    async with connect(tmp_path, capabilities=LAZY) as client:
        client.open(path, WARNED)
        whole = await ask(client, path, WARNED, "|<!--", "source.fixAll")
        assert [(action.kind, action.title) for action in whole] == [
            ("source.fixAll.as2fm", "Apply all safe fixes in this file")
        ]
        resolved = await client.code_action_resolve_async(whole[0])
        assert "<log" not in changed(resolved, path, WARNED)
        assert await ask(client, path, WARNED, "<l|og", "refactor") == []
        assert {action.kind for action in await ask(client, path, WARNED, "<l|og")} == {"quickfix"}


async def test_a_new_plugin(tmp_path: Path) -> None:
    for name, text in split_files(SYSTEM).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    tree = tmp_path / "tree.xml"
    text = tree.read_text(encoding="utf-8")
    title = "Create the plugin `GoHome` in `go_home.ascxml`"
    async with connect(tmp_path, capabilities=LAZY) as client:
        client.open(tree, language="xml")
        actions = await ask(client, tree, text, "<Go|Home", "refactor.extract")
        assert [action.title for action in actions] == [title, "Create a mock of `GoHome`"]
        edit = (await client.code_action_resolve_async(actions[0])).edit
        assert edit is not None
        create, content, listing = edit.document_changes or ()
        new = tmp_path / "go_home.ascxml"
        assert isinstance(create, types.CreateFile)
        assert create.uri == new.as_uri()
        assert isinstance(content, types.TextDocumentEdit)
        assert isinstance(listing, types.TextDocumentEdit)
        new.write_text(applied("", [e for e in content.edits if isinstance(e, types.TextEdit)]), encoding="utf-8")
        main = tmp_path / "main.xml"
        edits = [e for e in listing.edits if isinstance(e, types.TextEdit)]
        main.write_text(applied(main.read_text(encoding="utf-8"), edits), encoding="utf-8")
        client.changed(new, kind=types.FileChangeType.Created)
        client.changed(main)
        await client.until_codes(tree)


async def test_files_are_made_for_clients_that_can(tmp_path: Path) -> None:
    for name, text in split_files(SYSTEM).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    tree = tmp_path / "tree.xml"
    async with connect(tmp_path) as client:
        client.open(tree, language="xml")
        actions = await ask(client, tree, tree.read_text(encoding="utf-8"), "<Go|Home")
        assert not [action.title for action in actions if action.title.startswith("Create")]


async def test_an_action_of_nobody(tmp_path: Path) -> None:
    """An unknown action that a client sends is returned unchanged."""
    async with connect(tmp_path, capabilities=LAZY) as client:
        for data in (None, 3, {"uri": "file:///nowhere"}, {"uri": "file:///nowhere", "start": "x", "end": 1}):
            action = types.CodeAction("Do it", kind="quickfix", data=data)
            assert (await client.code_action_resolve_async(action)).edit is None


COUNTED = """\
-- main.xml --
<roaml>
    <parameters><max_time value="1" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt-plugin-ascxml" src="go.ascxml" />
    </behavior_tree>
</roaml>
-- go.ascxml --
<ascxml name="Go" version="1.0" initial="a">
    <state id="a">
        <bt_tick target="a"><bt_return_status status="SUCCESS" /></bt_tick>
        <bt_halt target="a"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- tree.xml --
<root BTCPP_format="4"><BehaviorTree ID="MainTree"><Go /></BehaviorTree></root>
"""


async def test_facts_travel_with_diagnostics(tmp_path: Path) -> None:
    """The client gets its own diagnostic back. Data that the client has invented have no effect."""
    for name, text in split_files(COUNTED).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    main = tmp_path / "main.xml"
    async with connect(tmp_path, capabilities=LAZY) as client:
        client.open(main, language="xml")
        await client.until(lambda: "input-count" in client.codes(main))
        counted = next(d for d in client.published[main.as_uri()].diagnostics if d.code == "input-count")
        assert counted.data == {"kind": "TREE"}

        async def fixed_by(sent: types.Diagnostic) -> list[types.Diagnostic]:
            actions = await client.fixes(main, counted.range, [sent])
            [action] = [action for action in actions if action.title == "List `tree.xml`"]
            resolved = await client.code_action_resolve_async(action)
            assert resolved.edit is not None
            return list(resolved.diagnostics or ())

        translated = attrs.evolve(counted, message="in another language")
        assert await fixed_by(translated) == [translated]
        for data in (None, {"kind": "NONSENSE"}, {"kind": ["TREE"]}, [1, 2], "TREE", {"kind": "TREE", "more": 1}):
            assert await fixed_by(attrs.evolve(translated, data=data)) == [counted]
