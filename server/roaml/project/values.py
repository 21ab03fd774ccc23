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
from roaml.model.values.analyse import Arriving, MachineValues, Sent, analyse
from roaml.model.values.arriving import arriving, arriving_by_type
from roaml.model.values.remembered import Memory
from roaml.project.analysis import Analysis

ROUNDS = 2

_SLOT = "values of round {}"

Rounds: TypeAlias = "tuple[Arriving, ...]"
"""What can arrive at a machine in each round."""


def arriving_at(analysis: Analysis, path: str, system: str | None) -> Arriving:
    """What can arrive at the machine in the file `path` as a part of `system`. In an incomplete system, and without a
    system, it is determined by the types."""
    return _rounds_at(analysis, path, system)[-1]


def values_in(analysis: Analysis, path: str, system: str | None) -> MachineValues:
    """The values in the machine in the file `path` as a part of `system`."""
    return _analysed(analysis, path, system, _rounds_at(analysis, path, system))


def local_values(analysis: Analysis, path: str, system: str | None) -> MachineValues:
    """The values in the machine in the file `path` if everything may arrive that the types allow."""
    return _analysed(analysis, path, system, (_by_type(analysis, path),))


def _by_type(analysis: Analysis, path: str) -> Arriving:
    machine = analysis.machine(path)
    assert machine is not None
    return arriving_by_type(machine, analysis.interface)


def _rounds_at(analysis: Analysis, path: str, system: str | None) -> Rounds:
    linked = analysis.system(system) if system else None
    if system is None or linked is None or not linked.complete:
        return (_by_type(analysis, path),)
    return _rounds_in(analysis, system).get(path, ({},))


def _rounds_in(analysis: Analysis, system: str) -> Mapping[str, Rounds]:
    """Path of a machine -> what can arrive at it, for the machines of a complete system."""
    linked = analysis.system(system)
    assert linked is not None
    listed = [f.path for f in analysis.listed(system) if f.required_kind is FileKind.MACHINE and f.usable]
    machines = {path: machine for path in listed if (machine := analysis.machine(path)) is not None}

    def compute() -> Mapping[str, Rounds]:
        result: dict[str, Rounds] = {path: (_by_type(analysis, path),) for path in machines}
        for _ in range(ROUNDS):
            sent: dict[str, Sent | None] = {}
            for path in machines:
                values = _analysed(analysis, path, system, result[path])
                sent[path] = values.sent if values.complete else None
            for path, machine in machines.items():
                result[path] += (arriving(machine, path, linked, sent, analysis.interface),)
        return result

    key = (linked, tuple((path, analysis.typed_in(path, system)) for path in machines))
    return analysis.memo.get("arriving", system, key, compute)


def _analysed(analysis: Analysis, path: str, system: str | None, rounds: Rounds) -> MachineValues:
    """The values in a machine in the last of `rounds`. If the same arrives as in an earlier round, the values are the
    same, too."""
    machine = analysis.machine(path)
    assert machine is not None
    typed, data = analysis.typed_in(path, system), rounds[-1]
    number = rounds.index(data)
    memory = analysis.memo.get("transitions", (path, system), None, Memory)

    def compute() -> MachineValues:
        if number == 0:
            memory.next_version()
        return analyse(machine, typed, data, memory=memory)

    return analysis.memo.get(_SLOT.format(number), (path, system), (typed, data), compute)
