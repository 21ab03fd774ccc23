# SPDX-License-Identifier: Apache-2.0
"""The parts of messages and structs as a type hierarchy: the parts of a type are its subtypes."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.handlers.symbols import pack, unpack
from roaml.diagnostics import Symbol
from roaml.ide.hierarchy.types import TypeItem, holders_of, members_of, types_at
from roaml.project.analysis import Analysis
from roaml.roles import SymbolKind


def register(context: Context) -> None:
    session = context.session

    def convert(analysis: Analysis, type_items: Iterable[TypeItem], asked_in: str) -> list[types.TypeHierarchyItem]:
        items = []
        for item in type_items:
            source = analysis.source(item.location.path)
            if source is not None:
                place = session.convert.location(source, item.location)
                kind = types.SymbolKind.Struct if item.symbol.kind is SymbolKind.STRUCT else types.SymbolKind.Interface
                data = [asked_in, pack(item.symbol)]
                name, uri, range_ = item.symbol.name, place.uri, place.range
                items.append(types.TypeHierarchyItem(name, kind, uri, range_, range_, detail=item.detail, data=data))
        return items

    def ask(
        item: types.TypeHierarchyItem, question: Callable[[Analysis, Symbol], Iterable[TypeItem]]
    ) -> list[types.TypeHierarchyItem]:
        """The hierarchy of a type that the client received before, as seen from the file of the first request."""
        if not isinstance(item.data, (list, tuple)) or len(item.data) != 2:
            return []
        path, symbol = str(item.data[0]), unpack(item.data[1])
        analysis = session.moment().snapshot(path).analysis
        return convert(analysis, question(analysis, symbol), path) if symbol else []

    @context.feature(types.TEXT_DOCUMENT_PREPARE_TYPE_HIERARCHY)
    def prepare(params: types.TypeHierarchyPrepareParams) -> list[types.TypeHierarchyItem]:
        on = requested_document(context, params.text_document)
        return convert(on.analysis, types_at(on.analysis, on.path, on.offset(params.position)), on.path) if on else []

    @context.feature(types.TYPE_HIERARCHY_SUBTYPES)
    def subtypes(params: types.TypeHierarchySubtypesParams) -> list[types.TypeHierarchyItem]:
        return ask(params.item, members_of)

    @context.feature(types.TYPE_HIERARCHY_SUPERTYPES)
    def supertypes(params: types.TypeHierarchySupertypesParams) -> list[types.TypeHierarchyItem]:
        return ask(params.item, holders_of)
