# SPDX-License-Identifier: Apache-2.0
"""Texts in a format that the client supports: Markdown or plain text."""

from __future__ import annotations

from collections.abc import Sequence

from lsprotocol import types

from roaml.ide.describe.markdown import plain


def content(text: str, formats: Sequence[types.MarkupKind | str] | None) -> types.MarkupContent:
    """A text as markup: Markdown if this is the first of `formats`, which are the formats of the client in its order of
    preference; otherwise plain text."""
    if formats and formats[0] == types.MarkupKind.Markdown:
        return types.MarkupContent(types.MarkupKind.Markdown, text)
    return types.MarkupContent(types.MarkupKind.PlainText, plain(text))


def documentation(text: str, formats: Sequence[types.MarkupKind | str] | None) -> types.MarkupContent | str:
    """Like `content`, but a plain string for clients that have declared no formats."""
    return content(text, formats) if formats else plain(text)
