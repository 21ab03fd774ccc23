# SPDX-License-Identifier: Apache-2.0
"""Finds the current position of a symbol."""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.model.machine import Send
from roaml.model.syntax import Name
from roaml.project.analysis import Analysis
from roaml.roles import SymbolKind
from roaml.text import Location


def locate(analysis: Analysis, symbol: Symbol) -> Location | None:
    """The position where a symbol is defined; for an event, that of its first `<send>` in the file. `None` if the
    symbol no longer exists."""
    name = _find(analysis, symbol)
    return None if name is None else Location(symbol.path, name.span)


def _find(analysis: Analysis, symbol: Symbol) -> Name | None:
    if symbol.kind is SymbolKind.TREE:
        tree = analysis.tree(symbol.path)
        return next((t.id for t in tree.trees if t.id and t.id.value == symbol.name), None) if tree else None
    machine = analysis.machine(symbol.path)
    if machine is None:
        return None
    match symbol.kind:
        case SymbolKind.MACHINE:
            return machine.name
        case SymbolKind.PORT:
            return next((p.key for p in machine.ports if p.key and p.key.value == symbol.name), None)
        case SymbolKind.STATE:
            states = (s for c in machine.charts if c.scope == symbol.scope for s in c.states)
            return next((s.id for s in states if s.id and s.id.value == symbol.name), None)
        case SymbolKind.VARIABLE:
            data = [d for c in machine.charts if c.scope == symbol.scope for d in c.data]
            return next((d.id for d in data if d.id and d.id.value == symbol.name), None)
        case SymbolKind.EVENT:
            sends = [s for c in machine.charts for s in c.statements if isinstance(s, Send)]
            return next((s.event for s in sends if s.event and s.event.value == symbol.name), None)
    for declaration in machine.declarations:
        if declaration.kind == symbol.kind and declaration.handle and declaration.handle.value == symbol.name:
            return declaration.handle
    return None
