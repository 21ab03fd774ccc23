# SPDX-License-Identifier: Apache-2.0
"""The nodes of BehaviorTree.CPP that AS2FM executes in another way, as HL-SCXML machines, for systems with the
semantics of AS2FM (docs/spec/nodes.md#as2fm).

Each node is a document in the directory of this module. The machines have a port that is not in the schema, the number
of children; this module sets it.
"""

from __future__ import annotations

import functools

from roaml.disk import resource
from roaml.language import BEHAVIOR_TREE
from roaml.libraries import library_node
from roaml.model.build_machine import build_machine
from roaml.model.machine import Machine
from roaml.model.system import CHILDREN_COUNT, SystemAutomaton
from roaml.xml_syntax import parse


def builtin_machine(automaton: SystemAutomaton) -> Machine:
    """The machine for a node of BehaviorTree.CPP."""
    slots = _children(automaton) + 1
    none_ended = f"[{', '.join(['false'] * slots)}]"
    node = library_node(automaton.outline.name)
    assert node is not None
    text = _resource(node.name)
    return _parsed(text.replace("SLOTS", str(slots)).replace("NONE_ENDED", none_ended))


def builtin_ports(automaton: SystemAutomaton) -> dict[str, str]:
    """The values of the ports of a node that the tree does not set: the defaults of the schema, and the number of
    children."""
    ports = {CHILDREN_COUNT: str(_children(automaton))}
    for attribute in BEHAVIOR_TREE.elements[automaton.outline.name].ports:
        if attribute.port and attribute.port.default:
            ports[attribute.name] = attribute.port.default
    return ports


def _children(automaton: SystemAutomaton) -> int:
    return len(automaton.instance.children) if automaton.instance else 0


@functools.cache
def _resource(name: str) -> str:
    return resource(__name__, f"{name}.ascxml")


@functools.lru_cache(maxsize=256)
def _parsed(text: str) -> Machine:
    machine = build_machine(parse(text))
    assert machine is not None
    return machine
