# SPDX-License-Identifier: Apache-2.0
"""The properties of a system that can be verified, and the texts on which the answers depend."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from roaml.ide.navigation.document_symbol import DocumentSymbolKind
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.text import Span

Texts: TypeAlias = tuple[tuple[str, bytes], ...]
"""Files with the digests of their content."""


@dataclass(frozen=True, slots=True)
class Verifiable:
    """A property of a system: `span` is its place in the file at `path`, `name_span` that of its name without the
    quotes."""

    name: str
    comment: str
    path: str
    span: Span
    name_span: Span


def verifiable(analysis: Analysis, system: str) -> tuple[Verifiable, ...]:
    """The properties of the system file at `system`, in their order, without those that contain errors."""
    files = (
        listed_file.path
        for listed_file in analysis.listed(system)
        if listed_file.required_kind is FileKind.PROPERTIES and listed_file.usable
    )
    return tuple(prop for path in dict.fromkeys(files) for prop in _in_file(analysis, path))


def _in_file(analysis: Analysis, path: str) -> Iterator[Verifiable]:
    understood = {prop.name for prop in analysis.properties(path)[0]}
    for symbol in document_symbols(analysis, path):
        if symbol.kind is DocumentSymbolKind.PROPERTY and symbol.name in understood:
            yield Verifiable(symbol.name, symbol.detail, path, symbol.span, symbol.name_span)


def fingerprint(analysis: Analysis, system: str) -> Texts:
    """The content of the files of a system: the results are valid as long as it is equal."""
    sources = ((path, analysis.source(path)) for path in analysis.files_of(system))
    return tuple((path, source.digest) for path, source in sources if source is not None)
