# SPDX-License-Identifier: Apache-2.0
"""Hints, lenses, signatures, hover and type hierarchy over standard input and output."""

from __future__ import annotations

import json
from pathlib import Path

from client import REFRESHES, Client, connect
from ide_models import ROBOT, load
from lsprotocol import types
from test_lsp_navigate import place

from as2fm_lsp.display_settings import OFF_BY_DEFAULT
from fixture import split_files
from roaml.ide.inlay_hints import HintKind

EXTENSION = Path(__file__).parents[2] / "vscode-extension"
MARKDOWN = [types.MarkupKind.Markdown, types.MarkupKind.PlainText]
WHOLE = types.Range(types.Position(0, 0), types.Position(1000, 0))


def capabilities(**further: object) -> types.ClientCapabilities:
    return types.ClientCapabilities(
        text_document=types.TextDocumentClientCapabilities(**further),  # type: ignore[arg-type]
        workspace=types.WorkspaceClientCapabilities(
            inlay_hint=types.InlayHintWorkspaceClientCapabilities(refresh_support=True),
            code_lens=types.CodeLensWorkspaceClientCapabilities(refresh_support=True),
        ),
    )


def document(path: Path) -> types.TextDocumentIdentifier:
    return types.TextDocumentIdentifier(path.as_uri())


async def hints(client: Client, path: Path, range_: types.Range = WHOLE) -> list[types.InlayHint]:
    inlay_hints = await client.text_document_inlay_hint_async(types.InlayHintParams(document(path), range_))
    return list(inlay_hints or ())


def label(hint: types.InlayHint) -> str:
    return hint.label if isinstance(hint.label, str) else "".join(part.value for part in hint.label)


def test_every_kind_of_hint_is_a_setting() -> None:
    """The defaults are the same in VS Code and in the server."""
    settings = json.loads((EXTENSION / "package.json").read_text(encoding="utf-8"))["contributes"]["configuration"]
    texts = json.loads((EXTENSION / "package.nls.json").read_text(encoding="utf-8"))
    prefix = "as2fm.inlayHints."
    defaults = {
        name.removeprefix(prefix): setting["default"]
        for group in (settings if isinstance(settings, list) else [settings])
        for name, setting in group["properties"].items()
        if name.startswith(prefix)
    }
    assert defaults == {"results": True} | {kind.value: kind not in OFF_BY_DEFAULT for kind in HintKind}
    assert all(texts[f"settings.inlayHints.{name}"] for name in defaults)


async def test_hints_are_explained_on_demand(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    asks = types.InlayHintClientCapabilities(
        resolve_support=types.ClientInlayHintResolveOptions(["label.tooltip", "label.location"])
    )
    async with connect(tmp_path, capabilities=capabilities(inlay_hint=asks)) as client:
        inlay_hints = await hints(client, tmp_path / "a.ascxml")
        assert [label(hint) for hint in inlay_hints] == [" : Pose", "(to : Pose)", " → /a/b"]
        assert [hint.kind for hint in inlay_hints] == [types.InlayHintKind.Type, types.InlayHintKind.Type, None]
        resolved = await client.inlay_hint_resolve_async(inlay_hints[0])
        assert not isinstance(resolved.label, str)
        part = resolved.label[1]
        assert isinstance(part.tooltip, types.MarkupContent)
        assert "struct Pose" in part.tooltip.value
        assert part.location is not None
        assert part.location.uri.endswith("types.xml")
        line = types.Range(types.Position(5, 0), types.Position(5, 80))
        assert [label(hint) for hint in await hints(client, tmp_path / "a.ascxml", line)] == ["(to : Pose)"]


async def test_a_client_that_does_not_ask_again_gets_plain_hints(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    async with connect(tmp_path) as client:
        inlay_hints = await hints(client, tmp_path / "tree.xml")
        assert [hint.label for hint in inlay_hints] == [" bt_1000", " bt_1001", " bt_1002"]
        assert all(hint.data is None for hint in inlay_hints)


async def test_settings_say_which_are_shown(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    settings: dict[str, object] = {"inlayHints": {"types": False, "ports": True}, "codeLens": False}
    async with connect(tmp_path, settings=settings) as client:
        # The server requests the settings after the initialization, and continues meanwhile.
        while [label(hint) for hint in await hints(client, tmp_path / "a.ascxml")] != ["(to : Pose)", " → /a/b"]:
            continue
        assert " : int32" in [hint.label for hint in await hints(client, tmp_path / "tree.xml")]
        lenses = types.CodeLensParams(document(tmp_path / "a.ascxml"))
        assert not await client.text_document_code_lens_async(lenses)
        params = types.DidChangeConfigurationParams({"as2fm": {"inlayHints": False}})
        client.set_configuration({"as2fm": {"inlayHints": False}})
        client.workspace_did_change_configuration(params)
        while await hints(client, tmp_path / "tree.xml"):
            continue
        assert await client.text_document_code_lens_async(lenses)


async def test_lenses_say_how_much_is_used(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    plugin = tmp_path / "plugin.ascxml"
    for command in ("", "as2fm.showReferences"):
        async with connect(tmp_path, options={"showReferences": command}) as client:
            lenses = await client.text_document_code_lens_async(types.CodeLensParams(document(plugin)))
            assert lenses
            assert all(lens.command is None for lens in lenses)
            resolved = await client.code_lens_resolve_async(lenses[0])
            assert resolved.command is not None
            assert (resolved.command.title, resolved.command.command) == ("2 uses in trees", command)
            arguments = resolved.command.arguments
            assert bool(arguments) == bool(command)
            if arguments:
                assert arguments[0] == plugin.as_uri()
                assert len(arguments) == 3
            main = await client.text_document_code_lens_async(types.CodeLensParams(document(tmp_path / "main.xml")))
            assert [lens.command.title for lens in main or () if lens.command] == ["Translate to JANI", "Verify all"]


async def test_the_client_is_told_when_other_files_change_them(tmp_path: Path) -> None:
    files = split_files(ROBOT)
    load(tmp_path, files)
    machine, plugin = tmp_path / "a.ascxml", tmp_path / "plugin.ascxml"
    async with connect(tmp_path, capabilities=capabilities()) as client:
        client.open(machine)
        client.open(plugin)
        await client.until(lambda: client.refreshed)
        # Symbols that other files do not use.
        client.replace(machine, files["a.ascxml"].replace('expr="_msg.data"', 'expr="_msg.data + nothing"'))
        await client.until_codes(machine, "unused-variable", "undeclared-variable")
        client.refreshed.clear()
        client.replace(machine, files["a.ascxml"].replace("/a/b", "/b/c"), version=3)
        await client.until(lambda: client.refreshed)
        await hints(client, machine)
        assert sorted(client.refreshed) == sorted(REFRESHES)


async def test_signatures(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    machine = tmp_path / "a.ascxml"
    text = machine.read_text(encoding="utf-8").replace('expr="_msg.data"', 'expr="Math.max(_msg.data, "')
    places = types.ClientSignatureParameterInformationOptions(label_offset_support=True)
    information = types.ClientSignatureInformationOptions(MARKDOWN, places)
    asks = types.SignatureHelpClientCapabilities(signature_information=information)
    at = place(machine, text, 'Math.max(_msg.data, |"')
    for further, labels in (({}, ["a", "b"]), ({"signature_help": asks}, [(9, 10), (12, 13)])):
        async with connect(tmp_path, capabilities=capabilities(**further)) as client:
            client.open(machine, text)
            signature_help = await client.text_document_signature_help_async(types.SignatureHelpParams(*at))
            assert signature_help is not None
            (signature,) = signature_help.signatures
            assert (signature.label, signature_help.active_parameter) == ("Math.max(a, b, …) : int or float", 1)
            assert [parameter.label for parameter in signature.parameters or ()] == labels


async def test_hover_in_the_form_that_the_client_shows(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    machine = tmp_path / "a.ascxml"
    at = place(machine, machine.read_text(encoding="utf-8"), 'event="g|o" target')
    shown = []
    for formats in (MARKDOWN, [types.MarkupKind.PlainText], None):
        asks = types.HoverClientCapabilities(content_format=formats)
        async with connect(tmp_path, capabilities=capabilities(hover=asks)) as client:
            hover = await client.text_document_hover_async(types.HoverParams(*at))
            assert hover is not None
            assert isinstance(hover.contents, types.MarkupContent)
            shown.append((hover.contents.kind, hover.contents.value))
    assert shown[0][0] == types.MarkupKind.Markdown
    assert shown[0][1].startswith("```\nevent go(to : Pose)\n```\n\n**Sent by** `A`")
    assert shown[1] == shown[2]
    assert shown[1][0] == types.MarkupKind.PlainText
    assert shown[1][1].startswith("event go(to : Pose)\n\nSent by A")


async def test_what_types_are_made_of(tmp_path: Path) -> None:
    files = split_files(ROBOT)
    load(tmp_path, {**files, "a.ascxml": files["a.ascxml"].replace("std_msgs/Int32", "geometry_msgs/Twist")})
    machine = tmp_path / "a.ascxml"
    at = place(machine, machine.read_text(encoding="utf-8"), "geometry_msgs/|Twist")
    async with connect(tmp_path) as client:
        twist = await client.text_document_prepare_type_hierarchy_async(types.TypeHierarchyPrepareParams(*at))
        assert [item.name for item in twist or ()] == ["geometry_msgs/Twist"]
        assert twist
        parts = await client.type_hierarchy_subtypes_async(types.TypeHierarchySubtypesParams(twist[0]))
        assert [(part.name, part.detail) for part in parts or ()] == [("geometry_msgs/Vector3", "linear, angular")]
        assert parts
        holders = await client.type_hierarchy_supertypes_async(types.TypeHierarchySupertypesParams(parts[0]))
        assert [holder.name for holder in holders or ()] == ["geometry_msgs/Twist"]
        tree = tmp_path / "tree.xml"
        at = place(tree, tree.read_text(encoding="utf-8"), "<S|equence>")
        locations = await client.text_document_definition_async(types.DefinitionParams(*at))
        assert isinstance(locations, (list, tuple))
        assert [location.uri.rpartition("/")[2] for location in locations if isinstance(location, types.Location)] == [
            "behaviortree_cpp.txt"
        ]
