# SPDX-License-Identifier: Apache-2.0
"""`textDocument/codeLens` and `codeLens/resolve`: translate or verify a system; the number of uses of a symbol.

The protocol has no command that shows places. A client that has one names it in its initialization options, as
`showReferences`: it is called with a URI, a position and the locations, in the protocol's types. Without it, the lenses
only show text.
"""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.display_settings import display_settings
from as2fm_lsp.handlers import experiment, first_error, results, translate, tree_lenses
from as2fm_lsp.handlers.first_error import errors_of
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.handlers.symbols import pack, unpack
from roaml.ide.code_lens import counted, lenses

OPTION = "showReferences"


def register(context: Context) -> None:
    session = context.session

    @context.feature(types.TEXT_DOCUMENT_CODE_LENS, types.CodeLensOptions(resolve_provider=True))
    def code_lens(params: types.CodeLensParams) -> list[types.CodeLens]:
        on = requested_document(context, params.text_document)
        if on is None:
            return []
        broken = errors_of(on)
        shown = list(first_error.lenses(on, broken))
        if on.path not in broken:
            shown += translate.lenses(on.snapshot, on.path, on.source, on.convert)
        shown += results.lenses(context, on, broken)
        shown += experiment.lenses(context, on, broken)
        shown += tree_lenses.lenses(context, on, broken)
        if display_settings(session.client_settings).references:
            for lens in lenses(on.analysis, on.path):
                data = [params.text_document.uri, pack(lens.symbol)]
                shown.append(types.CodeLens(on.range(lens.span), data=data))
        return shown

    @context.feature(types.CODE_LENS_RESOLVE)
    def resolve(lens: types.CodeLens) -> types.CodeLens:
        data = lens.data if isinstance(lens.data, (list, tuple)) and len(lens.data) == 2 else ("", None)
        uri, symbol = str(data[0]), unpack(data[1])
        if lens.command is not None or symbol is None:
            return lens
        path = session.convert.path(uri)
        analysis = session.moment().snapshot(path).analysis
        uses = counted(analysis, symbol, path)
        places = [
            session.convert.location(source, place)
            for place in uses.places
            if (source := analysis.source(place.path)) is not None
        ]
        command = context.client.show_references if places else ""
        arguments = [uri, lens.range.start, places] if command else None
        lens.command = types.Command(uses.title, command, arguments=arguments)
        return lens
