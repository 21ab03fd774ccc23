# SPDX-License-Identifier: Apache-2.0
"""Struct declarations in a JSON Schema (docs/spec/types.md#json-structs).

The root object is a struct named by its `title`. An inline object is a struct named after its property. A `$ref` names
a definition; definitions that the root does not reach declare no structs. A part that has no corresponding type in
HL-SCXML is reported. A struct that cannot be read is declared as incomplete. If there are findings, so are the
definitions that are not reached.
"""

from __future__ import annotations

from roaml.diagnostics import Finding
from roaml.expr.types import TypeName
from roaml.json_syntax import JsonArray, JsonObject, JsonString, JsonValue, Member
from roaml.model.structs import MemberDeclaration, StructDeclaration
from roaml.model.syntax import Name, TypeRef

CODE = "json-schema"

_BASE = {"boolean": "bool", "integer": "int32", "number": "float32", "string": "string"}
_MAX_DEPTH = 50
_DEFINITIONS = ("$defs", "definitions")


def structs_in_json(value: JsonValue) -> tuple[tuple[StructDeclaration, ...], tuple[Finding, ...]]:
    """The structs of a schema, and findings for the parts that cannot be read as structs."""
    reader = _Reader(value)
    reader.root()
    reader.unread()
    return tuple(reader.structs), tuple(reader.findings)


class _Reader:
    def __init__(self, value: JsonValue) -> None:
        self.value = value
        self.structs: list[StructDeclaration] = []
        self.findings: list[Finding] = []
        self.done: set[str] = set()
        self.depth = 0

    def root(self) -> None:
        schema = self.value
        if not isinstance(schema, JsonObject):
            self.report(schema, "struct declarations in JSON must be a JSON Schema, which is an object")
            self.incomplete(schema, None)
            return
        if _text(schema.get("type")) != "object":
            self.report(schema.get("type") or schema, 'the schema of a struct needs `"type": "object"`')
        title = schema.get("title")
        if not isinstance(title, JsonString) or not title.value:
            self.report(title or schema, 'the schema has no `"title"`; add it as the name of the struct')
            self.incomplete(schema, None)
            return
        self.object(schema, Name(title.value, title.content_span))

    def unread(self) -> None:
        """If there are findings, declare the definitions that are not reached as incomplete structs, because an
        unreadable part may use them."""
        if not self.findings or not isinstance(self.value, JsonObject):
            return
        for section in _DEFINITIONS:
            definitions = self.value.get(section)
            for member in definitions.members if isinstance(definitions, JsonObject) else ():
                if member.value is not None and member.key not in self.done:
                    self.incomplete(member.value, Name(member.key, member.key_content_span))

    def incomplete(self, schema: JsonValue, name: Name | None) -> None:
        self.structs.append(StructDeclaration(name, (), schema.span, complete=False))

    def object(self, schema: JsonObject, name: Name) -> None:
        """Declare the struct that an object schema describes."""
        if name.value in self.done:
            return
        self.done.add(name.value)
        if self.depth >= _MAX_DEPTH:
            self.report(schema, f"structs are nested more than {_MAX_DEPTH} levels deep")
            self.incomplete(schema, name)
            return
        self.depth += 1
        properties = schema.get("properties")
        if not isinstance(properties, JsonObject) or not properties.members:
            self.report(properties or schema, f"the struct `{name.value}` has no members; add them as `properties`")
            self.incomplete(schema, name)
            return
        # A struct is listed before the structs that it contains.
        index = len(self.structs)
        self.structs.append(StructDeclaration(name, (), schema.span))
        members = tuple(self.member(member) for member in properties.members)
        self.structs[index] = StructDeclaration(name, members, schema.span)
        self.depth -= 1

    def member(self, member: Member) -> MemberDeclaration:
        name = Name(member.key, member.key_span)
        type_ = self.type(member.value, name) if member.value is not None else None
        text = "" if type_ is None else type_.base + "[]" * len(type_.dimensions)
        ref = None if member.value is None or type_ is None else TypeRef(text, member.value.span, type_)
        return MemberDeclaration(name, ref, member.span)

    def type(self, schema: JsonValue, name: Name) -> TypeName | None:
        dimensions: tuple[None, ...] = ()
        while isinstance(schema, JsonObject) and _text(schema.get("type")) == "array":
            items = schema.get("items")
            if items is None:
                self.report(schema, f"the array `{name.value}` has no `items`; add the schema of its elements")
                return None
            schema, dimensions = items, (*dimensions, None)
        if not isinstance(schema, JsonObject):
            self.report(schema, f"the schema of `{name.value}` is not an object")
            return None
        base = self.reference(schema) if schema.get("$ref") else self.base(schema, name)
        return TypeName(base, dimensions) if base else None

    def base(self, schema: JsonObject, name: Name) -> str:
        kind = schema.get("type")
        text = _text(kind)
        if text == "object":
            self.object(schema, name)
            return name.value
        if text in _BASE:
            return _BASE[text]
        if isinstance(kind, JsonArray):
            self.report(kind, f"`{name.value}` has several types, but a member must have exactly one")
        elif kind is None:
            self.report(schema, f"`{name.value}` has no `type`; valid types are {', '.join(_BASE)}, array and object")
        else:
            self.report(
                kind,
                f"the type of `{name.value}` is not supported; valid types are {', '.join(_BASE)}, array and object",
            )
        return ""

    def reference(self, schema: JsonObject) -> str:
        target = schema.get("$ref")
        path = _text(target).split("/")
        if not isinstance(target, JsonString) or len(path) != 3 or path[0] != "#" or path[1] not in _DEFINITIONS:
            self.report(target or schema, "a `$ref` must refer to a definition in this file: `#/$defs/NAME`")
            return ""
        definitions = self.value.get(path[1]) if isinstance(self.value, JsonObject) else None
        definition = definitions.get(path[2]) if isinstance(definitions, JsonObject) else None
        if not isinstance(definition, JsonObject):
            self.report(target, f"there is no definition `{path[2]}` under `{path[1]}`")
            return ""
        if _text(definition.get("type")) in _BASE:
            return _BASE[_text(definition.get("type"))]
        self.object(definition, Name(path[2], target.content_span))
        return path[2]

    def report(self, value: JsonValue, message: str) -> None:
        self.findings.append(Finding(CODE, value.span, message))


def _text(value: JsonValue | None) -> str:
    return value.value if isinstance(value, JsonString) else ""
