# SPDX-License-Identifier: Apache-2.0
"""Systems, linked from the outlines of their files, and what depends on a linked system."""

from __future__ import annotations

import functools
from collections.abc import Callable, Hashable, Mapping
from typing import TYPE_CHECKING, Protocol

from roaml.expr.types import Struct, Type
from roaml.forest.forest import Forest
from roaml.forest.settings import NEWEST
from roaml.jani.properties import identifiers
from roaml.lower.program import TranslatableSystem
from roaml.lower.size import size_of
from roaml.model.expand import ListedTree, expand_listed
from roaml.model.gaps import Gap
from roaml.model.globals import GlobalVariable, event_parameters, global_variables
from roaml.model.kinds import FileKind
from roaml.model.machine import Machine
from roaml.model.outline import MachineOutline
from roaml.model.property_links import LinkedFile, link
from roaml.model.property_ports import observed_names
from roaml.model.size import Size
from roaml.model.system import System, SystemTree
from roaml.model.system_file import ListedFile, SystemFile, SystemSection
from roaml.model.tree import TreeFile
from roaml.model.value_types import Environment, TypedMachine
from roaml.project.analysis.families import Families
from roaml.project.analysis.gaps import Gaps
from roaml.project.analysis.machines import NO_STRUCTS, MachineEnvironment, Machines, Structs
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.systems import Systems
from roaml.project.ros_types import Interfaces
from roaml.record import replace
from roaml.scxml.event_data import Round, infer_in_rounds
from roaml.text import Location

if TYPE_CHECKING:
    from roaml.lower.library_tree import LibraryTree
    from roaml.lower.programs.code import Child

MAX_SHAPES = 2000
"""The maximum number of explored nodes that are remembered."""


class ExpandedSystem(Protocol):
    """An expanded system (docs/spec/parameters.md#expansion)."""

    def linked(self, path: str) -> System | None:
        """The linked system of the expanded texts."""

    def system(self, path: str) -> System | None:
        """The linked system, in which each automaton has the path of its file."""

    def library_tree(self, path: str) -> LibraryTree | None:
        """The translated tree."""


class Linking:
    """Links systems. A linked system is cached by the outlines of its files.

    Args:
        expanded: returns the expanded system; `None` if a system uses neither parameters nor instances.
    """

    def __init__(
        self,
        sources: SourceFiles,
        interfaces: Interfaces,
        systems: Systems,
        expanded: Callable[[str], ExpandedSystem | None],
        machines: Machines,
        gaps: Gaps,
        families: Families,
    ) -> None:
        self._sources = sources
        self._interfaces = interfaces
        self._systems = systems
        self._expanded = expanded
        self._machines = machines
        self._gaps = gaps
        self._families = families
        self._linked: dict[str, System | None] = {}
        self._typed: dict[tuple[str, str | None], tuple[Machine | None, TypedMachine]] = {}

    def system(self, path: str) -> System | None:
        """The linked system of a system file; `None` if the file cannot be read, or is not a system file."""
        if path not in self._linked:
            self._linked[path] = self._link(path)
        return self._linked[path]

    def _link(self, path: str) -> System | None:
        file = self._sources.system_file(path)
        if file is None:
            return None
        if (expanded := self._expanded(path)) is not None:
            linked = expanded.linked(path)
            return self._sources.memo.get("expanded system", path, linked, lambda: expanded.system(path))
        listed = self._systems.listed(path)
        structs = self._machines.structs(path)
        trees = self._systems.executed_trees(path)
        rates = tuple(tree.input.tick_rate for tree in self._systems.listed_trees(path))
        machines = [f for f in listed if f.required_kind is FileKind.MACHINE and f.usable]
        gaps = frozenset(placed.gap for _, placed in self._gaps.gaps(path))
        plugins_known = self._knows_plugins(path, listed)
        observed = self._observed(listed)

        def link_with(events: Mapping[str, Struct]) -> Round[System, Struct]:
            outlines = [(f, self._machines.outline(f.path, path, structs, events)) for f in machines]
            nodes = tuple((f.path, o) for f, o in outlines if f.input.section is SystemSection.NODE_MODELS)
            plugins = tuple((f.path, o) for f, o in outlines if f.input.section is SystemSection.BEHAVIOR_TREE)
            known = (gaps, plugins_known, observed)
            owners = tuple(f.input.tree for f in machines if f.input.section is SystemSection.BEHAVIOR_TREE)
            key = (file.parameters, file.older, nodes, plugins, trees, rates, owners, structs.outlines, known)
            make = functools.partial(self._make, path, file, nodes, plugins, owners, trees, rates, structs, known)
            system = self._sources.memo.get("system", path, key, make)
            received = (received for _, o in outlines for received in o.received)
            return Round(system, system.event_data, frozenset(r.event for r in received if r.forwarded))

        return infer_in_rounds(link_with)

    def _make(
        self,
        path: str,
        file: SystemFile,
        nodes: tuple[tuple[str, MachineOutline], ...],
        plugins: tuple[tuple[str, MachineOutline], ...],
        owners: tuple[str, ...],
        trees: tuple[ListedTree, ...],
        rates: tuple[float | None, ...],
        structs: Structs,
        known: tuple[frozenset[Gap], bool, frozenset[str]],
    ) -> System:
        paths = tuple(dict.fromkeys(outline.path for tree in trees for outline in tree.files))
        expansion = expand_listed(trees)
        instances, uses = expansion.instances, expansion.uses
        listed = (SystemTree(tree.name, tree.files[0].path, rate) for tree, rate in zip(trees, rates, strict=True))
        system = System(
            *(path, file.older, file.parameters, nodes, plugins, instances, uses, paths, structs.types, *known),
            trees=tuple(listed),
            owners=owners,
        )
        if not system.is_library_tree:
            return system
        from roaml.lower.library_tree import LibraryTreeBuilder  # noqa: PLC0415 - most trees do not need it

        files = self._tree_files(system)
        builder = LibraryTreeBuilder(system, files, self._shapes())
        completed = replace(system, entries=builder.entries())
        self._sources.memo.get("library tree builder", path, (completed, tuple(files.values())), lambda: builder)
        return completed

    def _tree_files(self, system: System) -> dict[str, TreeFile]:
        return {path: file for path in system.tree_paths if (file := self._sources.tree(path)) is not None}

    def library_tree(self, path: str) -> LibraryTree | None:
        """The translated tree of a system if it is executed as BehaviorTree.CPP executes it (`System.is_library_tree`);
        `None` for other trees."""
        system = self.system(path)
        if system is None or not system.is_library_tree:
            return None
        if (expanded := self._expanded(path)) is not None:
            return expanded.library_tree(path)
        from roaml.lower.library_tree import LibraryTreeBuilder  # noqa: PLC0415 - most trees do not need it

        files, shapes = self._tree_files(system), self._shapes()
        key = (system, tuple(files.values()))
        builder = self._sources.memo.get(
            "library tree builder", path, key, lambda: LibraryTreeBuilder(system, files, shapes)
        )
        return self._sources.memo.get("library tree", path, key, builder.tree)

    def _shapes(self) -> dict[Hashable, Child | None]:
        """The nodes of trees that were explored before, by their shapes. They do not depend on files."""
        shapes: dict[Hashable, Child | None] = self._sources.memo.get("shapes of nodes", "", (), dict)
        if len(shapes) > MAX_SHAPES:
            shapes.clear()
        return shapes

    def forest(self, path: str, system: str | None = None) -> Forest | None:
        """The trees that are analysed together with the tree file `path`, with the definitions of their nodes, in a
        system or without one; `None` if the file or the system cannot be read."""
        if system is None:
            return self._families.forest(path)
        linked = self.system(system)
        if linked is None or self._sources.tree(path) is None:
            return None
        files = tuple(self._tree_files(linked).items())
        if all(path != other for other, _ in files):
            return None
        seen = linked.seen_from(path)
        return self._sources.memo.get(
            "linked trees", (path, system), (files, seen), lambda: Forest(path, files, NEWEST, system=seen)
        )

    def _observed(self, listed: tuple[ListedFile, ...]) -> frozenset[str]:
        """The variables that the properties of a system use."""
        paths = [f.path for f in listed if f.required_kind is FileKind.PROPERTIES and f.usable]
        properties = [declared for path in paths for declared in self._sources.properties(path)[0]]
        names = {name for declared in properties for name, _ in identifiers(declared.expression)}
        xml_paths = [f.path for f in listed if f.required_kind is FileKind.XML_PROPERTIES and f.usable]
        files = [file for path in xml_paths if (file := self._sources.property_file(path)) is not None]
        return frozenset(names.union(*(observed_names(file) for file in files)))

    def _knows_plugins(self, path: str, listed: tuple[ListedFile, ...]) -> bool:
        """Whether the names of all plugins of the system are known: no error hides a plugin or its name."""
        file = self._sources.system_file(path)
        if file is None or SystemSection.BEHAVIOR_TREE in file.unread or not self._sources.is_well_formed(path):
            return False
        for entry in listed:
            if entry.input.section is SystemSection.BEHAVIOR_TREE and entry.required_kind is not FileKind.TREE:
                machine = (
                    self._sources.machine(entry.path)
                    if entry.required_kind is FileKind.MACHINE and entry.usable
                    else None
                )
                if machine is None or machine.name is None or not self._sources.is_well_formed(entry.path):
                    return False
        return True

    def linked_properties(self, path: str, system: str) -> LinkedFile | None:
        """The properties in an XML file, linked to a system that lists the file; `None` if the file or the system
        cannot be read."""
        file, linked = self._sources.property_file(path), self.system(system)
        if file is None or linked is None:
            return None
        taken = tuple(self._systems.names_before(path, system))
        variables = self.globals(system)
        compute = functools.partial(link, file, linked, self._interfaces.interface, variables, dict(taken), path)
        return self._sources.memo.get("linked properties", (path, system), (file, linked, taken), compute)

    def typed_in(self, path: str, system: str | None) -> TypedMachine:
        """The machine in the file `path` with its types, as a part of `system`. If `system` is `None`, the machine is
        not in a system."""
        # The result refers to parts of the machine, which may be read again in the same moment.
        machine = self._sources.machine(path)
        known = self._typed.get((path, system))
        if known is None or known[0] is not machine:
            linked = self.system(system) if system else None
            structs, events = self._machines.structs(system), linked.event_data if linked else {}
            known = machine, self._machines.typed(path, system, structs, events)
            self._typed[path, system] = known
        return known[1]

    def environment(self, system: str | None) -> Environment:
        """The types that the machines of a system can use. A machine without a system can use only ROS types."""
        linked = self.system(system) if system else None
        published = (
            {topic: self._interfaces.messages(types) for topic, types in self._machines.published(system).items()}
            if system
            else {}
        )
        return MachineEnvironment(
            self._interfaces, self._machines.structs(system), linked.event_data if linked else {}, published
        )

    def machines_in(self, system: System) -> dict[str, Machine]:
        """The machines of a system, by path."""
        paths = dict.fromkeys(path for path, _ in (*system.nodes, *system.plugins))
        return {path: machine for path in paths if (machine := self._sources.machine(path)) is not None}

    def size_of_translation(self, path: str) -> Size | None:
        """The size of the translation of a system, even if it has errors; `None` if there is no system in the file."""
        system, file = self.system(path), self._sources.system_file(path)
        if system is None or file is None:
            return None
        machines, place = self.machines_in(system), Location(path, file.element.name_span)
        program = TranslatableSystem(system, machines, self.environment(path), place, {}, system.parameters)
        key = (system, tuple(machines.items()))
        return self._sources.memo.get("size", path, key, lambda: size_of(program, self.globals(path)))

    def globals(self, system: str) -> Mapping[str, GlobalVariable]:
        """The global variables of the translated system, by name."""
        linked = self.system(system)
        if linked is None:
            return {}
        environment = MachineEnvironment(self._interfaces, NO_STRUCTS, {}, {})
        return self._sources.memo.get(
            "globals", system, linked, lambda: global_variables(linked, environment.interface)
        )

    def event_parameters(self, system: str) -> Mapping[str, Mapping[str, Type]]:
        """The parameters of each event of the translated system, with the types of the models."""
        linked = self.system(system)
        environment = MachineEnvironment(self._interfaces, NO_STRUCTS, {}, {})
        return {} if linked is None else event_parameters(linked, environment.interface)
