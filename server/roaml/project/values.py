# SPDX-License-Identifier: Apache-2.0
"""The values in the machines of a system, cached by machine: only a machine that changes, or at which other values
arrive, is analysed again.

Each round begins with values that are too large and makes them smaller: what machines send if anything may arrive, and
what they send if only that arrives. So the result of each round is valid, and `ROUNDS` limits the time only.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping

from roaml.model.kinds import FileKind
from roaml.model.values.analyse import Arriving, MachineValues, Sent, analyse
from roaml.model.values.arriving import arriving, arriving_by_type
from roaml.project.analysis import Analysis

ROUNDS = 2

_ROUND = "values of round {}"


def arriving_at(analysis: Analysis, path: str, system: str | None) -> Arriving:
    """What can arrive at the machine in the file `path` as a part of `system`. In an incomplete system, and without a
    system, it is determined by the types."""
    machine = analysis.machine(path)
    assert machine is not None
    linked = analysis.system(system) if system else None
    if system is None or linked is None or not linked.complete:
        return arriving_by_type(machine, analysis.interface)
    return _arriving_in(analysis, system).get(path, {})


def values_in(analysis: Analysis, path: str, system: str | None) -> MachineValues:
    """The values in the machine in the file `path` as a part of `system`."""
    return _analysed(analysis, path, system, arriving_at(analysis, path, system), "values")


def local_values(analysis: Analysis, path: str, system: str | None) -> MachineValues:
    """The values in the machine in the file `path` if everything may arrive that the types allow."""
    machine = analysis.machine(path)
    assert machine is not None
    return _analysed(analysis, path, system, arriving_by_type(machine, analysis.interface), _ROUND.format(0))


def _arriving_in(analysis: Analysis, system: str) -> Mapping[str, Arriving]:
    """Path of a machine -> what can arrive at it, for the machines of a complete system."""
    linked = analysis.system(system)
    assert linked is not None
    listed = [f.path for f in analysis.listed(system) if f.required_kind is FileKind.MACHINE and f.usable]
    machines = {path: machine for path in listed if (machine := analysis.machine(path)) is not None}

    def compute() -> Mapping[str, Arriving]:
        result = {path: arriving_by_type(machine, analysis.interface) for path, machine in machines.items()}
        for number in range(ROUNDS):
            sent: dict[str, Sent | None] = {}
            for path in machines:
                values = _analysed(analysis, path, system, result[path], _ROUND.format(number))
                sent[path] = values.sent if values.complete else None
            result = {
                path: arriving(machine, path, linked, sent, analysis.interface) for path, machine in machines.items()
            }
        return result

    key = (linked, tuple((path, analysis.typed_in(path, system)) for path in machines))
    return analysis.memo.get("arriving", system, key, compute)


def _analysed(analysis: Analysis, path: str, system: str | None, data: Arriving, slot: str) -> MachineValues:
    machine = analysis.machine(path)
    assert machine is not None
    typed = analysis.typed_in(path, system)
    compute = functools.partial(analyse, machine, typed, data)
    return analysis.memo.get(slot, (path, system), (typed, data), compute)
