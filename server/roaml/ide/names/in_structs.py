# SPDX-License-Identifier: Apache-2.0
"""The names in struct declarations, written in XML or as a JSON Schema."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Symbol
from roaml.ide.names.in_machine import type_use
from roaml.ide.names.occurrence import Occurrence
from roaml.json_syntax import JsonArray, JsonObject, JsonString, JsonValue
from roaml.model.structs import StructDeclaration
from roaml.model.syntax import Name
from roaml.roles import SymbolKind
from roaml.text import Span


def in_xml(declarations: Iterable[StructDeclaration], owner: str) -> Iterator[Occurrence]:
    for struct in declarations:
        if struct.name is None:
            continue
        yield Occurrence(struct.name.span, Symbol(owner, SymbolKind.STRUCT, struct.name.value), defines=True)
        for member in struct.members:
            if member.name is not None:
                symbol = Symbol(owner, SymbolKind.MEMBER, member.name.value, struct.name.value)
                yield Occurrence(member.name.span, symbol, defines=True)
            yield from type_use(owner, member.type)


def in_json(text: str, value: JsonValue, declarations: Iterable[StructDeclaration], owner: str) -> Iterator[Occurrence]:
    """The occurrences in a JSON Schema. The key of a property that is an object is the name of both a member and a
    struct (docs/spec/types.md#json-structs)."""
    occurrences: dict[Occurrence, None] = {}
    names = set()
    for struct in declarations:
        if struct.name is None:
            continue
        names.add(struct.name.value)
        span = _span(text, struct.name)
        if span is not None:
            occurrences[Occurrence(span, Symbol(owner, SymbolKind.STRUCT, struct.name.value), defines=True)] = None
        for member in struct.members:
            span = _span(text, member.name)
            if member.name is None or span is None:
                continue
            symbol = Symbol(owner, SymbolKind.MEMBER, member.name.value, struct.name.value)
            occurrences[Occurrence(span, symbol, defines=True)] = None
            inner = member.type.name if member.type else None
            if inner is not None and inner.base == member.name.value and not _refers(text, member.type):
                occurrences[Occurrence(span, Symbol(owner, SymbolKind.STRUCT, inner.base), defines=True)] = None
    for name, span in _definitions(value):
        if name in names and text[span.start : span.end] == name:
            occurrences[Occurrence(span, Symbol(owner, SymbolKind.STRUCT, name), defines=True)] = None
    yield from occurrences


def _span(text: str, name: Name | None) -> Span | None:
    """The span of a name without the quotes or the path around it; `None` if the name is written with escapes."""
    if name is None:
        return None
    start = text.rfind(name.value, name.span.start, name.span.end)
    return None if start < 0 else Span(start, start + len(name.value))


def _refers(text: str, type_: object) -> bool:
    """Whether the type of a member is a `$ref` instead of an inline definition."""
    span = getattr(type_, "span", None)
    return isinstance(span, Span) and '"$ref"' in text[span.start : span.end]


def _definitions(value: JsonValue) -> Iterator[tuple[str, Span]]:
    """The names of definitions and their spans: the keys of `$defs` and `definitions`, and the last parts of all
    references."""
    stack = [value]
    while stack:
        node = stack.pop()
        if isinstance(node, JsonArray):
            stack.extend(node.items)
        if not isinstance(node, JsonObject):
            continue
        for member in node.members:
            if member.value is not None:
                stack.append(member.value)
            if member.key in ("$defs", "definitions") and node is value and isinstance(member.value, JsonObject):
                yield from ((definition.key, definition.key_content_span) for definition in member.value.members)
            elif member.key == "$ref" and isinstance(member.value, JsonString):
                name = member.value.value.rpartition("/")[2]
                span = member.value.content_span
                yield name, Span(span.end - len(name), span.end)
