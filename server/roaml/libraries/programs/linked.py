# SPDX-License-Identifier: Apache-2.0
"""Nodes that are bound to their definitions, and the statuses that they can return (docs/spec/lone-trees.md#statuses).

A node is bound to a program of a library, or it is a machine, a leaf without a program, or unknown. Trees of files
(`roaml.forest.statuses`) and the executed trees of systems (`roaml.model.node_effects`) bind their nodes in this way.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from roaml.libraries.node import Node, Port
from roaml.libraries.programs.assembly import NodeProgram, programs
from roaml.libraries.programs.effects import ANY_ANSWER, Answers, Effects, Situation, constant, effects
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS, Known
from roaml.libraries.version import NEWEST_VERSION, Version
from roaml.record import Record


class Possible(Record, frozen=True):
    """The statuses that a node can return: at any tick, and at its first tick."""

    ever: Answers
    first: Answers


ANY = Possible(ANY_ANSWER, ANY_ANSWER)
"""The statuses of a node about which nothing is known."""

OF_MACHINE = Possible(frozenset((SUCCESS, FAILURE, RUNNING)), frozenset((SUCCESS, FAILURE, RUNNING)))
"""The statuses with which a user's machine answers a tick."""


class LinkedNode(Record, frozen=True):
    """A node of a tree, bound to its definition.

    Attributes:
        program: what the node does; `None` for machines, for other leaves without a program, and for unknown nodes.
        conditions: the program that evaluates the conditions and scripts of a node without a program.
        leaf: the statuses of a node without a program, if it has no conditions.
        ports: ports with useful constant values, including defaults, sorted by name.
        scripts: the names of its conditions and scripts.
    """

    program: NodeProgram | None
    conditions: NodeProgram
    leaf: Possible
    ports: tuple[tuple[str, Known], ...]
    scripts: frozenset[str]

    def situation(self, below: Sequence[Possible]) -> Situation:
        """What is known about the node, if its children can return the statuses `below`."""
        ever, first = tuple(child.ever for child in below), tuple(child.first for child in below)
        return Situation(ever, first, self.ports, self.scripts)

    def effects(self, below: Sequence[Possible]) -> Effects:
        """What the node may do, if its children can return the statuses `below`."""
        if self.program is not None:
            return effects(self.program, self.situation(below))
        return effects(self.conditions, self.situation([self.leaf]))

    def possible(self, below: Sequence[Possible]) -> Possible:
        """The statuses that the node can return, if its children can return the statuses `below`."""
        result = self.effects(below)
        return Possible(result.answers, result.first)


def linked(
    known: Node | None,
    settings: Mapping[str, str | None],
    scripts: Iterable[str],
    children: int,
    leaf: Possible = ANY,
    version: Version = NEWEST_VERSION,
) -> LinkedNode:
    """Bind a node to its definition.

    Args:
        known: the declaration of the type of the node; `None` if there is none.
        settings: port that the tree sets -> its text; `None` if it is bound to a blackboard entry.
        scripts: the names of the conditions and scripts of the node.
        children: the number of its children. With a wrong number of children, a node may do anything.
        leaf: the statuses of the node if it has no program.
        version: the version of BehaviorTree.CPP.
    """
    available = programs(version)
    least, most = known.children if known is not None else (0, 0)
    program = available.get(known.name) if known is not None and known.behaviour and least <= children <= most else None
    ports = {port.name: _value(port, settings, children) for port in known.ports} if known is not None else {}
    values = tuple(sorted((name, value) for name, value in ports.items() if value is not None))
    return LinkedNode(program, available["condition_machine"], leaf, values, frozenset(scripts))


def _value(port: Port, settings: Mapping[str, str | None], children: int) -> Known | None:
    """The constant value of a port; `None` if there is none, or if it is a number of no use, which a rule reports."""
    text = settings.get(port.name, port.default)
    value = None if text is None else constant(text)
    if not isinstance(value, (int, float)) or port.limits is None:
        return value
    if port.limits.counts_children:
        return value if value <= children else None
    least = port.limits.minimum
    return value if least is None or value >= least or value in port.limits.special else None
