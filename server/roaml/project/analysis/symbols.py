# SPDX-License-Identifier: Apache-2.0
"""Finds the names where symbols are defined."""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.model.machine import Send
from roaml.model.syntax import Name
from roaml.project.analysis.sources import SourceFiles
from roaml.roles import SymbolKind


def symbol_name(sources: SourceFiles, symbol: Symbol) -> Name | None:
    """The name where a symbol is defined; for an event, that of its first `<send>` in the file. `None` if the symbol no
    longer exists."""
    if symbol.kind is SymbolKind.TREE:
        tree = sources.tree(symbol.path)
        return next((t.id for t in tree.trees if t.id and t.id.value == symbol.name), None) if tree else None
    machine = sources.machine(symbol.path)
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
