# SPDX-License-Identifier: Apache-2.0
"""A system with errors: the lenses state this, and lead to the first error."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from client import Client, connect
from lsprotocol import types

import clock

COMMAND = "as2fm.showFirstError"
SHOWS = types.ClientCapabilities(
    window=types.WindowClientCapabilities(show_document=types.ShowDocumentClientCapabilities(True))
)


async def lenses(client: Client, path: Path) -> list[types.Command]:
    params = types.CodeLensParams(types.TextDocumentIdentifier(path.as_uri()))
    code_lenses = await client.text_document_code_lens_async(params) or ()
    return [lens.command for lens in code_lenses if lens.command is not None]


async def run(client: Client, command: str, *arguments: Any) -> Any:
    params = types.ExecuteCommandParams(command, list(arguments))
    return await client.workspace_execute_command_async(params)


async def test_lenses_lead_to_the_error_in_whichever_file(tmp_path: Path) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    main, machine, properties = (tmp_path / name for name in ("main.xml", "clock.ascxml", "properties.jani"))
    async with connect(tmp_path, capabilities=SHOWS) as client:
        (lens,) = await lenses(client, main)
        assert (lens.title, lens.command) == ("1 error: cannot be translated or verified", COMMAND)
        of_properties = await lenses(client, properties)
        assert {lens.title for lens in of_properties} == {"1 error in main.xml: cannot be verified"}
        assert {lens.command for lens in of_properties} == {COMMAND}
        await run(client, COMMAND, *(lens.arguments or ()))
        (shown,) = client.shown_documents
        assert shown.uri == machine.as_uri()
        assert shown.take_focus
        assert shown.selection is not None
        start, end = shown.selection.start, shown.selection.end
        written = machine.read_text().splitlines()[start.line][start.character : end.character]
        (message,) = client.messages
        assert message.message.startswith(f"clock.ascxml:{start.line + 1}: there is no variable `{written}`")
        # After the error is fixed, the usual lenses are shown again.
        client.open(machine, clock.CLOCK)
        titles = [lens.title for lens in await lenses(client, main)]
        assert titles == ["Translate to JANI", "Verify all"]
        assert await run(client, COMMAND, main.as_uri()) is None


async def test_an_error_that_a_comment_keeps_quiet_is_shown(tmp_path: Path) -> None:
    text = clock.WRONG_CLOCK.replace("<ascxml", "<!-- as2fm: ignore -->\n<ascxml", 1)
    clock.write(tmp_path, clock=text)
    async with connect(tmp_path, capabilities=SHOWS) as client:
        (lens,) = await lenses(client, tmp_path / "main.xml")
        assert lens.title == "1 error: cannot be translated or verified"


@pytest.mark.parametrize("command", ["as2fm.translateToJani", "as2fm.verify"])
async def test_the_commands_themselves_lead_there(tmp_path: Path, command: str) -> None:
    clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    async with connect(tmp_path, capabilities=SHOWS) as client:
        await run(client, command, (tmp_path / "main.xml").as_uri())
        assert [document.uri for document in client.shown_documents] == [(tmp_path / "clock.ascxml").as_uri()]
    async with connect(tmp_path) as client:  # a client that cannot show documents is not asked to
        await run(client, command, (tmp_path / "main.xml").as_uri())
        assert client.shown_documents == []
        assert len(client.messages) == 1


async def test_several_systems_are_distinguished(tmp_path: Path) -> None:
    """Two systems share the properties, and one of them has an error."""
    clock.write(tmp_path)
    (tmp_path / "other.xml").write_text((tmp_path / "main.xml").read_text().replace("clock.ascxml", "wrong.ascxml"))
    (tmp_path / "wrong.ascxml").write_text(clock.WRONG_CLOCK)
    async with connect(tmp_path) as client:
        commands = await lenses(client, tmp_path / "properties.jani")
        assert {lens.title for lens in commands} == {"Verify in main.xml", "1 error in other.xml: cannot be verified"}
        assert await run(client, COMMAND, 1) is None
