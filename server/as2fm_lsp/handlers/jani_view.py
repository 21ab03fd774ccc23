# SPDX-License-Identifier: Apache-2.0
"""`as2fm/janiView`: a JANI file formatted for reading, with the outline of that text."""

from __future__ import annotations

from typing import Any, TypedDict

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.parameters import document_uri
from as2fm_lsp.handlers.structure import nested
from as2fm_lsp.verification import background
from roaml.disk import UnreadableReason
from roaml.ide.jani_view import JaniView, jani_view
from roaml.text import SourceFile

METHOD = "as2fm/janiView"
MAX_CHARACTERS = 4_000_000
"""The maximum size of a file that is formatted, in characters: editors do not fold or color larger texts either."""


class JaniText(TypedDict):
    """`problem` is the reason why there is no text; empty if there is one."""

    text: str
    symbols: list[types.DocumentSymbol]
    problem: str


def register(context: Context) -> None:
    session = context.session

    @context.feature(METHOD)
    async def view(params: Any) -> JaniText:
        path = session.convert.path(document_uri(params))
        source = session.moment().snapshot(path).analysis.files.read(path)
        if isinstance(source, UnreadableReason):
            return _problem(f"This file cannot be shown: {source.value}.")
        if len(source.text) > MAX_CHARACTERS:
            return _problem(f"This file is too large to be formatted ({len(source.text) / 1e6:.0f} MB).")
        return await background.in_thread(lambda _: _converted(path, jani_view(source.text)), lambda: None)

    def _converted(path: str, laid_out: JaniView) -> JaniText:
        source = SourceFile(path, laid_out.text)
        symbols = [nested(symbol, lambda span: session.convert.range(source, span)) for symbol in laid_out.symbols]
        return {"text": laid_out.text, "symbols": symbols, "problem": ""}


def _problem(text: str) -> JaniText:
    return {"text": "", "symbols": [], "problem": text}
