# SPDX-License-Identifier: Apache-2.0
"""Conversion of symbols to the client and back, and their kinds in the protocol."""

from __future__ import annotations

from lsprotocol import types

from roaml.diagnostics import Symbol
from roaml.roles import SymbolKind


def symbol_kind(kind: SymbolKind) -> types.SymbolKind:
    match kind:
        case SymbolKind.MACHINE | SymbolKind.PLUGIN:
            return types.SymbolKind.Class
        case SymbolKind.TREE:
            return types.SymbolKind.Module
        case SymbolKind.STATE | SymbolKind.ENUMERATION_VALUE:
            return types.SymbolKind.EnumMember
        case SymbolKind.VARIABLE | SymbolKind.BLACKBOARD | SymbolKind.EVENT_VARIABLE | SymbolKind.GLOBAL:
            return types.SymbolKind.Variable
        case SymbolKind.PORT_VARIABLE:
            return types.SymbolKind.Variable
        case SymbolKind.PROPERTY:
            return types.SymbolKind.Boolean
        case SymbolKind.PORT | SymbolKind.ATTRIBUTE | SymbolKind.JSON:
            return types.SymbolKind.Property
        case SymbolKind.STRUCT | SymbolKind.ROS_TYPE | SymbolKind.BASE_TYPE:
            return types.SymbolKind.Struct
        case SymbolKind.MODEL_PARAMETER:
            return types.SymbolKind.Constant
        case SymbolKind.MEMBER | SymbolKind.PARAMETER | SymbolKind.FIELD:
            return types.SymbolKind.Field
        case SymbolKind.EVENT:
            return types.SymbolKind.Event
        case SymbolKind.FUNCTION:
            return types.SymbolKind.Function
        case SymbolKind.TOPIC | SymbolKind.SERVICE | SymbolKind.ACTION | SymbolKind.TIMER:
            return types.SymbolKind.Interface
        case SymbolKind.PUBLISHER | SymbolKind.SUBSCRIBER:
            return types.SymbolKind.Interface
        case SymbolKind.SERVICE_CLIENT | SymbolKind.SERVICE_SERVER:
            return types.SymbolKind.Interface
        case SymbolKind.ACTION_CLIENT | SymbolKind.ACTION_SERVER:
            return types.SymbolKind.Interface
        case SymbolKind.TREE_NODE | SymbolKind.TREE_INSTANCE | SymbolKind.ELEMENT:
            return types.SymbolKind.Object


def pack(symbol: Symbol) -> list[str]:
    """A symbol in the form in which a client stores it."""
    return [symbol.path, symbol.kind.value, symbol.name, symbol.scope]


def unpack(data: object) -> Symbol | None:
    """The inverse of `pack`; `None` if the data are not a packed symbol."""
    if not isinstance(data, (list, tuple)) or len(data) != 4:
        return None
    path, kind, name, scope = map(str, data)
    return Symbol(path, SymbolKind(kind), name, scope) if kind in _NAMES else None


_NAMES = frozenset(kind.value for kind in SymbolKind)
