# SPDX-License-Identifier: Apache-2.0
"""The syntax of JANI properties as tables, read from the JSON Schema in `schemas/`.

Read on first use and kept.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from roaml.language.json_schema import PROPERTIES

_PREFIX = "#/$defs/"


@dataclass(frozen=True, slots=True)
class MemberType:
    """A member of a JSON object. `shape` names the `Shape` of its value if that is always the same, else ""."""

    key: str
    title: str
    documentation: str
    required: bool
    shape: str


@dataclass(frozen=True, slots=True)
class Shape:
    """A kind of JSON object. `operators` are the values that its member `op` may have; none if it has no such."""

    name: str
    title: str
    documentation: str
    operators: tuple[str, ...]
    members: Mapping[str, MemberType]


@functools.cache
def shapes() -> Mapping[str, Shape]:
    """All kinds of objects by their names in the schema, and "file" for the outermost one."""
    schema = PROPERTIES.root
    definitions = schema["$defs"]
    found = {name: _shape(name, node, definitions) for name, node in definitions.items() if "properties" in node}
    return {"file": _shape("file", schema, definitions), **found}


@functools.cache
def by_operator() -> Mapping[str, Shape]:
    """Operator as written -> the kind of object that it makes. What is said of formulas holds of expressions, too."""
    found: dict[str, Shape] = {}
    for shape in shapes().values():
        for operator in shape.operators:
            found.setdefault(operator, shape)
    return found


def _shape(name: str, node: Any, definitions: Any) -> Shape:
    members = node["properties"]
    required = frozenset(node.get("required", ()))
    return Shape(
        name,
        node.get("title", ""),
        node.get("description", ""),
        tuple(_values(members.get("op", {}), definitions)),
        {key: _member(key, member, key in required, definitions) for key, member in members.items()},
    )


def _values(node: Any, definitions: Any) -> Iterator[str]:
    """The few texts that a value may be."""
    if "const" in node:
        yield node["const"]
    yield from node.get("enum", ())
    if "$ref" in node:
        yield from _values(definitions[node["$ref"].removeprefix(_PREFIX)], definitions)


def _member(key: str, node: Any, required: bool, definitions: Any) -> MemberType:
    """What a member says of itself goes before what is said of its kind."""
    reference = node.get("$ref") or node.get("items", {}).get("$ref", "")
    kind = reference.removeprefix(_PREFIX)
    general = definitions.get(kind, {})
    if key == "op" and "title" not in node:
        general = definitions["formula"]["then"]["then"]["properties"]["op"]
    return MemberType(
        key,
        node.get("title", "") or general.get("title", ""),
        node.get("description", "") or general.get("description", ""),
        required,
        kind if "properties" in general else "",
    )
