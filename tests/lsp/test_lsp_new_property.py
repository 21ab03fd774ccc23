# SPDX-License-Identifier: Apache-2.0
"""From a sentence and events to a property that is verified."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from client import connect
from pygls.exceptions import JsonRpcException
from test_lsp_expectations import changed, coin
from test_lsp_verify import QUICK, ask, verify

from as2fm_lsp.handlers.new_property import NEW_PROPERTY, SENTENCES

HEADS, THROWN = "a message is published on `/heads`", "a message is published on `/thrown`"


async def test_a_property_is_made_and_verified(tmp_path: Path) -> None:
    main, file = coin(tmp_path)
    text = file.read_text(encoding="utf-8")
    document = {"textDocument": {"uri": main.as_uri()}}
    async with connect(tmp_path) as client:
        client.open(file, text, language="xml")
        known = await ask(client, SENTENCES, document)
        assert known["events"] == [HEADS, THROWN]
        assert known["hasClock"] is True
        sentence = next(s for s in known["sentences"] if s["text"].startswith("Whenever B happens, A happens"))
        assert sentence["letters"] == ["A", "B"]
        params: dict[str, Any] = {**document, "sentence": sentence["id"], "events": [HEADS, THROWN], "within": "1"}
        made = await ask(client, NEW_PROPERTY, params)
        assert (made["uri"], made["name"]) == (file.as_uri(), "heads_precedence")
        (edits,) = made["edit"]["changes"].values()
        client.replace(file, changed(text, edits))
        (result,) = (await verify(client, main, ["heads_precedence"], QUICK))["results"]
        assert 0.3 < result["probability"] < 0.7
        assert result["comment"].startswith("Whenever a message is published on `/thrown`")
        for wrong in (
            {"within": "soon"},
            {"within": "-1"},
            {"events": [HEADS]},
            {"sentence": "none"},
            {"events": [1, 2]},
        ):
            with pytest.raises(JsonRpcException):
                await ask(client, NEW_PROPERTY, {**params, **wrong})
