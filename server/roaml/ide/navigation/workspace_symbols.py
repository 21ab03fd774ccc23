# SPDX-License-Identifier: Apache-2.0
"""Search for symbols of a workspace by a part of their name."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Symbol
from roaml.ide.names.occurrences import uses
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.text import Span


class WorkspaceSymbol(Record, frozen=True):
    """A definition. `container` is the name of the machine, struct, event or tree that contains it."""

    symbol: Symbol
    path: str
    span: Span
    container: str


def search(analysis: Analysis, paths: Iterable[str], query: str) -> tuple[WorkspaceSymbol, ...]:
    """The definitions in some files whose names contain the letters of `query` in that order, ignoring case."""
    letters = query.casefold()
    entries: dict[tuple[str, Span, SymbolKind], WorkspaceSymbol] = {}
    for path in paths:
        for system in analysis.systems_of(path):
            for occurrence in uses(analysis, path, system).all:
                if occurrence.defines and _matches(occurrence.symbol.name.casefold(), letters):
                    entry = WorkspaceSymbol(
                        occurrence.symbol, path, occurrence.span, _container(analysis, path, occurrence.symbol)
                    )
                    entries.setdefault((path, occurrence.span, occurrence.symbol.kind), entry)
    return tuple(entries.values())


def _matches(name: str, query: str) -> bool:
    letters = iter(name)
    return all(letter in letters for letter in query)


def _container(analysis: Analysis, path: str, symbol: Symbol) -> str:
    if symbol.kind in (SymbolKind.PARAMETER, SymbolKind.MEMBER, SymbolKind.BLACKBOARD):
        return symbol.scope
    machine = analysis.machine(path)
    return machine.name.value if machine and machine.name and symbol.kind is not SymbolKind.MACHINE else ""
