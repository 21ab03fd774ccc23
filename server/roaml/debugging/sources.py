# SPDX-License-Identifier: Apache-2.0
"""Places in the sources of a run: machines, states, nodes of the tree and properties."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from roaml.debugging.tree_nodes import SourceNode, nodes_of_system, nodes_of_tree
from roaml.expr.types import BASE_TYPES, Type, leaves
from roaml.jani.model import Automaton
from roaml.jani.node import Origin
from roaml.model.ros import InterfaceType
from roaml.model.value_types import INTERFACE_KINDS
from roaml.project.analysis import Analysis
from roaml.project.translation import properties_of
from roaml.record import Record
from roaml.scxml.names import (
    FIELD_PREFIX,
    NODE_AUTOMATON,
    InterfaceEvent,
    InterfaceEventKind,
    is_blackboard,
    read_interface_event,
    sanitise,
)
from roaml.text import Location
from roaml.verification.target import LineColumn, VerificationTarget

if TYPE_CHECKING:
    from roaml.lower.programs.executed import ExecutedTree


class Sources(Record, frozen=True, dict=True):
    """The sources of a model.

    Attributes:
        analysis: the models of the system; `None` for a JANI file and for a tree without a system.
        tree: the tree without a system that is executed; `None` for other models.
    """

    target: VerificationTarget
    analysis: Analysis | None = None
    tree: ExecutedTree | None = None

    def place(self, origin: Origin | None) -> LineColumn | None:
        return self.target.place(origin)

    @cached_property
    def comments(self) -> Mapping[str, str]:
        """What properties require, in sentences, by the names of the properties. The translation to JANI keeps only the
        comments of observed properties."""
        written = {property_.name: property_.comment for property_ in self.target.properties}
        if self.analysis is not None:
            written |= {p.name: p.comment for p in properties_of(self.analysis, self.target.path)}
        return {name: " ".join(comment.split()) for name, comment in written.items() if comment}

    @cached_property
    def nodes(self) -> Mapping[int, SourceNode]:
        """The nodes of the tree, by their numbers."""
        if self.tree is not None:
            nodes = nodes_of_tree(self.tree)
        elif self.analysis is not None:
            nodes = nodes_of_system(self.analysis, self.target.path)
        else:
            return {}
        return {node.number: node for node in nodes}

    def is_library_node(self, automaton: Automaton) -> bool:
        """Whether an automaton executes a node of the tree whose behaviour is that of a library or of a mock, so that
        its states and statements are in no file."""
        node = NODE_AUTOMATON.fullmatch(automaton.name)
        if node is None or int(node[1]) not in self.nodes:
            return False
        path = "" if automaton.origin is None else automaton.origin.path
        return self.analysis is None or self.analysis.machine(path) is None

    @cached_property
    def property_origins(self) -> Mapping[str, Origin]:
        return {
            property_.name: property_.origin
            for property_ in self.target.model.properties
            if property_.origin is not None
        }

    def states(self, automaton: Automaton) -> Mapping[str, Origin]:
        """The element of each state of a machine, by the name of the state; empty if the machine has no file."""
        path = "" if automaton.origin is None else automaton.origin.path
        machine = None if self.analysis is None else self.analysis.machine(path)
        if machine is None:
            return {}
        return {
            state.id.value: Location(path, state.element.span)
            for chart in tuple(machine.charts)[::-1]
            for state in chart.states
            if state.id is not None
        }

    def variable_types(self, automaton: Automaton) -> Mapping[str, Type]:
        """The types of the variables of a machine, or of the entries of a blackboard; empty if the machine has no
        file."""
        if is_blackboard(automaton.name):
            system = None if self.analysis is None else self.analysis.system(self.target.path)
            return {} if system is None else {name: BASE_TYPES[type_] for name, type_ in system.variables.items()}
        path = "" if automaton.origin is None else automaton.origin.path
        if self.analysis is None or self.analysis.machine(path) is None:
            return {}
        typed = self.analysis.typed_in(path, self.target.path)
        return {name: type_ for scope in tuple(typed.variables.values())[::-1] for name, type_ in scope.items()}

    @cached_property
    def event_parameters(self) -> Mapping[str, Mapping[str, Type]]:
        """The parameters of each event, with their types."""
        return {} if self.analysis is None else self.analysis.event_parameters(self.target.path)

    @cached_property
    def declared_parameters(self) -> Mapping[str, Mapping[str, Type]]:
        """The parameters of each event, with their types. Types are those of the ROS definitions, if these declare
        them."""
        system = None if self.analysis is None else self.analysis.system(self.target.path)
        if self.analysis is None or system is None:
            return {}
        parts = (
            (InterfaceEventKind.MESSAGE, "message", system.topics),
            (InterfaceEventKind.REQUEST, "request", system.services),
            (InterfaceEventKind.GOAL, "goal", system.actions),
        )
        of_events = {
            InterfaceEvent(kind, sanitise(channel.name)): (part, channel.endpoints[0].use)
            for kind, part, channels in parts
            for channel in channels.values()
            if channel.endpoints
        }
        clients = {automaton.name for automaton in system.automata}
        declared: dict[str, Mapping[str, Type]] = dict(self.event_parameters)
        for event, types in self.event_parameters.items():
            read = read_interface_event(event, clients)
            if read not in of_events:
                continue
            part, use = of_events[read]
            interface = self.analysis.interface(INTERFACE_KINDS[use.kind], use.type)
            if isinstance(interface, InterfaceType):
                fields = {FIELD_PREFIX + "__".join(path): type_ for path, type_ in leaves(interface.part(part))}
                declared[event] = {name: fields.get(name, type_) for name, type_ in types.items()}
        return declared

    def tag(self, origin: Origin | None) -> str:
        """The element at a place, such as `<assign>`; "" if there is none."""
        source = None if origin is None else self.target.source_of(origin.path)
        if origin is None or source is None:
            return ""
        text = source.text[origin.span.start : origin.span.start + MAX_TAG]
        name = text[1:].split(None, 1)[0].split(">")[0].rstrip("/") if text.startswith("<") and len(text) > 1 else ""
        return f"<{name}>" if name else ""


MAX_TAG = 80
"""The maximum number of characters of an element's start that are read for its name."""
