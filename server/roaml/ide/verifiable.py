# SPDX-License-Identifier: Apache-2.0
"""The properties of a system that can be verified, and the texts on which the answers depend."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from roaml.ide.describe.markdown import plain
from roaml.ide.navigation.document_symbol import DocumentSymbolKind
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.text import Span

Texts: TypeAlias = tuple[tuple[str, bytes], ...]
"""Files with the digests of their content."""


@dataclass(frozen=True, slots=True)
class Verifiable:
    """A property of a system: `span` in the file at `path` is all of it, `name_span` its name without the quotes.

    `comment` says what the property requires: a sentence, or the comment in a JANI file.
    """

    name: str
    comment: str
    path: str
    span: Span
    name_span: Span


def verifiable(analysis: Analysis, system: str) -> tuple[Verifiable, ...]:
    """The properties of the system file at `system`, in their order, without those that contain errors."""
    properties: dict[str, Iterator[Verifiable]] = {}
    for listed in analysis.listed(system):
        if listed.usable and listed.wanted is FileKind.PROPERTIES:
            properties.setdefault(listed.path, _in_jani(analysis, listed.path))
        elif listed.usable and listed.wanted is FileKind.XML_PROPERTIES:
            properties.setdefault(listed.path, _in_xml(analysis, listed.path, system))
    return tuple(property_ for in_file in properties.values() for property_ in in_file)


def _in_jani(analysis: Analysis, path: str) -> Iterator[Verifiable]:
    understood = {declared.name for declared in analysis.properties(path)[0]}
    for symbol in document_symbols(analysis, path):
        if symbol.kind is DocumentSymbolKind.PROPERTY and symbol.name in understood:
            yield Verifiable(symbol.name, symbol.detail, path, symbol.span, symbol.name_span)


def _in_xml(analysis: Analysis, path: str, system: str) -> Iterator[Verifiable]:
    linked = analysis.linked_properties(path, system)
    for property_ in linked.properties if linked is not None else ():
        id_ = property_.written.id
        if id_ is not None and not property_.is_assumption:
            span = property_.written.element.span
            yield Verifiable(property_.name, plain(property_.sentence), path, span, id_.span)


def fingerprint(analysis: Analysis, system: str) -> Texts:
    """The content of the files of a system: as long as it is equal, so are the answers."""
    sources = ((path, analysis.source(path)) for path in analysis.files_of(system))
    return tuple((path, source.digest) for path, source in sources if source is not None)
