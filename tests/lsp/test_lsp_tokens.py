# SPDX-License-Identifier: Apache-2.0
"""Semantic tokens over stdio: of a whole file, changes, and of a range."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from client import connect
from lsprotocol import types

from as2fm_lsp.handlers.semantic_tokens import LEGEND, changes

TEXT = '<ascxml name="🤖">\n<state id="🤖" a="b"/></ascxml>'


def read(data: Sequence[int]) -> list[tuple[int, int, int, str]]:
    """Line, first and last column and type of each token."""
    tokens = []
    line = column = 0
    for i in range(0, len(data), 5):
        down, right, length, kind, _ = data[i : i + 5]
        line, column = line + down, right if down else column + right
        tokens.append((line, column, column + length, LEGEND.token_types[kind]))
    return tokens


def applied(data: Sequence[int], edits: Sequence[types.SemanticTokensEdit]) -> list[int]:
    result = list(data)
    for edit in edits:
        result[edit.start : edit.start + edit.delete_count] = edit.data or []
    return result


async def test_tokens(tmp_path: Path) -> None:
    path = tmp_path / "a.ascxml"
    document = types.TextDocumentIdentifier(path.as_uri())
    async with connect(tmp_path) as client:
        client.open(path, TEXT)
        full = await client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document))
        assert full
        root = [(0, 1, 7, "keyword"), (0, 8, 12, "property"), (0, 14, 16, "namespace")]
        state = [(1, 1, 6, "class"), (1, 7, 9, "property"), (1, 11, 13, "class"), (1, 15, 16, "property")]
        assert read(full.data) == [*root, *state, (1, 24, 30, "keyword")]

        part = types.Range(types.Position(1, 2), types.Position(1, 12))
        some = await client.text_document_semantic_tokens_range_async(types.SemanticTokensRangeParams(document, part))
        assert some
        assert read(some.data) == state[:3]

        client.replace(path, TEXT.replace("<state", "<!-- 🤖 --><state"))
        assert full.result_id
        params = types.SemanticTokensDeltaParams(document, full.result_id)
        delta = await client.text_document_semantic_tokens_full_delta_async(params)
        assert isinstance(delta, types.SemanticTokensDelta)
        assert sum(len(edit.data or ()) for edit in delta.edits) < 5
        again = await client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document))
        assert again
        assert applied(full.data, delta.edits) == list(again.data)
        assert read(again.data)[3] == (1, 12, 17, "class")

        # If the last answer is no longer known, all tokens are sent.
        whole = await client.text_document_semantic_tokens_full_delta_async(params)
        assert isinstance(whole, types.SemanticTokens)
        assert list(whole.data) == list(again.data)


def test_changes() -> None:
    for before, after in (([], []), ([1], [1]), ([1, 2, 3], [1, 3]), ([1, 1], [1, 1, 1]), ([], [1, 2]), ([1], [])):
        edits = changes(before, after)
        assert applied(before, edits) == after
        assert bool(edits) == (before != after)
