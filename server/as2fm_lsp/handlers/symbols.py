# SPDX-License-Identifier: Apache-2.0
"""The kinds of the language's symbols as those of the protocol."""

from __future__ import annotations

from lsprotocol import types

from roaml.ide.occurrence import HANDLES

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
