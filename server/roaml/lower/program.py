# SPDX-License-Identifier: Apache-2.0
"""The input of the lowering: a linked system with its machines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from roaml.model.machine import Machine
from roaml.model.parameters import Parameters
from roaml.model.system import System, SystemAutomaton
from roaml.model.value_types import Environment
from roaml.record import Record
from roaml.text import Location

if TYPE_CHECKING:
    from roaml.lower.library_tree import LibraryTree


class TranslatableSystem(Record, frozen=True, eq=False):
    """A system without errors, with everything that its translation needs.

    Attributes:
        machines: path -> machine that the system lists.
        environment: structs, ROS types and the data of plain events.
        place: the root element of the system file: the origin of parts that belong to the system as a whole.
        nodes: number of a tree node -> its place.
        parameters: the parameters of the translation, which may differ from those in the system file.
        library: the translation of a tree that is executed as BehaviorTree.CPP executes it; `None` for other trees.
    """

    system: System
    machines: Mapping[str, Machine]
    environment: Environment
    place: Location
    nodes: Mapping[int, Location]
    parameters: Parameters
    library: LibraryTree | None = None

    def place_of(self, automaton: SystemAutomaton) -> Location:
        """The place of an automaton as a whole: the root of its file; if it has no file, the node in the tree."""
        machine = self.machines.get(automaton.path)
        if machine is not None:
            return Location(automaton.path, machine.element.name_span)
        return self.node(automaton.instance.number if automaton.instance else 0)

    def address(self, number: int) -> str:
        """The part of event names that identifies a tree node: its number, followed by a suffix such as `_inner` if an
        automaton for its conditions has the number (docs/spec/nodes.md#library)."""
        return str(number) if self.library is None else self.library.address(number)

    def node(self, number: int) -> Location:
        return self.nodes.get(number, self.place)
