# SPDX-License-Identifier: Apache-2.0
"""`textDocument/inlayHint` and `inlayHint/resolve`"""

from __future__ import annotations

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.display_settings import display_settings
from as2fm_lsp.handlers import results
from as2fm_lsp.handlers.requested_document import requested_document
from as2fm_lsp.handlers.symbols import pack, unpack
from as2fm_lsp.markup import content
from roaml.ide.inlay_hints import HintKind, InlayHint, explain, inlay_hints

_TYPES = (HintKind.TYPES, HintKind.PORTS, HintKind.EVENTS)


def register(context: Context) -> None:
    session = context.session

    @context.feature(types.TEXT_DOCUMENT_INLAY_HINT, types.InlayHintOptions(resolve_provider=True))
    def inlay_hint(params: types.InlayHintParams) -> list[types.InlayHint]:
        on = requested_document(context, params.text_document)
        if on is None:
            return []
        display = display_settings(session.client_settings)
        hints_here = inlay_hints(on.analysis, on.path, on.span(params.range), display.hints)
        explains = _explains(context)
        hints = [_hint(hint, on.convert.position(on.source, hint.offset), on.path, explains) for hint in hints_here]
        return [*hints, *(results.hints(context, on, params.range) if display.results else ())]

    @context.feature(types.INLAY_HINT_RESOLVE)
    def resolve(hint: types.InlayHint) -> types.InlayHint:
        data = hint.data
        if not isinstance(data, (list, tuple)) or not data or isinstance(hint.label, str):
            return hint
        analysis = session.moment().snapshot(str(data[0])).analysis
        for part, packed in zip(hint.label, data[1:], strict=False):
            symbol = unpack(packed)
            if symbol is None:
                continue
            explanation = explain(analysis, symbol)
            source = analysis.source(explanation.location.path) if explanation.location else None
            part.tooltip = content(explanation.text, [types.MarkupKind.Markdown]) if explanation.text else None
            if source is not None and explanation.location is not None:
                part.location = session.convert.location(source, explanation.location)
        return hint


def _explains(context: Context) -> bool:
    """Whether the client requests the explanation of a hint separately."""
    document = context.client.capabilities.text_document
    return bool(document and document.inlay_hint and document.inlay_hint.resolve_support)


def _hint(hint: InlayHint, position: types.Position, path: str, explains: bool) -> types.InlayHint:
    kind = types.InlayHintKind.Type if hint.kind in _TYPES else None
    if not explains or not any(part.symbol for part in hint.parts):
        return types.InlayHint(position, hint.text, kind)
    label = [types.InlayHintLabelPart(part.text) for part in hint.parts]
    data = [path, *(pack(part.symbol) if part.symbol else None for part in hint.parts)]
    return types.InlayHint(position, label, kind, data=data)
