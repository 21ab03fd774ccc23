# SPDX-License-Identifier: Apache-2.0
"""All uses of names in a file, as a part of one system, or as a file without a system."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

from roaml.diagnostics import Symbol
from roaml.expansion.uses import VARIABLE
from roaml.ide.names.frames import Piece, Trees
from roaml.ide.names.in_machine import in_machine
from roaml.ide.names.in_parameters import in_parameters
from roaml.ide.names.in_properties import in_properties, names
from roaml.ide.names.in_property_file import in_property_file
from roaml.ide.names.in_structs import in_json, in_xml
from roaml.ide.names.in_tree import in_tree
from roaml.ide.names.occurrence import Occurrence
from roaml.model.expand import ListedTree
from roaml.model.kinds import FileKind
from roaml.model.property_file import PortKind
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.text import Span


class Uses(Record, frozen=True, eq=False):
    """The uses of names in one file: as a sequence in the order of the text, by symbol, and by span."""

    all: tuple[Occurrence, ...]
    by_symbol: Mapping[Symbol, tuple[Occurrence, ...]]
    by_span: Mapping[Span, tuple[Occurrence, ...]]


def uses(analysis: Analysis, path: str, system: str | None) -> Uses:
    """The uses of names in the file `path`, as a part of `system`; if it is `None`, as a file without a system. The
    result is cached."""
    source = analysis.source(path)
    if source is None:
        return _index(())
    expanded = analysis.expanded(system) if system else analysis.expanded_file(path)
    key: tuple[object, ...] = (source.text, analysis.structs(system), expanded and expanded.expansion)
    if analysis.kind_in(path, system) is FileKind.MACHINE and analysis.machine(path) is not None:
        key = (*key, analysis.typed_in(path, system))  # contains everything of the system on which the uses depend
    else:
        key = (*key, analysis.system(system) if system else None, trees_of(analysis, path, system))
    return analysis.memo.get("uses", (path, system), key, lambda: _index(_of(analysis, path, system)))


def occurrences(analysis: Analysis, path: str, system: str | None = None) -> tuple[Occurrence, ...]:
    """All uses of names in a file, in the order of the text."""
    return uses(analysis, path, system).all


def _index(occurrences: Iterable[Occurrence]) -> Uses:
    """The index of some occurrences, without duplicates."""
    by_symbol: dict[Symbol, list[Occurrence]] = {}
    by_span: dict[Span, list[Occurrence]] = {}
    ordered: list[Occurrence] = []
    for occurrence in sorted(occurrences, key=lambda o: (o.span, o.symbol.kind)):
        there = by_span.setdefault(occurrence.span, [])
        if occurrence not in there:
            there.append(occurrence)
            ordered.append(occurrence)
            by_symbol.setdefault(occurrence.symbol, []).append(occurrence)
    return Uses(
        tuple(ordered),
        {symbol: tuple(uses_) for symbol, uses_ in by_symbol.items()},
        {span: tuple(uses_) for span, uses_ in by_span.items()},
    )


def _of(analysis: Analysis, path: str, system: str | None) -> Iterator[Occurrence]:
    parameters = tuple(in_parameters(analysis, path, system))
    yield from parameters
    spans = {occurrence.span for occurrence in parameters}
    expanded = analysis.expanded(system) if system else None
    delivered = expanded.expansion.delivered if expanded is not None else {}
    for occurrence in _of_kind(analysis, path, system):
        if occurrence.symbol in delivered:
            yield from _parts(analysis, path, occurrence, *delivered[occurrence.symbol])
        elif occurrence.span not in spans:  # the name of a parameter is that of a variable only where one hides it
            yield occurrence
    yield from (use.occurrence for use in _with_parameters(analysis, path, system) if use.is_written)


def _parts(
    analysis: Analysis, path: str, occurrence: Occurrence, sent: Symbol, receiver: Symbol
) -> Iterator[Occurrence]:
    """The names of the topic or service, and of the machine, in a name from which the machine receives through a
    channel, such as `level/to_Monitor`, or `level__to_Monitor` in JANI (docs/spec/channels.md#expansion)."""
    source, span = analysis.source(path), occurrence.span
    assert source is not None
    written = source.text[span.start : span.end]
    forms = (f"/to_{receiver.name}", f"__to_{receiver.name}")
    own = next((form for form in forms if written.endswith(form)), None)
    if own is None:  # a part is written with entities
        yield occurrence
        return
    yield occurrence._replace(span=Span(span.start, span.end - len(own)), symbol=sent)
    yield Occurrence(Span(span.end - len(receiver.name), span.end), receiver)


class _ExpandedUse(NamedTuple):
    """A part of the path of a node, in a path that contains parameters. `is_written` tells whether the part itself
    contains none."""

    occurrence: Occurrence
    is_written: bool


def from_parameters(analysis: Analysis, path: str, system: str) -> Iterator[Occurrence]:
    """The parts of paths of nodes in a property file that values of parameters name. Their spans are those of the uses
    of the parameters."""
    yield from (use.occurrence for use in _with_parameters(analysis, path, system) if not use.is_written)


def _with_parameters(analysis: Analysis, path: str, system: str | None) -> Iterator[_ExpandedUse]:
    file = (
        analysis.property_file(path) if system and analysis.kind_in(path, system) is FileKind.XML_PROPERTIES else None
    )
    expanded = analysis.expanded(system) if system else None
    if file is None or expanded is None:
        return
    ports = (port for port in file.ports if port.kind is PortKind.NODE and port.name is not None)
    paths = [port.name.span for port in ports if port.name is not None and VARIABLE.search(port.name.value)]
    for variant in expanded.expansion.paths(path) if paths else ():
        text = expanded.expansion.texts.get(variant)
        for found in uses(expanded.analysis, variant, system).all if text is not None else ():
            assert text is not None
            span = text.origin(found.span)
            if any(place.start <= span.start and span.end <= place.end for place in paths):
                symbol = expanded.symbol(found.symbol)
                yield _ExpandedUse(found._replace(span=span, symbol=symbol), text.is_written(found.span))


def _of_kind(analysis: Analysis, path: str, system: str | None) -> Iterator[Occurrence]:
    source, owner = analysis.source(path), system or path
    kind = analysis.kind_in(path, system)
    assert source is not None
    if kind is FileKind.MACHINE:
        machine = analysis.machine(path)
        if machine is not None:
            types = analysis.typed_in(path, system).variables
            yield from in_machine(source.text, machine, path, owner, types, analysis.environment(system))
    elif kind is FileKind.TREE:
        document, trees = analysis.document(path), trees_of(analysis, path, system)
        if document is not None and path in trees.files:
            yield from in_tree(document, path, trees, analysis.system(system) if system else None)
    elif kind is FileKind.STRUCTS:
        yield from in_xml(analysis.struct_declarations(path), owner)
    elif kind is FileKind.JSON_STRUCTS:
        value = analysis.json(path)
        if value is not None:
            yield from in_json(source.text, value[0], analysis.struct_declarations(path), owner)
    elif kind is FileKind.PROPERTIES and system is not None:
        properties, _ = analysis.properties(path)
        yield from in_properties(source.text, properties, global_names(analysis, system))
    elif kind is FileKind.XML_PROPERTIES and (file := analysis.property_file(path)) is not None:
        linked = analysis.system(system) if system else None
        table = global_names(analysis, system) if system else {}
        trees, find = trees_of(analysis, path, system), analysis.environment(system).interface
        yield from in_property_file(source.text, file, path, owner, linked, trees, table, find)


def global_names(analysis: Analysis, system: str) -> Mapping[str, tuple[Piece, ...]]:
    """The names of the global variables of a translated system -> their parts."""
    linked = analysis.system(system)
    if linked is None:
        return {}
    variables, trees = analysis.globals(system), trees_of(analysis, system, system)
    find = analysis.environment(system).interface
    return analysis.memo.get("global names", system, (linked, trees), lambda: names(linked, variables, trees, find))


def trees_of(analysis: Analysis, path: str, system: str | None) -> Trees:
    """The trees of a system. If `system` is `None`, the trees of the file `path` and of the files that are connected
    with it by includes."""
    listed = analysis.executed_trees(system) if system else (ListedTree("", analysis.family_outlines(path)),)
    paths = tuple(dict.fromkeys(outline.path for tree in listed for outline in tree.files))
    digests = tuple(getattr(analysis.source(tree), "digest", b"") for tree in paths)
    owner = system or next(iter(paths), path)
    make = functools.partial(Trees, analysis, listed, owner, is_alone=system is None)
    return analysis.memo.get("trees", owner, (listed, digests), make)
