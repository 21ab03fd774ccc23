# SPDX-License-Identifier: Apache-2.0
"""What the nodes of libraries in the tree of a system do with their children, and the statuses of all nodes."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping

from roaml.libraries import library_node
from roaml.libraries.programs.assembly import NodeProgram, programs
from roaml.libraries.programs.effects import (
    ALL_EFFECTS,
    ANY_ANSWER,
    Answers,
    ChildEffects,
    Effects,
    Situation,
    constant,
    effects,
    effects_on,
)
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SKIPPED, SUCCESS
from roaml.model.expand import PortConstant
from roaml.model.system import System, SystemAutomaton
from roaml.record import replace

_MACHINE = frozenset((SUCCESS, FAILURE, RUNNING))
_NO_SUCCESS = frozenset((FAILURE, RUNNING))


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

    def waits(self, node: SystemAutomaton) -> bool:
        """Whether a node of a library never returns SUCCESS at its first tick, whatever its children return."""
        program = _program(node)
        if program is None:
            return False
        situation = self._situation(node)
        anything = (ANY_ANSWER,) * len(situation.answers)
        return SUCCESS not in effects(program, replace(situation, answers=anything, first=anything)).first

    def time_to_success(self, system: System, node: SystemAutomaton, waits: Mapping[int, int]) -> int:
        """The least time that passes until a node returns SUCCESS.

        Args:
            waits: number of a node -> the time for which it waits itself.
        """
        assert node.instance is not None
        program, numbers = _program(node), node.instance.children
        if program is None or SUCCESS not in self._without(node, program, ()).answers:
            return 0
        inside = [self._time_of_child(system, number, waits) for number in numbers]
        own = waits.get(node.instance.number, 0)
        children = range(len(numbers))
        needed = [index for index in children if SUCCESS not in self._without(node, program, {index}).answers]
        if needed:
            in_turn = all(
                later not in self._without(node, program, {earlier}).ticked
                for earlier, later in itertools.pairwise(needed)
            )
            return own + (sum if in_turn else max)(inside[index] for index in needed)
        is_one_needed = SUCCESS not in self._without(node, program, children).answers
        return own + (min(inside, default=0) if is_one_needed else 0)

    def _time_of_child(self, system: System, number: int, waits: Mapping[int, int]) -> int:
        child = system.by_instance.get(number)
        is_certain = child is not None and SKIPPED not in self._answers[number]
        return self.time_to_success(system, child, waits) if child is not None and is_certain else 0

    def _without(self, node: SystemAutomaton, program: NodeProgram, failing: Collection[int]) -> Effects:
        """The effects of a node some of whose children never return SUCCESS."""
        situation = self._situation(node)
        given = (
            _NO_SUCCESS if index in failing else answers | {SUCCESS} for index, answers in enumerate(situation.answers)
        )
        answers = tuple(given)
        return effects(program, replace(situation, answers=answers, first=answers))

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
