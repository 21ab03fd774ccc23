# SPDX-License-Identifier: Apache-2.0
"""Rename over standard input and output: prepared, done across files, refused with a reason."""

from __future__ import annotations

from pathlib import Path

import pytest
from client import connect
from ide_models import ROBOT, load
from lsprotocol import types
from pygls.exceptions import JsonRpcException
from test_lsp_navigate import place

from fixture import split_files


async def test_rename(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    machine = tmp_path / "a.ascxml"
    text = "<!-- 🤖 -->" + machine.read_text(encoding="utf-8")
    async with connect(tmp_path) as client:
        client.open(machine, text)
        at = place(machine, text, 'event="g|o" target')
        prepared = await client.text_document_prepare_rename_async(types.PrepareRenameParams(*at))
        assert isinstance(prepared, types.PrepareRenamePlaceholder)
        assert (prepared.placeholder, prepared.range.start.character) == ("go", at[1].character - 1)
        edit = await client.text_document_rename_async(types.RenameParams(*at, "went"))
        assert edit is not None
        changed = {
            uri.rpartition("/")[2]: [text_edit.new_text for text_edit in edits]
            for uri, edits in (edit.changes or {}).items()
        }
        assert changed == {"a.ascxml": ["went"] * 2, "properties.jani": ["went"] * 2}


async def test_refused(tmp_path: Path) -> None:
    load(tmp_path, split_files(ROBOT))
    machine = tmp_path / "a.ascxml"
    text = machine.read_text(encoding="utf-8")
    async with connect(tmp_path) as client:
        field = place(machine, text, "_msg.da|ta")
        with pytest.raises(JsonRpcException, match=r"`data` is defined by ROS, not by this model\."):
            await client.text_document_prepare_rename_async(types.PrepareRenameParams(*field))
        variable = place(machine, text, 'id="|n"')
        with pytest.raises(JsonRpcException, match=r"A variable `p` already exists\."):
            await client.text_document_rename_async(types.RenameParams(*variable, "p"))
