# SPDX-License-Identifier: Apache-2.0
"""The scripts in trees: where they stand (docs/spec/trees.md#scripts) and whether their values are conditions."""

from __future__ import annotations

import functools
from collections.abc import Iterator
from dataclasses import dataclass

from roaml.forest.cpp_types import SCRIPT
from roaml.forest.forest import Forest
from roaml.model.tree import TreeNode
from roaml.script.parse import Problem, parse
from roaml.script.tree import Assignment, Name, Script, walk
from roaml.text import Decoded
from roaml.xml_syntax import Attribute

CONDITIONS = ("_failureIf", "_successIf", "_skipIf", "_while")
"""Asked before a node is ticked."""
AFTERWARDS = ("_onSuccess", "_onFailure", "_onHalted", "_post")
"""Executed after a node has ended."""

_CONDITION_PORTS = ("Precondition", "ScriptCondition")


@dataclass(frozen=True, slots=True)
class ScriptUse:
    """A script at a node. `is_condition` tells that its value must be true or false."""

    node: TreeNode
    attribute: Attribute
    is_condition: bool


def scripts_of(forest: Forest, node: TreeNode) -> Iterator[ScriptUse]:
    for name in (*CONDITIONS, *AFTERWARDS):
        attribute = node.element.get(name)
        if attribute is not None and attribute.has_value:
            yield ScriptUse(node, attribute, name in CONDITIONS)
    known = forest.known_node(node)
    for port in known.ports if known else ():
        attribute = node.element.get(port.name) if port.type == SCRIPT else None
        if known is not None and attribute is not None and attribute.has_value:
            yield ScriptUse(node, attribute, known.name in _CONDITION_PORTS)


@functools.lru_cache(maxsize=2048)
def parsed(source: Decoded) -> tuple[Script, tuple[Problem, ...]]:
    """The script in a text, remembered: many rules ask."""
    return parse(source)


@functools.lru_cache(maxsize=2048)
def names_in(text: str) -> tuple[tuple[str, str], ...]:
    """The names in a script: each with `read`, or with the operator that assigns to it."""
    script, _ = parse(Decoded(text, 0))
    found: list[tuple[str, str]] = []
    targets: set[int] = set()
    for expr in walk(script):
        if isinstance(expr, Assignment):
            targets.add(id(expr.target))
            found.append((expr.target.name, expr.operator))
        elif isinstance(expr, Name) and id(expr) not in targets:
            found.append((expr.name, "read"))
    return tuple(found)
