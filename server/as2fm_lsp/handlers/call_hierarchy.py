# SPDX-License-Identifier: Apache-2.0
"""Senders and receivers as a call hierarchy: machines, events and interfaces, trees."""

from __future__ import annotations

from collections.abc import Callable

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.handlers.symbols import pack, symbol_kind, unpack
from roaml.diagnostics import Symbol
from roaml.ide.hierarchy import calls
from roaml.project.analysis import Analysis
from roaml.text import Span

Ask = Callable[[Analysis, Symbol], tuple[calls.HierarchyCall, ...]]


def register(context: Context) -> None:
    session = context.session

    def convert(analysis: Analysis, item: calls.CallHierarchyItem) -> types.CallHierarchyItem:
        source, symbol = analysis.source(item.path), item.symbol
        assert source is not None
        return types.CallHierarchyItem(
            symbol.name,
            symbol_kind(symbol.kind),
            session.convert.uri(item.path),
            session.convert.range(source, item.span),
            session.convert.range(source, item.name_span),
            detail=symbol.kind.value,
            data=pack(symbol),
        )

    def ranges(analysis: Analysis, path: str, spans: tuple[Span, ...]) -> list[types.Range]:
        source = analysis.source(path)
        return [session.convert.range(source, span) for span in spans] if source else []

    def ask(item: types.CallHierarchyItem, question: Ask) -> tuple[Analysis, tuple[calls.HierarchyCall, ...]]:
        """The incoming or outgoing calls of an item that the client has received before."""
        analysis = session.moment().snapshot(session.convert.path(item.uri)).analysis
        symbol = unpack(item.data)
        return analysis, question(analysis, symbol) if symbol else ()

    @context.feature(types.TEXT_DOCUMENT_PREPARE_CALL_HIERARCHY)
    def prepare(params: types.CallHierarchyPrepareParams) -> list[types.CallHierarchyItem]:
        on = requested_document(context, params.text_document)
        items = calls.items_at(on.analysis, on.path, on.offset(params.position)) if on else ()
        return [convert(on.analysis, item) for item in items] if on else []

    @context.feature(types.CALL_HIERARCHY_INCOMING_CALLS)
    def incoming(params: types.CallHierarchyIncomingCallsParams) -> list[types.CallHierarchyIncomingCall]:
        analysis, incoming_calls = ask(params.item, calls.incoming)
        return [
            types.CallHierarchyIncomingCall(convert(analysis, call.item), ranges(analysis, call.item.path, call.places))
            for call in incoming_calls
        ]

    @context.feature(types.CALL_HIERARCHY_OUTGOING_CALLS)
    def outgoing(params: types.CallHierarchyOutgoingCallsParams) -> list[types.CallHierarchyOutgoingCall]:
        analysis, outgoing_calls = ask(params.item, calls.outgoing)
        path = session.convert.path(params.item.uri)
        return [
            types.CallHierarchyOutgoingCall(convert(analysis, call.item), ranges(analysis, path, call.places))
            for call in outgoing_calls
        ]
