# SPDX-License-Identifier: Apache-2.0
"""The input of the lowering: a linked system with its machines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from roaml.model.machine import Machine
from roaml.model.parameters import Parameters
from roaml.model.system import System, SystemAutomaton
from roaml.model.value_types import Environment
from roaml.text import Location, Span

if TYPE_CHECKING:
    from roaml.lower.library_tree import LibraryTree


@dataclass(frozen=True, slots=True, eq=False)
class TranslatableSystem:
    """A system without errors.

    Attributes:
        machines: the machines that the system lists, by path.
        environment: structs, ROS types and the data of plain events.
        place: the root of the system file, as the origin of parts that come from the system as a whole.
        nodes: number of a tree node -> its place.
        parameters: the parameters of the translation, which may differ from those in the system file.
        library: the translation of a tree that is executed as by the library; `None` for other trees.
    """

    system: System
    machines: Mapping[str, Machine]
    environment: Environment
    place: Location
    nodes: Mapping[int, Location]
    parameters: Parameters
    library: LibraryTree | None = None

    def place_of(self, automaton: SystemAutomaton) -> Location:
        """The place of an automaton as a whole: its file, or the tree node if it has no file."""
        machine = self.machines.get(automaton.path)
        if machine is not None:
            return Location(automaton.path, machine.element.name_span)
        return self.node(automaton.instance.number if automaton.instance else 0)

    def address(self, number: int) -> str:
        """The address of a tree node in events; usually its number."""
        return str(number) if self.library is None else self.library.address(number)

    def node(self, number: int) -> Location:
        return self.nodes.get(number, self.place)


NOWHERE = Span(0, 0)
"""The span of expressions that the lowering creates; the origin of the statement around them is their place."""
