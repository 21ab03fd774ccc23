# SPDX-License-Identifier: Apache-2.0
"""Finds the declarations in a JSON Schema of `schemas/` that apply to a place in a JSON document.

- Supports what the schemas use: references, `allOf`, `if`/`then`/`else`, `properties`, `additionalProperties`, `items`,
  `required`, `enum` and `const`.
- Nothing is validated here: the results are used to complete incomplete documents.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from roaml.json_syntax import JsonArray, JsonBool, JsonNumber, JsonObject, JsonString, JsonValue
from roaml.language.resources import schema_path
from roaml.record import Record

Schema: TypeAlias = Mapping[str, Any]

_MAX_DEPTH = 40
"""The maximum number of parts of a schema that `applying` returns, because references may form cycles."""


class Key(Record, frozen=True):
    """A member that an object may have."""

    name: str
    schema: Schema
    required: bool


class JsonGrammar(Record, frozen=True, dict=True):
    """The grammar of JSON documents that a schema file defines."""

    name: str

    @functools.cached_property
    def root(self) -> Schema:
        schema: Schema = json.loads(schema_path(self.name).read_text(encoding="utf-8"))
        return schema

    def definition(self, name: str) -> Schema:
        definition: Schema = self.root["$defs"][name]
        return definition

    def applying(self, schema: Schema, value: JsonValue | None) -> Iterator[Schema]:
        """The parts of a schema that apply to a value, the outermost first. `None` represents a value that is not
        written yet."""
        stack, seen = [schema], 0
        while stack and seen < _MAX_DEPTH:
            seen += 1
            part = stack.pop()
            if "$ref" in part:
                stack.append(self._resolve(part["$ref"]))
            yield part
            branches = list(part.get("allOf", ()))
            if "if" in part:
                branch = "then" if self.matches(part["if"], value) else "else"
                branches += [part[branch]] if branch in part else []
            stack += reversed(branches)

    def keys(self, schema: Schema, value: JsonObject) -> dict[str, Key]:
        """The members that the object `value` may have, by name. Existing members decide which conditions of the schema
        apply."""
        keys: dict[str, Key] = {}
        applying = list(self.applying(schema, value))
        required = {name for part in applying for name in part.get("required", ())}
        for part in applying:
            for name, inner in part.get("properties", {}).items():
                # If several parts declare one key, the first with documentation is the most specific.
                if name not in keys or not self.text(keys[name].schema):
                    keys[name] = Key(name, inner, name in required)
        return keys

    def member(self, schema: Schema, value: JsonObject, key: str) -> Schema:
        """The declaration of the member `key` of an object."""
        parts = []
        for part in self.applying(schema, value):
            if key in part.get("properties", {}):
                parts.append(part["properties"][key])
            elif isinstance(part.get("additionalProperties"), dict):
                parts.append(part["additionalProperties"])
        return parts[0] if len(parts) == 1 else {"allOf": parts}

    def item(self, schema: Schema, value: JsonArray) -> Schema:
        """The declaration of the items of a list."""
        return {"allOf": [part["items"] for part in self.applying(schema, value) if "items" in part]}

    def choices(self, schema: Schema) -> tuple[str, ...]:
        """The values that the schema lists by `enum` or `const`; `()` if it lists none."""
        for part in self.applying(schema, None):
            if "enum" in part:
                return tuple(part["enum"])
            if "const" in part:
                return (part["const"],)
        return ()

    def operators(self, kind: str) -> Iterator[tuple[str, Schema]]:
        """The operators of formulas or expressions, each with the declaration of the objects that use it. `kind` is the
        name of the definition of formulas or expressions."""
        for branch in self.definition(kind)["then"]["then"]["allOf"]:
            described = self._resolve(branch["then"]["$ref"])
            for operator in self.choices(branch["if"]["properties"]["op"]):
                yield operator, described

    def title(self, schema: Schema) -> str:
        return self._annotation(schema, "title")

    def text(self, schema: Schema) -> str:
        """The documentation of a place, in Markdown; "" if there is none."""
        return self._annotation(schema, "description")

    def is_a(self, schema: Schema, definition: str) -> bool:
        """Whether the definition with the name `definition` applies to the place that `schema` describes."""
        target = self.definition(definition)
        return any(part is target for part in self.applying(schema, None))

    def matches(self, schema: Schema, value: JsonValue | None) -> bool:
        """Whether a value satisfies the condition `schema` of an `if`."""
        if "$ref" in schema and not self.matches(self._resolve(schema["$ref"]), value):
            return False
        if "type" in schema and not _has_type(value, schema["type"]):
            return False
        if "const" in schema and _plain(value) != schema["const"]:
            return False
        if "enum" in schema and _plain(value) not in schema["enum"]:
            return False
        if isinstance(value, JsonObject):
            members = {member.key: member.value for member in value.members}
            if any(name not in members for name in schema.get("required", ())):
                return False
            inner = schema.get("properties", {})
            return all(self.matches(inner[name], members[name]) for name in inner if name in members)
        return True

    def _annotation(self, schema: Schema, keyword: str) -> str:
        """The value of an annotation such as `title`; "" if there is none. The declaration of a place takes precedence
        over the definitions to which it refers."""
        return next((str(part[keyword]) for part in self.applying(schema, None) if keyword in part), "")

    def _resolve(self, reference: str) -> Schema:
        return self.definition(reference.rpartition("/")[2])


PROPERTIES = JsonGrammar("jani-properties.schema.json")
JSON_STRUCTS = JsonGrammar("structs.schema.json")


def _has_type(value: JsonValue | None, types: str | list[str]) -> bool:
    allowed = [types] if isinstance(types, str) else types
    match value:
        case JsonObject():
            return "object" in allowed
        case JsonArray():
            return "array" in allowed
        case JsonString():
            return "string" in allowed
        case JsonNumber():
            return "number" in allowed
        case JsonBool():
            return "boolean" in allowed
    return False


def _plain(value: JsonValue | None) -> str | int | float | bool | None:
    return value.value if isinstance(value, (JsonString, JsonNumber, JsonBool)) else None
