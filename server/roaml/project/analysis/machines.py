# SPDX-License-Identifier: Apache-2.0
"""Machines with their types, as parts of a system.

Types and outlines are cached by the machine and the declarations that it uses.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping

from roaml.expr.types import Struct, Type
from roaml.interfaces.registry import NotFound
from roaml.interfaces.search import is_standard
from roaml.model.gaps import Gap, GapAct, PlacedGap, machine_gaps
from roaml.model.kinds import FileKind
from roaml.model.machine import Machine
from roaml.model.outline import MachineOutline, outline
from roaml.model.ros import InterfaceType
from roaml.model.structs import StructOutline, resolve_structs
from roaml.model.syntax import Name
from roaml.model.system_file import SystemSection
from roaml.model.value_types import INTERFACE_KINDS, TypedMachine, type_machine
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.systems import Systems
from roaml.project.ros_types import Interfaces
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.scxml.names import sanitise


class Structs(Record, frozen=True, eq=False):
    """The structs of a system.

    Attributes:
        outlines: the declarations without positions. Equal outlines mean equal structs.
        complete: whether the names of all structs are known.
    """

    outlines: tuple[StructOutline, ...]
    types: Mapping[str, Type]
    complete: bool


NO_STRUCTS = Structs((), {}, complete=True)


class MachineEnvironment:
    """An implementation of `roaml.model.value_types.Environment` for one machine."""

    def __init__(
        self,
        interfaces: Interfaces,
        structs: Structs,
        events: Mapping[str, Struct],
        published: Mapping[str, tuple[InterfaceType, ...]],
    ) -> None:
        self.struct = structs.types.get
        self.event_data = events.get
        self._interfaces = interfaces
        self._published = published

    def published(self, topic: str) -> tuple[InterfaceType, ...]:
        return self._published.get(sanitise(topic), ())

    def interface(self, kind: str, name: str) -> InterfaceType | None:
        definition = self._interfaces.interface(kind, name)
        return definition if isinstance(definition, InterfaceType) else None


class Machines:
    """The types of machines, and the structs that a system declares for them."""

    def __init__(self, sources: SourceFiles, interfaces: Interfaces, systems: Systems) -> None:
        self._sources = sources
        self._interfaces = interfaces
        self._systems = systems
        self._structs: dict[str, Structs] = {}
        self._published_types: dict[str, Mapping[str, tuple[str, ...]]] = {}

    def structs(self, system: str | None) -> Structs:
        """The structs that a system declares; without a system, none."""
        if system is None:
            return NO_STRUCTS
        if system not in self._structs:
            self._structs[system] = self._resolve_structs(system)
        return self._structs[system]

    def _resolve_structs(self, system: str) -> Structs:
        section = SystemSection.DATA_DECLARATIONS
        files = [f.path for f in self._systems.listed(system) if f.usable and f.input.section is section]
        declared = [declaration.outline for path in files for declaration in self._sources.struct_declarations(path)]
        outlines = tuple(outline for outline in declared if outline is not None)
        complete = (
            self._systems.lists_all(system, section)
            and None not in declared
            and all(map(self._sources.is_well_formed, files))
        )
        make = functools.partial(self._make_structs, outlines, complete)
        return self._sources.memo.get("struct types", system, (outlines, complete), make)

    def _make_structs(self, outlines: tuple[StructOutline, ...], complete: bool) -> Structs:
        return Structs(outlines, resolve_structs(outlines), complete)

    def interface_files_of(self, system: str) -> tuple[str, ...]:
        """The definition files of the ROS types that the machines of a system use, directly or in fields, without those
        of the standard packages that are part of this tool."""
        paths: dict[str, None] = {}
        for member in self._systems.files_of(system):
            machine = self._sources.machine(member)
            for declaration in machine.declarations if machine is not None else ():
                if declaration.type is None or declaration.kind not in INTERFACE_KINDS:
                    continue
                kind, name = INTERFACE_KINDS[declaration.kind], declaration.type.value
                definition = self._interfaces.registry.resolve(kind, name)
                for part in () if isinstance(definition, NotFound) else self._interfaces.closure(definition):
                    if part.path and not is_standard(part.path):
                        paths[part.path] = None
        return tuple(paths)

    def outline(self, path: str, system: str, structs: Structs, events: Mapping[str, Struct]) -> MachineOutline:
        """The outline of the machine in the file `path`, as a part of `system`; see `typed`."""
        machine = self._sources.machine(path)
        assert machine is not None
        typed = self.typed(path, system, structs, events)
        make = functools.partial(self._make_outline, path, machine, typed)
        return self._sources.memo.get("outline", (path, system), typed, make)

    def _make_outline(self, path: str, machine: Machine, typed: TypedMachine) -> MachineOutline:
        return outline(machine, typed, self.machine_gaps(path, machine, typed))

    def machine_gaps(self, path: str, machine: Machine, typed: TypedMachine) -> tuple[PlacedGap, ...]:
        """The facts that the unreadable parts of a machine may contain, with their positions."""
        gaps = machine_gaps(machine, typed, self._interfaces.has_type)
        broken = self._sources.broken_at(path)
        return gaps if broken is None else (*gaps, PlacedGap(Gap(GapAct.ANYTHING), broken))

    def typed(self, path: str, system: str | None, structs: Structs, events: Mapping[str, Struct]) -> TypedMachine:
        """The machine in the file `path` with its types. `events` contains the known data of plain events."""
        machine = self._sources.machine(path)
        assert machine is not None
        known = {name: events[name] for name in _received(machine) if name in events}
        # The key contains the machine instead of its text, because the result refers to parts of the machine.
        published = self._published_for(machine, system)
        key = (machine, structs.outlines, self._interfaces.interfaces_of(machine), published, known)
        environment = MachineEnvironment(self._interfaces, structs, known, published)
        if not known:
            return self._sources.memo.get("typed", (path, system), key, lambda: type_machine(machine, environment))
        # The result without events is needed to link the system, so it has its own slot in the cache.
        before = self.typed(path, system, structs, {})
        compute = functools.partial(type_machine, machine, environment, before)
        return self._sources.memo.get("typed with events", (path, system), key, compute)

    def published(self, system: str) -> Mapping[str, tuple[str, ...]]:
        """Topic -> the types, as written, with which the machines of a system publish on it."""
        if system not in self._published_types:
            types_by_topic: dict[str, dict[str, None]] = {}
            for listed in self._systems.listed(system):
                machine = (
                    self._sources.machine(listed.path)
                    if listed.required_kind is FileKind.MACHINE and listed.usable
                    else None
                )
                for declaration in machine.declarations if machine else ():
                    topic, type_ = declaration.interface, declaration.type
                    if declaration.kind is SymbolKind.PUBLISHER and isinstance(topic, Name) and type_ is not None:
                        types_by_topic.setdefault(sanitise(topic.value), {})[type_.value] = None
            self._published_types[system] = {topic: tuple(types) for topic, types in types_by_topic.items()}
        return self._published_types[system]

    def _published_for(self, machine: Machine, system: str | None) -> dict[str, tuple[InterfaceType, ...]]:
        """Topic to which a machine subscribes -> the other types with which machines of the system publish on it.
        Topics without such types are left out."""
        if system is None:
            return {}
        types_by_topic: dict[str, tuple[InterfaceType, ...]] = {}
        for declaration in machine.declarations:
            if (
                declaration.kind is SymbolKind.SUBSCRIBER
                and isinstance(declaration.interface, Name)
                and declaration.type
            ):
                topic = sanitise(declaration.interface.value)
                types = self.published(system).get(topic, ())
                if others := self._interfaces.messages(t for t in types if t != declaration.type.value):
                    types_by_topic[topic] = others
        return types_by_topic


def _received(machine: Machine) -> set[str]:
    """The names of the plain events for which a machine has transitions."""
    handlers = (h for chart in machine.charts for state in chart.states for h in state.handlers)
    return {handler.event.value for handler in handlers if handler.event}
