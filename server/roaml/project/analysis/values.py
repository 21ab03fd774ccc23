# SPDX-License-Identifier: Apache-2.0
"""The values in the machines of a system, cached by machine: only a machine that changes, or at which other values
arrive, is analysed again.

Each round begins with values that are too large and makes them smaller: what machines send if anything may arrive, and
what they send if only that arrives. So the result of each round is valid, and `ROUNDS` limits the time only.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from roaml.model.kinds import FileKind
from roaml.model.property_links import LinkedFile
from roaml.model.system import System
from roaml.model.values.analyse import Arriving, MachineValues, Sent, analyse
from roaml.model.values.arriving import arriving, arriving_by_type, observed_values
from roaml.model.values.global_values import GlobalValues, global_values
from roaml.model.values.remembered import Memory
from roaml.project.analysis.linking import Linking
from roaml.project.analysis.sources import SourceFiles
from roaml.project.analysis.systems import Systems
from roaml.project.ros_types import Interfaces
from roaml.record import replace

ROUNDS = 2

_SLOT = "values of round {}"

Rounds: TypeAlias = "tuple[Arriving, ...]"
"""What can arrive at a machine in each round."""


class ReachedValues:
    """The values in machines, and what can arrive at them."""

    def __init__(self, sources: SourceFiles, interfaces: Interfaces, systems: Systems, linking: Linking) -> None:
        self._sources = sources
        self._interfaces = interfaces
        self._systems = systems
        self._linking = linking
        self._rounds: dict[str, Mapping[str, Rounds]] = {}

    def arriving_at(self, path: str, system: str | None) -> Arriving:
        """What can arrive at the machine in the file `path` as a part of `system`. In an incomplete system, and without
        a system, it is determined by the types."""
        return self._rounds_at(path, system)[-1]

    def values_in(self, path: str, system: str | None) -> MachineValues:
        """The values in the machine in the file `path` as a part of `system`."""
        return self._analysed(path, system, self._rounds_at(path, system))

    def local_values(self, path: str, system: str | None) -> MachineValues:
        """The values in the machine in the file `path` if everything may arrive that the types allow."""
        return self._analysed(path, system, (self._by_type(path),))

    def observed(self, path: str, system: str) -> LinkedFile | None:
        """The properties in the XML file `path`, linked to `system`, with the values of their variables."""
        file, linked = self._linking.linked_properties(path, system), self._linking.system(system)
        if file is None or linked is None or not linked.complete:
            return file
        of_file = observed_values(file, linked, self._sent(linked, system))

        def compute() -> LinkedFile:
            return replace(file, values=of_file)

        return self._sources.memo.get("observed properties", (path, system), (file, of_file), compute)

    def of_globals(self, system: str) -> Mapping[str, GlobalValues]:
        """The values of the global variables of interfaces and trees, which properties in JANI use, by name."""
        linked = self._linking.system(system)
        if linked is None or not linked.complete:
            return {}
        sent = self._sent(linked, system)
        interface = self._interfaces.interface
        return self._sources.memo.get(
            "values of globals", system, (linked, sent), lambda: global_values(linked, sent, interface)
        )

    def _sent(self, linked: System, system: str) -> dict[str, Sent | None]:
        """Path of a machine of a complete system -> what it sends; `None` if this is not known."""
        machines = dict.fromkeys(path for path, _ in (*linked.nodes, *linked.plugins))
        known = {path: self.values_in(path, system) for path in machines if self._sources.machine(path) is not None}
        return {path: values.sent if values.complete else None for path, values in known.items()}

    def _by_type(self, path: str) -> Arriving:
        machine = self._sources.machine(path)
        assert machine is not None
        return arriving_by_type(machine, self._interfaces.interface)

    def _rounds_at(self, path: str, system: str | None) -> Rounds:
        linked = self._linking.system(system) if system else None
        if system is None or linked is None or not linked.complete:
            return (self._by_type(path),)
        if system not in self._rounds:
            self._rounds[system] = self._rounds_in(system, linked)
        return self._rounds[system].get(path, ({},))

    def _rounds_in(self, system: str, linked: System) -> Mapping[str, Rounds]:
        """Path of a machine -> what can arrive at it, for the machines of a complete system."""
        listed = [f.path for f in self._systems.listed(system) if f.required_kind is FileKind.MACHINE and f.usable]
        machines = {path: machine for path in listed if (machine := self._sources.machine(path)) is not None}

        def compute() -> Mapping[str, Rounds]:
            result: dict[str, Rounds] = {path: (self._by_type(path),) for path in machines}
            for _ in range(ROUNDS):
                sent: dict[str, Sent | None] = {}
                for path in machines:
                    values = self._analysed(path, system, result[path])
                    sent[path] = values.sent if values.complete else None
                for path, machine in machines.items():
                    result[path] += (arriving(machine, path, linked, sent, self._interfaces.interface),)
            return result

        key = (linked, tuple((path, self._linking.typed_in(path, system)) for path in machines))
        return self._sources.memo.get("arriving", system, key, compute)

    def _analysed(self, path: str, system: str | None, rounds: Rounds) -> MachineValues:
        """The values in a machine in the last of `rounds`. If the same arrives as in an earlier round, the values are
        the same, too."""
        machine, memo = self._sources.machine(path), self._sources.memo
        assert machine is not None
        typed, data = self._linking.typed_in(path, system), rounds[-1]
        number = rounds.index(data)
        memory = memo.get("transitions", (path, system), None, Memory)

        def compute() -> MachineValues:
            if number == 0:
                memory.begin()
            values = analyse(machine, typed, data, memory=memory)
            memory.complete()
            return values

        return memo.get(_SLOT.format(number), (path, system), (typed, data), compute)
