# SPDX-License-Identifier: Apache-2.0
"""The properties of a system that can be verified, and the files on which the results of a verification depend."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from roaml.comparison import Comparison, read_comparison
from roaml.ide.describe.markdown import plain
from roaml.ide.navigation.document_symbol import DocumentSymbolKind
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.model.kinds import FileKind, mocks_path
from roaml.model.property_file import PropertyFile
from roaml.project.analysis import Analysis
from roaml.project.mock_files import executed_tree, mocks_beside
from roaml.project.paths import resolve
from roaml.record import Record, replace
from roaml.scxml.names import SUCCEEDS
from roaml.text import Location, SourceFile, Span

Texts: TypeAlias = tuple[tuple[str, bytes], ...]
"""Paths of files, each with the digest of the content."""


class Verifiable(Record, frozen=True):
    """A property of a system. `span` is its place in the file `path`; `name_span` is the place of its name without
    quotes.

    `name` is that of the expanded property: properties of instances can have the same place. `comment` describes the
    property: its sentence if it is written in XML, or its comment in a JANI file.
    """

    name: str
    comment: str
    path: str
    span: Span
    name_span: Span


def verifiable(analysis: Analysis, system: str) -> tuple[Verifiable, ...]:
    """The properties of the system file `system`, in the order of their files, without properties that contain
    errors. A file of trees that belongs to no system has the property that its tree succeeds."""
    tree = executed_tree(analysis, system)
    if tree is not None:
        name = tree.id.span if tree.id is not None else tree.element.name_span
        return (Verifiable(SUCCEEDS, "The tree returns SUCCESS.", system, tree.element.span, name),)
    properties: dict[str, Iterator[Verifiable]] = {}
    for listed in analysis.listed(system):
        if listed.usable and listed.required_kind in (FileKind.PROPERTIES, FileKind.XML_PROPERTIES):
            properties.setdefault(listed.path, _in_file(analysis, listed.path, system))
    return tuple(property_ for in_file in properties.values() for property_ in in_file)


def _in_file(analysis: Analysis, path: str, system: str) -> Iterator[Verifiable]:
    """The properties in the expanded texts of a file, at their places in the file."""
    is_jani, expanded = analysis.kind(path) is FileKind.PROPERTIES, analysis.expanded(system)
    for inner, variant in variants(analysis, path, system):
        for property_ in _in_jani(inner, variant) if is_jani else _in_xml(inner, variant, system):
            if expanded is None:
                yield property_
                continue
            place, name = (expanded.location(Location(variant, span)) for span in (property_.span, property_.name_span))
            yield replace(property_, path=place.path, span=place.span, name_span=name.span)


def variants(analysis: Analysis, path: str, system: str) -> Iterator[tuple[Analysis, str]]:
    """The analysis of the texts that a file is expanded to in a system, each with its path; those of the file itself if
    the system is not expanded."""
    expanded = analysis.expanded(system)
    if expanded is None:
        yield analysis, path
        return
    yield from ((expanded.analysis, variant) for variant in expanded.expansion.paths(path))


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


def expected_beside(analysis: Analysis, system: str) -> dict[str, Comparison]:
    """The expectations in the XML property files of a system, by the names of the properties."""
    expected: dict[str, Comparison] = {}
    files = dict.fromkeys(
        listed.path
        for listed in analysis.listed(system)
        if listed.usable and listed.required_kind is FileKind.XML_PROPERTIES
    )
    texts = (variant for path in files for variant in variants(analysis, path, system))
    for inner, path in texts:
        linked = inner.linked_properties(path, system)
        for property_ in linked.properties if linked is not None else ():
            expect = property_.written.expect
            comparison = read_comparison(expect.value) if expect is not None else None
            if comparison is not None and not property_.is_assumption:
                expected.setdefault(property_.name, comparison)
    return expected


def fingerprint(analysis: Analysis, system: str) -> Texts:
    """The digests of the files of a system, with those that its distributions are read from. Results of a verification
    are valid as long as the digests are the same. The digests do not depend on the expectations of properties in XML,
    which do not change the results."""
    forest = analysis.forest(system) if executed_tree(analysis, system) is not None else None
    if forest is None:
        expanded = analysis.expanded(system)
        data = [path for path, _ in expanded.expansion.data] if expanded is not None else []
        paths = (*analysis.files_of(system), *data)
    else:
        data = [resolve(system, mock.data_file) for mock in mocks_beside(analysis, system) if mock.data_file]
        paths = (*(path for path, _ in forest.files), mocks_path(system), *data)
    sources = ((path, analysis.source(path)) for path in dict.fromkeys(paths))
    return tuple((path, _digest(analysis, path, source)) for path, source in sources if source is not None)


def _digest(analysis: Analysis, path: str, source: SourceFile) -> bytes:
    file = analysis.property_file(path) if analysis.kind(path) is FileKind.XML_PROPERTIES else None
    if file is None:
        return source.digest
    return analysis.memo.get("verified content", path, file, lambda: _without_expectations(file, source))


def _without_expectations(file: PropertyFile, source: SourceFile) -> bytes:
    parts, at = [], 0
    for written in file.properties:
        expect = written.element.get("expect")
        if expect is not None:
            parts.append(source.text[at : expect.span.start].rstrip())
            at = expect.span.end
    return SourceFile(source.path, "".join([*parts, source.text[at:]])).digest
