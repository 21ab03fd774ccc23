# SPDX-License-Identifier: Apache-2.0
"""A workspace that is not trusted: it is read and shown, but nothing is written, and no long computation runs."""

from __future__ import annotations

from pathlib import Path

import pytest
from client import connect
from lsprotocol import types
from pygls.exceptions import JsonRpcException

import clock

COMMANDS = ("as2fm.translateToJani", "as2fm.verify")
REFUSED = -32803


async def execute(client: object, command: str, main: Path) -> object:
    params = types.ExecuteCommandParams(command, [main.as_uri()])
    return await client.workspace_execute_command_async(params)  # type: ignore[attr-defined]


def content(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("said", [False, None, "true", 1], ids=repr)
async def test_it_writes_nothing(tmp_path: Path, said: object) -> None:
    main = clock.write(tmp_path, clock=clock.WRONG_CLOCK)
    before = content(tmp_path)
    async with connect(tmp_path, options={"trusted": said}) as client:
        await client.until_codes(tmp_path / "clock.ascxml", "undeclared-variable")
        lenses = await client.text_document_code_lens_async(
            types.CodeLensParams(types.TextDocumentIdentifier(main.as_uri()))
        )
        commands = {lens.command.command for lens in lenses or () if lens.command} | set(COMMANDS)
        for command in sorted(commands & set(COMMANDS)):
            with pytest.raises(
                JsonRpcException, match=f"`{command}` is disabled because the workspace is not trusted"
            ) as no:
                await execute(client, command, main)
            assert no.value.code == REFUSED
        params = {"textDocument": {"uri": main.as_uri()}}
        with pytest.raises(JsonRpcException) as no:
            await client.protocol.send_request_async("as2fm/migrate", params)
        assert no.value.code == REFUSED
    assert content(tmp_path) == before


async def test_trust_that_is_granted_later(tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    async with connect(tmp_path, options={"trusted": False}) as client:
        with pytest.raises(JsonRpcException):
            await execute(client, "as2fm.translateToJani", main)
        client.protocol.notify("as2fm/didChangeTrust", {"trusted": True})
        assert await execute(client, "as2fm.translateToJani", main)
        assert main.with_suffix(".jani").exists()
        client.protocol.notify("as2fm/didChangeTrust", {})
        with pytest.raises(JsonRpcException):
            await execute(client, "as2fm.translateToJani", main)


async def test_clients_that_do_not_know_of_trust(tmp_path: Path) -> None:
    main = clock.write(tmp_path)
    async with connect(tmp_path) as client:
        assert await execute(client, "as2fm.translateToJani", main)
