# SPDX-License-Identifier: Apache-2.0
"""Symbols on their way to the client and back, and their kinds as those of the protocol."""

from __future__ import annotations

from lsprotocol import types

from roaml.diagnostics import Symbol
from roaml.ide.names.occurrence import HANDLES

_KINDS = {
    "machine": types.SymbolKind.Class,
    "plugin": types.SymbolKind.Class,
    "tree": types.SymbolKind.Module,
    "tree-node": types.SymbolKind.Object,
    "state": types.SymbolKind.EnumMember,
    "variable": types.SymbolKind.Variable,
    "blackboard": types.SymbolKind.Variable,
    "port": types.SymbolKind.Property,
    "struct": types.SymbolKind.Struct,
    "member": types.SymbolKind.Field,
    "parameter": types.SymbolKind.Field,
    "event": types.SymbolKind.Event,
    **dict.fromkeys(("topic", "service", "action", *HANDLES), types.SymbolKind.Interface),
}


def symbol_kind(kind: str) -> types.SymbolKind:
    return _KINDS.get(kind, types.SymbolKind.Object)


def pack(symbol: Symbol) -> list[str]:
    """As a client keeps it for us."""
    return [symbol.path, symbol.kind, symbol.name, symbol.scope]


def unpack(data: object) -> Symbol | None:
    """What `pack` made; None if it is something else."""
    return Symbol(*map(str, data)) if isinstance(data, (list, tuple)) and len(data) == 4 else None
