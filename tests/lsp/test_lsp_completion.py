# SPDX-License-Identifier: Apache-2.0
"""Completion over stdio, for a client that supports snippets and for one that does not."""

from __future__ import annotations

from pathlib import Path

from client import PULLS, connect
from lsprotocol import types

TEXT = """<ascxml name="🤖" version="1.0" initial="s">
  <ros_topic_publisher name="pub" topic="/level" type="std_msgs/Int32"/>
  <state id="s">
    <transition target="s"><ros_topic_p/></transition>
  </state>
</ascxml>
"""
AT = types.Position(3, 39)

RICH = types.ClientCapabilities(
    text_document=types.TextDocumentClientCapabilities(
        diagnostic=types.DiagnosticClientCapabilities(),
        completion=types.CompletionClientCapabilities(
            completion_item=types.ClientCompletionItemOptions(
                snippet_support=True,
                documentation_format=[types.MarkupKind.Markdown],
                label_details_support=True,
                tag_support=types.CompletionItemTagOptions([types.CompletionItemTag.Deprecated]),
            )
        ),
    )
)


def params(path: Path, position: types.Position, trigger: str = "") -> types.CompletionParams:
    context = types.CompletionContext(types.CompletionTriggerKind.TriggerCharacter, trigger) if trigger else None
    return types.CompletionParams(types.TextDocumentIdentifier(path.as_uri()), position, context)


async def items(
    folder: Path, capabilities: types.ClientCapabilities, text: str, position: types.Position
) -> dict[str, types.CompletionItem]:
    path = folder / "a.ascxml"
    async with connect(folder, capabilities=capabilities) as client:
        client.open(path, text)
        completions = await client.text_document_completion_async(params(path, position))
        assert isinstance(completions, types.CompletionList)
        resolved = [await client.completion_item_resolve_async(item) for item in completions.items[:5]]
        return {item.label: item for item in (*resolved, *completions.items[5:])}


async def test_with_snippets(tmp_path: Path) -> None:
    text = TEXT.replace("<ros_topic_p/>", "<ros_topic_p")
    completion_items = await items(tmp_path, RICH, text, AT)
    item = completion_items["ros_topic_publish pub"]
    assert item.insert_text_format is types.InsertTextFormat.Snippet
    assert isinstance(item.text_edit, types.TextEdit)
    assert item.text_edit.range == types.Range(types.Position(3, 28), AT)
    assert item.text_edit.new_text.startswith('ros_topic_publish name="pub">\n\t<field name="data" expr="${1:0}"/>')
    assert item.label_details
    assert item.label_details.description == "data"
    assert isinstance(item.documentation, types.MarkupContent)
    assert item.documentation.kind is types.MarkupKind.Markdown
    assert "std_msgs/Int32" in item.documentation.value
    assert next(iter(completion_items)) == "ros_topic_publish pub"


async def test_without_snippets(tmp_path: Path) -> None:
    text = TEXT.replace("<ros_topic_p/>", "<ros_topic_p")
    completion_items = await items(tmp_path, PULLS, text, AT)
    item = completion_items["ros_topic_publish pub"]
    assert item.insert_text_format in (None, types.InsertTextFormat.PlainText)
    assert isinstance(item.text_edit, types.TextEdit)
    assert '<field name="data" expr="0"/>' in item.text_edit.new_text
    assert "$" not in item.text_edit.new_text
    assert item.detail == "data"
    assert isinstance(item.documentation, str)
    assert "std_msgs/Int32" in item.documentation
    assert "```" not in item.documentation


async def test_the_rest_of_the_tag_stays(tmp_path: Path) -> None:
    completion_items = await items(tmp_path, RICH, TEXT, AT)
    edit = completion_items["ros_topic_publish"].text_edit
    assert isinstance(edit, types.TextEdit)
    assert edit.new_text == "ros_topic_publish"


async def test_no_completions_without_candidates(tmp_path: Path) -> None:
    async with connect(tmp_path) as client:
        path = tmp_path / "a.ascxml"
        client.open(path, "<!-- here -->" + TEXT)
        assert await client.text_document_completion_async(params(path, types.Position(0, 6))) is None
        assert await client.text_document_completion_async(params(path, types.Position(3, 27), " ")) is None
        other = tmp_path / "none.ascxml"
        assert await client.text_document_completion_async(params(other, types.Position(0, 0))) is None


async def test_an_item_of_another_kind_stays_as_it_is(tmp_path: Path) -> None:
    async with connect(tmp_path) as client:
        item = types.CompletionItem("x", data={"from": "elsewhere"})
        assert await client.completion_item_resolve_async(item) == item


async def test_an_accepted_attribute_opens_its_values(tmp_path: Path) -> None:
    """With a command of the client, if no particular text is inserted."""
    path = tmp_path / "a.ascxml"
    commands = []
    for options in ({}, {"triggerSuggest": "editor.suggest"}):
        async with connect(tmp_path, capabilities=RICH, options=options) as client:
            text = TEXT.replace(' type="std_msgs/Int32"', " ")
            client.open(path, text)
            position = types.Position(1, text.splitlines()[1].index("/>"))
            completions = await client.text_document_completion_async(params(path, position))
            assert isinstance(completions, types.CompletionList)
            (item,) = (candidate for candidate in completions.items if candidate.label == "type")
            assert isinstance(item.text_edit, types.TextEdit)
            assert item.text_edit.new_text == 'type="$1"'
            commands.append(item.command and item.command.command)
    assert commands == [None, "editor.suggest"]
