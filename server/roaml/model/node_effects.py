# SPDX-License-Identifier: Apache-2.0
"""What the nodes of libraries in the tree of a system do with their children, and the statuses of all nodes."""

from __future__ import annotations

from roaml.libraries import library_node
from roaml.libraries.programs.assembly import NodeProgram, programs
from roaml.libraries.programs.effects import (
    ALL_EFFECTS,
    ANY_ANSWER,
    Answers,
    ChildEffects,
    Situation,
    constant,
    effects,
    effects_on,
)
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.model.expand import PortConstant
from roaml.model.system import System, SystemAutomaton

_MACHINE = frozenset((SUCCESS, FAILURE, RUNNING))


class TreeEffects:
    """The effects of the nodes of a tree. Nodes with a wrong number of children may do anything."""

    def __init__(self, system: System) -> None:
        self._answers: dict[int, Answers] = {}
        for instance in reversed(system.instances):  # children before their parents
            automaton = system.by_instance.get(instance.number)
            self._answers[instance.number] = ANY_ANSWER if automaton is None else self._of(system, automaton)

    def on_child(self, parent: SystemAutomaton, child: SystemAutomaton) -> ChildEffects:
        """What a node of a library may do with its child."""
        assert parent.instance is not None
        assert child.instance is not None
        program = _program(parent)
        if program is None:
            return ALL_EFFECTS
        return effects_on(program, self._situation(parent), parent.instance.children.index(child.instance.number))

    def _of(self, system: System, automaton: SystemAutomaton) -> Answers:
        assert automaton.instance is not None
        program = _program(automaton)
        answers = _MACHINE if automaton.path else ANY_ANSWER
        if program is not None:
            answers = effects(program, self._situation(automaton)).answers
        elif automaton.instance.scripts:
            scripts = frozenset(name for name, _ in automaton.instance.scripts)
            answers = effects(programs()["condition_machine"], Situation((answers,), (answers,), (), scripts)).answers
        uses = _with_outer(system, automaton.instance.use)
        has_conditions = any(system.tree_uses[use].scripts for use in uses)
        return ANY_ANSWER if has_conditions else answers

    def _situation(self, parent: SystemAutomaton) -> Situation:
        assert parent.instance is not None
        node = library_node(parent.outline.name)
        assert node is not None
        ports = {port.name: constant(port.default) for port in node.ports if port.default is not None}
        for key, value in parent.instance.ports:
            if isinstance(value, PortConstant):
                ports[key] = constant(value.text)
            else:
                ports.pop(key, None)
        below = tuple(self._answers[number] for number in parent.instance.children)
        scripts = frozenset(name for name, _ in parent.instance.scripts)
        return Situation(below, below, tuple(sorted(ports.items())), scripts)


def _program(automaton: SystemAutomaton) -> NodeProgram | None:
    """The program of a node of a library with a valid number of children; `None` for other nodes."""
    node = None if automaton.path else library_node(automaton.outline.name)
    if node is None or automaton.instance is None:
        return None
    least, most = node.children
    return programs().get(node.name) if least <= len(automaton.instance.children) <= most else None


def _with_outer(system: System, use: int | None) -> list[int]:
    """The index of the use of a tree, and those of all enclosing uses."""
    result = []
    while use is not None:
        result.append(use)
        use = system.tree_uses[use].outer
    return result


def tree_effects(system: System) -> TreeEffects:
    """The effects of the nodes of a system on their children, cached with the system."""
    known: dict[str, TreeEffects] = system.__dict__.setdefault("_tree_effects", {})
    if "effects" not in known:
        known["effects"] = TreeEffects(system)
    return known["effects"]
