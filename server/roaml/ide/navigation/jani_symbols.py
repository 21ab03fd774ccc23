# SPDX-License-Identifier: Apache-2.0
"""The outline of a JANI model: constants, variables, automata with their locations and edges, properties."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from roaml.ide.describe.property_file import formula
from roaml.ide.json_tree import members
from roaml.ide.navigation.document_symbol import DocumentSymbol, DocumentSymbolKind
from roaml.json_syntax import JsonArray, JsonObject, JsonString, JsonValue

_MAX_CHARACTERS = 80
"""The maximum number of characters of a formula in the detail of an entry."""


def jani_symbols(value: JsonValue | None) -> Iterator[DocumentSymbol]:
    """The sections of a model that are not empty, in the order of the text."""
    if not isinstance(value, JsonObject):
        return
    for section in value.members:
        make = _SECTIONS.get(section.key)
        if make is not None and isinstance(section.value, JsonArray) and section.value.items:
            children = tuple(child for item in section.value.items if (child := make(item)) is not None)
            detail = str(len(section.value.items))
            yield DocumentSymbol(
                section.key, detail, DocumentSymbolKind.SECTION, section.span, section.key_span, children
            )


def _named(item: JsonValue, kind: DocumentSymbolKind, detail: str, *children: DocumentSymbol) -> DocumentSymbol | None:
    name = members(item).get("name")
    if not isinstance(name, JsonString) or not name.value:
        return None
    return DocumentSymbol(name.value, detail, kind, item.span, name.content_span, children)


def _variable(item: JsonValue) -> DocumentSymbol | None:
    return _named(item, DocumentSymbolKind.VARIABLE, _type(members(item).get("type")))


def _type(value: JsonValue | None) -> str:
    """A type in the usual notation: `int`, `int[0..9]`, `bool[]`."""
    if isinstance(value, JsonString):
        return value.value
    parts = members(value) if value is not None else {}
    base = _type(parts.get("base"))
    kind = parts.get("kind")
    if isinstance(kind, JsonString) and kind.value == "array":
        return f"{base}[]"
    if "lower-bound" in parts or "upper-bound" in parts:
        bounds = (_short(formula(parts[key])) if key in parts else "" for key in ("lower-bound", "upper-bound"))
        return f"{base}[{'..'.join(bounds)}]"
    return base


def _action(item: JsonValue) -> DocumentSymbol | None:
    return _named(item, DocumentSymbolKind.TRANSITION, "")


def _property(item: JsonValue) -> DocumentSymbol | None:
    expression = members(item).get("expression")
    return _named(item, DocumentSymbolKind.PROPERTY, _short(formula(expression)) if expression is not None else "")


def _automaton(item: JsonValue) -> DocumentSymbol | None:
    parts = members(item)
    children = [
        *(
            _named(variable, DocumentSymbolKind.VARIABLE, _type(members(variable).get("type")))
            for variable in _items(parts, "variables")
        ),
        *(_named(location, DocumentSymbolKind.STATE, "") for location in _items(parts, "locations")),
        *(_edge(edge) for edge in _items(parts, "edges")),
    ]
    return _named(item, DocumentSymbolKind.MACHINE, "", *(child for child in children if child is not None))


def _edge(item: JsonValue) -> DocumentSymbol | None:
    """The symbol of an edge: the name of its action, with its source, destinations and guard as detail; `None` if the
    edge has no source."""
    parts = members(item)
    location, action = parts.get("location"), parts.get("action")
    if not isinstance(location, JsonString):
        return None
    targets = (members(destination).get("location") for destination in _items(parts, "destinations"))
    named = dict.fromkeys(target.value for target in targets if isinstance(target, JsonString))
    guard = members(parts["guard"]).get("exp") if "guard" in parts else None
    detail = f"{location.value} → {', '.join(named)}"
    if guard is not None:
        detail = f"{detail} [{_short(formula(guard))}]"
    name = action.value if isinstance(action, JsonString) else "τ"
    place = action if isinstance(action, JsonString) else location
    return DocumentSymbol(name, detail, DocumentSymbolKind.TRANSITION, item.span, place.content_span)


def _items(parts: dict[str, JsonValue], key: str) -> tuple[JsonValue, ...]:
    value = parts.get(key)
    return tuple(value.items) if isinstance(value, JsonArray) else ()


def _short(text: str) -> str:
    return text if len(text) <= _MAX_CHARACTERS else f"{text[: _MAX_CHARACTERS - 1]}…"


_SECTIONS: dict[str, Callable[[JsonValue], DocumentSymbol | None]] = {
    "actions": _action,
    "constants": _variable,
    "variables": _variable,
    "automata": _automaton,
    "properties": _property,
}
