# SPDX-License-Identifier: Apache-2.0
"""The structure of a file in an editor: folding, selection ranges, outline, links to other files."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import RequestedDocument, requested_document
from roaml.ide.folding_range import FoldKind, folds
from roaml.ide.navigation.document_links import links
from roaml.ide.navigation.document_symbol import DocumentSymbol, DocumentSymbolKind
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.ide.selection_range import selections
from roaml.text import Span

_FOLDS = {FoldKind.BLOCK: types.FoldingRangeKind.Region, FoldKind.COMMENT: types.FoldingRangeKind.Comment}

_KINDS = {
    DocumentSymbolKind.MACHINE: types.SymbolKind.Class,
    DocumentSymbolKind.DATAMODEL: types.SymbolKind.Namespace,
    DocumentSymbolKind.VARIABLE: types.SymbolKind.Variable,
    DocumentSymbolKind.PORT: types.SymbolKind.Property,
    DocumentSymbolKind.ROS: types.SymbolKind.Interface,
    DocumentSymbolKind.STATE: types.SymbolKind.Object,
    DocumentSymbolKind.TRANSITION: types.SymbolKind.Event,
    DocumentSymbolKind.THREAD: types.SymbolKind.Module,
    DocumentSymbolKind.TREE: types.SymbolKind.Class,
    DocumentSymbolKind.CONTROL: types.SymbolKind.Operator,
    DocumentSymbolKind.LEAF: types.SymbolKind.Function,
    DocumentSymbolKind.SYSTEM: types.SymbolKind.Package,
    DocumentSymbolKind.SECTION: types.SymbolKind.Namespace,
    DocumentSymbolKind.INPUT: types.SymbolKind.File,
    DocumentSymbolKind.STRUCT: types.SymbolKind.Struct,
    DocumentSymbolKind.MEMBER: types.SymbolKind.Field,
    DocumentSymbolKind.PROPERTY: types.SymbolKind.Boolean,
}


def register(context: Context) -> None:
    @context.feature(types.TEXT_DOCUMENT_FOLDING_RANGE)
    def folding_range(params: types.FoldingRangeParams) -> list[types.FoldingRange]:
        file = requested_document(context, params.text_document)
        foldable = folds(file.analysis, file.path) if file else ()
        return [types.FoldingRange(fold.first, fold.last, kind=_FOLDS[fold.kind]) for fold in foldable]

    @context.feature(types.TEXT_DOCUMENT_SELECTION_RANGE)
    def selection_range(params: types.SelectionRangeParams) -> list[types.SelectionRange]:
        file = requested_document(context, params.text_document)
        if file is None:
            return []
        offsets = [file.offset(position) for position in params.positions]
        return [_selection(file, selections(file.analysis, file.path, offset)) for offset in offsets]

    @context.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def document_symbol(
        params: types.DocumentSymbolParams,
    ) -> list[types.DocumentSymbol] | list[types.SymbolInformation]:
        file = requested_document(context, params.text_document)
        if file is None:
            return []
        symbols = document_symbols(file.analysis, file.path)
        if _takes_nested_symbols(context):
            return [nested(symbol, file.range) for symbol in symbols]
        return list(_flat(file, symbols))

    @context.feature(types.TEXT_DOCUMENT_DOCUMENT_LINK)
    def document_link(params: types.DocumentLinkParams) -> list[types.DocumentLink]:
        file = requested_document(context, params.text_document)
        if file is None:
            return []
        document_links = links(file.analysis, file.path)
        return [types.DocumentLink(file.range(link.span), file.convert.uri(link.target)) for link in document_links]


def _selection(file: RequestedDocument, spans: Sequence[Span]) -> types.SelectionRange:
    selection: types.SelectionRange | None = None
    for span in reversed(spans):
        selection = types.SelectionRange(file.range(span), selection)
    assert selection is not None, "the span of the whole text contains every offset"
    return selection


def nested(symbol: DocumentSymbol, range_of: Callable[[Span], types.Range]) -> types.DocumentSymbol:
    """An entry of an outline with its children, in the protocol's types."""
    return types.DocumentSymbol(
        symbol.name,
        _KINDS[symbol.kind],
        range_of(symbol.span),
        range_of(symbol.name_span),
        detail=symbol.detail or None,
        children=[nested(child, range_of) for child in symbol.children],
    )


def _flat(
    file: RequestedDocument, symbols: Sequence[DocumentSymbol], container: str | None = None
) -> Sequence[types.SymbolInformation]:
    """The symbols as a flat list, for clients that do not support nested symbols."""
    flat: list[types.SymbolInformation] = []
    for symbol in symbols:
        place = types.Location(file.convert.uri(file.path), file.range(symbol.span))
        flat.append(types.SymbolInformation(place, symbol.name, _KINDS[symbol.kind], container_name=container))
        flat += _flat(file, symbol.children, symbol.name)
    return flat


def _takes_nested_symbols(context: Context) -> bool:
    capabilities = context.client.capabilities.text_document
    symbol = capabilities.document_symbol if capabilities else None
    return bool(symbol and symbol.hierarchical_document_symbol_support)
