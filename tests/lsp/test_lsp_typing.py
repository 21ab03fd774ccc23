# SPDX-License-Identifier: Apache-2.0
"""Models typed from nothing, character by character, with everything asked that an editor asks after each. A new line
comes with its indentation, as from an editor."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import prefork
from bench.server import is_answer, started

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "delivery_robot"
TYPED = ("main.xml", "tree.xml", "nodes/building.ascxml", "plugins/charge.ascxml", "properties.jani")


@pytest.mark.parametrize("name", TYPED)
def test_typed(name: str) -> None:
    path = EXAMPLE / name
    text = path.read_text(encoding="utf-8")
    uri = path.as_uri()
    with started(prefork.command()) as server:
        server.initialize(EXAMPLE, capabilities={"textDocument": {"diagnostic": {}}})
        asked = [
            method
            for method, capability in (
                ("textDocument/completion", "completionProvider"),
                ("textDocument/diagnostic", "diagnosticProvider"),
                ("textDocument/documentSymbol", "documentSymbolProvider"),
            )
            if capability in server.capabilities
        ]
        assert "textDocument/diagnostic" in asked
        server.open(path, "")
        line = column = 0
        last: dict[str, object] = {}
        typed_text = ""
        for number, typed_key in enumerate(re.findall(r"\n[ \t]*|.", text)):
            start = {"line": line, "character": column}
            server.change(path, number + 2, {"range": {"start": start, "end": start}, "text": typed_key})
            typed_text += typed_key
            is_new_line = typed_key.startswith("\n")
            line, column = (line + 1, len(typed_key) - 1) if is_new_line else (line, column + 1)
            ids = range(10 + number * 10, 10 + number * 10 + len(asked))
            for id_, method in zip(ids, asked, strict=True):
                params = {"textDocument": {"uri": uri}, "position": {"line": line, "character": column}}
                server.send(method, params, id_)
            for _, answer in server.wait_for_all(*map(is_answer, ids)):
                assert "error" not in answer, (typed_text[-80:], answer["error"])
                last[asked[answer["id"] - ids.start]] = answer["result"]
        assert typed_text == text
        typed = last["textDocument/diagnostic"]
        server.change(path, len(text) + 2, {"text": text})
        server.send("textDocument/diagnostic", {"textDocument": {"uri": uri}}, 1)
        whole = server.answer(1)[1]["result"]
    assert isinstance(typed, dict)
    assert typed["items"] == whole["items"]
    assert [item["code"] for item in typed["items"]] == ["not-in-reference"] * (name == "main.xml")
