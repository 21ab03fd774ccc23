# SPDX-License-Identifier: Apache-2.0
"""What the nodes of libraries in the tree of a system do with their children, and the statuses of all nodes."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping

from roaml.libraries import library_node
from roaml.libraries.programs.effects import ALL_EFFECTS, ChildEffects, Effects, effects_on
from roaml.libraries.programs.linked import ANY, OF_MACHINE, LinkedNode, Possible, linked
from roaml.libraries.programs.statuses import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from roaml.model.expand import Instance, PortConstant, entered_uses
from roaml.model.system import System, SystemAutomaton
from roaml.scxml.names import STATUSES

_NO_SUCCESS = frozenset((FAILURE, RUNNING))


class TreeEffects:
    """The effects of the nodes of a tree. Nodes with a wrong number of children may do anything."""

    def __init__(self, system: System) -> None:
        self._linked: dict[int, LinkedNode] = {}
        self._possible: dict[int, Possible] = {}
        for instance in reversed(system.instances):  # children before their parents
            automaton = system.by_instance.get(instance.number)
            if automaton is not None:
                self._linked[instance.number] = _bound(automaton, instance)
            self._possible[instance.number] = self._of(system, instance)

    def on_child(self, parent: SystemAutomaton, child: SystemAutomaton) -> ChildEffects:
        """What a node of a library may do with its child."""
        assert child.instance is not None
        instance, bound = self._of_automaton(parent)
        if bound.program is None:
            return ALL_EFFECTS
        index = instance.children.index(child.instance.number)
        return effects_on(bound.program, bound.situation(self._below(instance)), index)

    def waits(self, node: SystemAutomaton) -> bool:
        """Whether a node of a library never returns SUCCESS at its first tick, whatever its children return."""
        instance, bound = self._of_automaton(node)
        return bound.program is not None and SUCCESS not in bound.effects([ANY] * len(instance.children)).first

    def statuses(self, instance: Instance) -> frozenset[int]:
        """The numbers of the statuses that a node can return at any tick."""
        return self._possible[instance.number].ever - {IDLE}

    def needs(self, node: SystemAutomaton, child: int) -> bool:
        """Whether a node returns SUCCESS only if the child with a number does, or never."""
        instance, bound = self._of_automaton(node)
        index = instance.children.index(child)
        return bound.program is not None and SUCCESS not in self._without(node, {index}).answers

    def time_to_success(self, system: System, node: SystemAutomaton, waits: Mapping[int, int]) -> int:
        """The least time that passes until a node returns SUCCESS.

        Args:
            waits: number of a node -> the time for which it waits itself.
        """
        instance, bound = self._of_automaton(node)
        numbers = instance.children
        if bound.program is None:
            return waits.get(instance.number, 0)
        if SUCCESS not in self._without(node, ()).answers:
            return 0
        inside = [self._time_of_child(system, number, waits) for number in numbers]
        own = waits.get(instance.number, 0)
        children = range(len(numbers))
        needed = [index for index in children if SUCCESS not in self._without(node, {index}).answers]
        if needed:
            in_turn = all(
                later not in self._without(node, {earlier}).ticked for earlier, later in itertools.pairwise(needed)
            )
            return own + (sum if in_turn else max)(inside[index] for index in needed)
        is_one_needed = SUCCESS not in self._without(node, children).answers
        return own + (min(inside, default=0) if is_one_needed else 0)

    def _time_of_child(self, system: System, number: int, waits: Mapping[int, int]) -> int:
        child = system.by_instance.get(number)
        is_certain = child is not None and SKIPPED not in self._possible[number].ever
        return self.time_to_success(system, child, waits) if child is not None and is_certain else 0

    def _without(self, node: SystemAutomaton, failing: Collection[int]) -> Effects:
        """The effects of a node some of whose children never return SUCCESS."""
        instance, bound = self._of_automaton(node)
        answers = (
            _NO_SUCCESS if index in failing else below.ever | {SUCCESS}
            for index, below in enumerate(self._below(instance))
        )
        return bound.effects([Possible(given, given) for given in answers])

    def _of(self, system: System, instance: Instance) -> Possible:
        has_conditions = any(system.tree_uses[use].scripts for use in entered_uses(system.tree_uses, instance.use))
        bound = self._linked.get(instance.number)
        return ANY if has_conditions or bound is None else bound.possible(self._below(instance))

    def _of_automaton(self, automaton: SystemAutomaton) -> tuple[Instance, LinkedNode]:
        assert automaton.instance is not None
        return automaton.instance, self._linked[automaton.instance.number]

    def _below(self, instance: Instance) -> list[Possible]:
        return [self._possible[number] for number in instance.children]


def _bound(automaton: SystemAutomaton, instance: Instance) -> LinkedNode:
    """The node of an automaton, bound to a program of a library or to its machine."""
    known = None if automaton.path else library_node(automaton.outline.name)
    settings = {key: value.text if isinstance(value, PortConstant) else None for key, value in instance.ports}
    scripts = (name for name, _ in instance.scripts)
    return linked(known, settings, scripts, len(instance.children), OF_MACHINE if automaton.path else ANY)


def tree_effects(system: System) -> TreeEffects:
    """The effects of the nodes of a system on their children, cached with the system."""
    known: dict[str, TreeEffects] = system.__dict__.setdefault("_tree_effects", {})
    if "effects" not in known:
        known["effects"] = TreeEffects(system)
    return known["effects"]


def succeeds_only_with(system: System, instance: Instance, child: int) -> bool:
    """Whether a node of a library returns SUCCESS only if its child with a number does, or never."""
    automaton = system.by_instance.get(instance.number)
    return automaton is not None and not automaton.path and tree_effects(system).needs(automaton, child)


def statuses(system: System, instance: Instance) -> frozenset[int]:
    """The numbers of the statuses that a node of the trees of a system can return (docs/spec/plugins.md#status)."""
    automaton = system.by_instance.get(instance.number)
    if automaton is not None and automaton.path:
        return frozenset(STATUSES[name] for name in automaton.outline.plugin.statuses.ever)
    return tree_effects(system).statuses(instance) if system.is_library_tree else frozenset(STATUSES.values())
