# SPDX-License-Identifier: Apache-2.0
"""The scripts in trees: their attributes (docs/spec/trees.md#scripts), and whether their values are conditions."""

from __future__ import annotations

import functools
from collections.abc import Iterator

from roaml.forest.forest import CPP, Forest
from roaml.forest.ports import probable_ports
from roaml.libraries.scripts import CONDITIONS, is_condition, script_ports
from roaml.libraries.version import SCRIPTS_CHANGED_SINCE, Version
from roaml.model.tree import TreeNode
from roaml.record import Record
from roaml.script.parse import ScriptGrammar, ScriptProblem, parse
from roaml.script.tree import Script
from roaml.text import Decoded
from roaml.xml_syntax import Attribute


class ScriptUse(Record, frozen=True):
    """A script in an attribute of a node. `is_condition` is true if its value must be true or false."""

    node: TreeNode
    attribute: Attribute
    is_condition: bool


def scripts_of(forest: Forest, node: TreeNode) -> Iterator[ScriptUse]:
    for attribute in node.scripts:
        if attribute.has_value:
            yield ScriptUse(node, attribute, attribute.name in CONDITIONS)
    name = node.plugin.value if node.plugin else ""
    if name in script_ports() and forest.known_node(node) is CPP.nodes[name]:
        for port in script_ports()[name]:
            attribute_of_port = node.element.get(port) or _probable(node, port)
            if attribute_of_port is not None and attribute_of_port.has_value:
                yield ScriptUse(node, attribute_of_port, is_condition(name, port))


def _probable(node: TreeNode, port: str) -> Attribute | None:
    """The misspelled attribute that is probably intended to set `port`; `None` if there is none."""
    assert node.plugin is not None
    probable = probable_ports(node, CPP.nodes[node.plugin.value])
    return next((node.element.get(name) for name, ports in probable.items() if port in ports), None)


def script_attributes(node: TreeNode) -> Iterator[Attribute]:
    """The attributes of a node that contain scripts, independently of the declaration of the node."""
    yield from (attribute for attribute in node.scripts if attribute.has_value)
    for port in script_ports().get(node.plugin.value if node.plugin else "", ()):
        attribute = node.element.get(port)
        if attribute is not None and attribute.has_value:
            yield attribute


def grammar_of(version: Version) -> ScriptGrammar:
    """The grammar of scripts in a version of BehaviorTree.CPP."""
    return ScriptGrammar.CURRENT if version >= SCRIPTS_CHANGED_SINCE else ScriptGrammar.BEFORE_4_9


@functools.lru_cache(maxsize=2048)
def parsed(source: Decoded, grammar: ScriptGrammar = ScriptGrammar.CURRENT) -> tuple[Script, tuple[ScriptProblem, ...]]:
    """The script in a text, and its syntax errors. The result is cached, because many rules need it."""
    return parse(source, grammar)
