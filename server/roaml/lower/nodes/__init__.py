# SPDX-License-Identifier: Apache-2.0
"""The nodes of BehaviorTree.CPP as HL-SCXML machines (docs/spec/nodes.md).

Each node is a document in the directory of this module, except `Switch2` to `Switch6`, which are generated on demand.
The machines have some ports that are not in the schema; this module sets them.
"""

from __future__ import annotations

import functools
import importlib.resources
from fractions import Fraction

from roaml.language import BEHAVIOR_TREE
from roaml.libraries import BEHAVIORTREE_CPP, library
from roaml.lower.nodes.switch import switch
from roaml.lower.program import TranslatableSystem
from roaml.model.build_machine import build_machine
from roaml.model.machine import Machine
from roaml.model.system import CHILDREN_COUNT, SystemAutomaton
from roaml.xml_syntax import parse

_SWITCHES = {f"Switch{cases}": cases for cases in range(2, 7)}
_MILLISECONDS_PER_SECOND = 1000


def builtin_machine(automaton: SystemAutomaton, program: TranslatableSystem) -> Machine:
    """The machine for a node of BehaviorTree.CPP."""
    name = automaton.outline.name
    if name in _SWITCHES:
        return _parsed(switch(name, _SWITCHES[name], program.system.any_type(automaton)))
    slots = _children(automaton) + 1
    none_ended = f"[{', '.join(['false'] * slots)}]"
    text = _resource(_current(name))
    return _parsed(text.replace("SLOTS", str(slots)).replace("NONE_ENDED", none_ended))


def builtin_ports(automaton: SystemAutomaton, program: TranslatableSystem) -> dict[str, str]:
    """The values of the ports of a node that the tree does not set: the defaults of the schema, the number of children,
    and the rate of the tree."""
    rate = Fraction(str(program.parameters.tick_rate))
    ports = {
        CHILDREN_COUNT: str(_children(automaton)),
        "TICKS": str(rate.numerator),
        "TICKS_MSEC": str(rate.denominator * _MILLISECONDS_PER_SECOND),
    }
    for attribute in BEHAVIOR_TREE.elements[automaton.outline.name].ports:
        if attribute.port and attribute.port.default:
            ports[attribute.name] = attribute.port.default
    return ports


def node_file(name: str) -> str | None:
    """The path of the document for a node of BehaviorTree.CPP; `None` if there is none, or if it is generated."""
    file = importlib.resources.files(__name__) / f"{_current(name)}.ascxml"
    return str(file) if name in BEHAVIOR_TREE.elements and file.is_file() else None


def _current(name: str) -> str:
    """The name of a node in version 4 of BehaviorTree.CPP."""
    renamed = library(BEHAVIORTREE_CPP).renamed.get(name)
    return renamed.now if renamed else name


def _children(automaton: SystemAutomaton) -> int:
    return len(automaton.instance.children) if automaton.instance else 0


@functools.cache
def _resource(name: str) -> str:
    return (importlib.resources.files(__name__) / f"{name}.ascxml").read_text(encoding="utf-8")


@functools.lru_cache(maxsize=256)
def _parsed(text: str) -> Machine:
    machine = build_machine(parse(text))
    assert machine is not None
    return machine
