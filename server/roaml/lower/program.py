# SPDX-License-Identifier: Apache-2.0
"""What lowering starts from: a linked system with the machines behind it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from roaml.model.machine import Machine
from roaml.model.system import System, SystemAutomaton
from roaml.model.system_file import Parameters
from roaml.model.value_types import Environment
from roaml.text import Location, Span


@dataclass(frozen=True, slots=True, eq=False)
class TranslatableSystem:
    """A system without errors.

    Attributes:
        machines: by path, those that the system lists.
        environment: structs, ROS types and the data of plain events.
        place: of the system file's root, for what exists because of the system as a whole.
        nodes: number of a tree node -> where it stands.
        parameters: how to translate; they may differ from what the system file says.
    """

    system: System
    machines: Mapping[str, Machine]
    environment: Environment
    place: Location
    nodes: Mapping[int, Location]
    parameters: Parameters

    def place_of(self, automaton: SystemAutomaton) -> Location:
        """Where an automaton as a whole comes from: its file, or the tree node if that has no file."""
        machine = self.machines.get(automaton.path)
        if machine is not None:
            return Location(automaton.path, machine.element.name_span)
        return self.node(automaton.instance.number if automaton.instance else 0)

    def node(self, number: int) -> Location:
        return self.nodes.get(number, self.place)


NOWHERE = Span(0, 0)
"""The span of expressions that are made here; the origin of the statement around them tells the place."""
