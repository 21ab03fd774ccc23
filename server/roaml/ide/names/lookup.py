# SPDX-License-Identifier: Apache-2.0
"""Finds all places that refer to the same symbol as a given place.

A file may belong to several systems, and a name in it may refer to a different symbol in each of them. All places that
refer to one of these symbols form a `SymbolGroup`, because a rename must change all of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property

from roaml.diagnostics import Symbol
from roaml.ide.names.occurrence import HANDLES, Occurrence
from roaml.ide.names.occurrences import Uses, uses
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.text import Location, Span

_IN_ONE_FILE = frozenset((SymbolKind.STATE, SymbolKind.VARIABLE, *HANDLES))
"""Kinds of symbols that can be used only in the file that defines them."""


class SymbolUse(Record, frozen=True):
    """An occurrence, and the path of the file that contains it."""

    path: str
    occurrence: Occurrence

    @property
    def location(self) -> Location:
        return Location(self.path, self.occurrence.span)


class SymbolGroup(Record, frozen=True, eq=False, dict=True):
    """Symbols that must be renamed together, and their uses. `symbols` begins with those at the requested place.

    `uses` are sorted by file and place, without duplicates.
    """

    symbols: tuple[Symbol, ...]
    uses: tuple[SymbolUse, ...]

    @cached_property
    def definitions(self) -> tuple[Location, ...]:
        return tuple(dict.fromkeys(use.location for use in self.uses if use.occurrence.defines))

    @property
    def kinds(self) -> frozenset[SymbolKind]:
        return frozenset(symbol.kind for symbol in self.symbols)


def occurrences_at(analysis: Analysis, path: str, offset: int) -> tuple[Occurrence, ...]:
    """The occurrences at a caret, in each system. A name that begins at the caret takes precedence over one that ends
    there."""
    touching = dict.fromkeys(
        occurrence
        for system in analysis.systems_of(path)
        for occurrence in uses(analysis, path, system).all
        if occurrence.span.contains(offset) and occurrence.span.start < occurrence.span.end
    )
    starting = [occurrence for occurrence in touching if occurrence.span.start <= offset < occurrence.span.end]
    return tuple(starting or touching)


def symbol_group_at(analysis: Analysis, path: str, offset: int) -> SymbolGroup | None:
    """The group of the name at a caret; `None` if there is no name."""
    occurrences = occurrences_at(analysis, path, offset)
    return symbol_group(analysis, (occurrence.symbol for occurrence in occurrences)) if occurrences else None


def symbol_group(analysis: Analysis, symbols: Iterable[Symbol]) -> SymbolGroup:
    """The group of `symbols`: all their uses, and all uses of the symbols that share a place with one of them."""
    seen = dict.fromkeys(symbols)
    todo = list(seen)
    uses_by_place: dict[tuple[str, Span], SymbolUse] = {}
    while todo:
        symbol = todo.pop(0)
        for path, uses_ in possible_uses(analysis, symbol):
            for occurrence in uses_.by_symbol.get(symbol, ()):
                place = (path, occurrence.span)
                # Several occurrences may be at one place. A definition takes precedence; then the first symbol does.
                if place not in uses_by_place or (occurrence.defines and not uses_by_place[place].occurrence.defines):
                    uses_by_place[place] = SymbolUse(path, occurrence)
                for other in _sharing(analysis, path, occurrence.span):
                    if other not in seen:
                        seen[other] = None
                        todo.append(other)
    return SymbolGroup(tuple(seen), tuple(uses_by_place[place] for place in sorted(uses_by_place)))


def _sharing(analysis: Analysis, path: str, span: Span) -> Iterator[Symbol]:
    for system in analysis.systems_of(path):
        for occurrence in uses(analysis, path, system).by_span.get(span, ()):
            yield occurrence.symbol


def possible_uses(analysis: Analysis, symbol: Symbol) -> Iterator[tuple[str, Uses]]:
    """The paths of the files that can use a symbol, each with the uses of names in it. A file occurs once for each
    system in which it can use the symbol."""
    if symbol.kind in _IN_ONE_FILE:
        for system in analysis.systems_of(symbol.path):
            yield symbol.path, uses(analysis, symbol.path, system)
        return
    if not symbol.path:
        systems: tuple[str | None, ...] = analysis.system_paths
    elif symbol.path in analysis.system_paths:
        systems = (symbol.path,)
    else:
        systems = analysis.systems_of(symbol.path)
    for system in systems:
        for path in analysis.files_of(system) if system else _family(analysis, symbol.path):
            yield path, uses(analysis, path, system)


def _family(analysis: Analysis, path: str) -> tuple[str, ...]:
    """The files that can use the names of a file that belongs to no system."""
    return analysis.family(path) if analysis.kind(path) is FileKind.TREE else (path,)
