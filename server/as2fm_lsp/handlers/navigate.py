# SPDX-License-Identifier: Apache-2.0
"""From a name to its definition, declaration, type, implementation and uses."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from lsprotocol import types

from as2fm_lsp.context import Context
from as2fm_lsp.handlers.requested_document import requested_document
from roaml.ide import navigation
from roaml.ide.names.occurrence import Access
from roaml.project.analysis import Analysis
from roaml.text import Location

_HIGHLIGHTS = {
    Access.TEXT: types.DocumentHighlightKind.Text,
    Access.READ: types.DocumentHighlightKind.Read,
    Access.WRITE: types.DocumentHighlightKind.Write,
}

Find = Callable[[Analysis, str, int], Iterable[Location]]


def register(context: Context) -> None:
    def locations(document: types.TextDocumentIdentifier, position: types.Position, find: Find) -> list[types.Location]:
        """The results of `find` at a place."""
        on = requested_document(context, document)
        if on is None:
            return []
        places = find(on.analysis, on.path, on.offset(position))
        targets = ((on.analysis.source(place.path), place) for place in places)
        return [on.convert.location(target, place) for target, place in targets if target is not None]

    @context.feature(types.TEXT_DOCUMENT_DEFINITION)
    def definition(params: types.DefinitionParams) -> list[types.Location]:
        return locations(params.text_document, params.position, navigation.definition)

    @context.feature(types.TEXT_DOCUMENT_DECLARATION)
    def declaration(params: types.DeclarationParams) -> list[types.Location]:
        return locations(params.text_document, params.position, navigation.declaration)

    @context.feature(types.TEXT_DOCUMENT_TYPE_DEFINITION)
    def type_definition(params: types.TypeDefinitionParams) -> list[types.Location]:
        return locations(params.text_document, params.position, navigation.type_definition)

    @context.feature(types.TEXT_DOCUMENT_IMPLEMENTATION)
    def implementation(params: types.ImplementationParams) -> list[types.Location]:
        return locations(params.text_document, params.position, navigation.implementation)

    @context.feature(types.TEXT_DOCUMENT_REFERENCES)
    def references(params: types.ReferenceParams) -> list[types.Location]:
        def find(analysis: Analysis, path: str, offset: int) -> tuple[Location, ...]:
            with_declaration = params.context.include_declaration
            return navigation.references(analysis, path, offset, with_declaration=with_declaration)

        return locations(params.text_document, params.position, find)

    @context.feature(types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT)
    def document_highlight(params: types.DocumentHighlightParams) -> list[types.DocumentHighlight]:
        on = requested_document(context, params.text_document)
        if on is None:
            return []
        occurrences = navigation.highlights(on.analysis, on.path, on.offset(params.position))
        return [
            types.DocumentHighlight(on.range(occurrence.span), _HIGHLIGHTS[occurrence.access])
            for occurrence in occurrences
        ]
