# SPDX-License-Identifier: Apache-2.0
"""`workspace/symbol`: search for symbols in all files by a part of their name."""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.symbols import symbol_kind
from roaml.ide.navigation.workspace_symbols import search
from roaml.text import Location

MAX_SYMBOLS = 1000
"""The maximum number of results; the user can refine the query."""


def register(context: Context) -> None:
    session = context.session

    @context.feature(types.WORKSPACE_SYMBOL)
    def workspace_symbol(params: types.WorkspaceSymbolParams) -> list[types.WorkspaceSymbol]:
        moment = session.moment()
        symbols: list[types.WorkspaceSymbol] = []
        for path in moment.files():
            analysis = moment.snapshot(path).analysis
            source = analysis.source(path)
            for match in search(analysis, (path,), params.query) if source else ():
                assert source is not None
                place = session.convert.location(source, Location(path, match.span))
                kind = symbol_kind(match.symbol.kind)
                symbols.append(
                    types.WorkspaceSymbol(place, match.symbol.name, kind, container_name=match.container or None)
                )
            if len(symbols) >= MAX_SYMBOLS:
                break
        return symbols[:MAX_SYMBOLS]
