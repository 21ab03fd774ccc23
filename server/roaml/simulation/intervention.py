# SPDX-License-Identifier: Apache-2.0
"""A change of the state by the user, which is not a step of the model: an event is sent, or variables are set."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from roaml.record import Record
from roaml.scxml.names import RECEIVED
from roaml.smc.compile import Legend
from roaml.smc.kernel import Kernel
from roaml.smc.names import Storage
from roaml.smc.record import Plain, RecordedVariable
from roaml.smc.registers import REAL


class Intervention(Record, frozen=True):
    """A change of the state.

    Attributes:
        event: the event that is sent; "" if only variables are set.
        values: the variables of the network that are set, with their values. The value of an array contains all
            elements.
    """

    event: str
    values: tuple[tuple[RecordedVariable, Plain], ...]

    def to_json(self) -> dict[str, Any]:
        return {"event": self.event, "values": [[v.instance, v.name, value] for v, value in self.values]}

    @staticmethod
    def from_json(row: Any) -> Intervention:
        """The inverse of `to_json`.

        Raises:
            KeyError, TypeError, ValueError: `row` was not written by `to_json`.
        """
        values = tuple((RecordedVariable(_instance(i), str(name)), _plain(value)) for i, name, value in row["values"])
        return Intervention(str(row["event"]), values)


class WrongNumberError(ValueError):
    """A value from JSON is not the expected number; the message states which are possible."""


def whole_number(value: Any, most: int = (1 << 31) - 1) -> int:
    """A number from JSON that is an integer from 0 to `most`.

    Raises:
        WrongNumberError: the value is another number, or something else.
    """
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= most:
        raise WrongNumberError(f"{str(value)[:40]} is not an integer from 0 to {most}")
    return value


def _instance(value: Any) -> int:
    """The number of an instance; -1 is the model."""
    return -1 if value == -1 and isinstance(value, int) else whole_number(value)


def _plain(value: Any) -> Plain:
    if isinstance(value, list):
        return [_plain(element) for element in value]
    if isinstance(value, (bool, int, float)):
        return value
    raise TypeError(f"{value} is not a value of a variable")


def is_free(kernel: Kernel, legend: Legend, event: str) -> bool:
    """Whether an event can be sent: the previous event with its name has been received."""
    buffer = _buffer(legend, event)
    return buffer < 0 or legend.locations[kernel.location(buffer)][1] != RECEIVED


def is_possible(legend: Legend, variables: Iterable[tuple[RecordedVariable, Storage]], change: Intervention) -> bool:
    """Whether the model has the event and the variables, and the values have the right types and shapes."""
    storages = dict(variables)
    if change.event and not any(action == f"{change.event}_on_send" for _, action in legend.vectors):
        return False
    return all(v in storages and _fits(value, storages[v], storages[v].shape) for v, value in change.values)


def _fits(value: Plain, storage: Storage, shape: tuple[int, ...]) -> bool:
    if shape:
        return isinstance(value, list) and len(value) == shape[0] and all(_fits(e, storage, shape[1:]) for e in value)
    if isinstance(value, list) or (isinstance(value, float) and storage.kind != REAL):
        return False
    low, high = storage.bounds
    return (low is None or value >= low) and (high is None or value <= high) and abs(value) < 1 << 63


def intervene(
    kernel: Kernel, legend: Legend, variables: Iterable[tuple[RecordedVariable, Storage]], change: Intervention
) -> None:
    """Change the state of a kernel. The random numbers of the following steps stay the same, and the kernel counts the
    change as a step."""
    *_, goal, draws, _ = kernel.save()
    place = [kernel.location(number) for number in range(len(legend.layout.instances))]
    ints, reals = kernel.snapshot()
    storages = dict(variables)
    for variable, value in change.values:
        storage = storages[variable]
        cells: list[Any] = reals if storage.kind == REAL else ints
        for offset, cell in enumerate(_cells(value)):
            cells[storage.base + offset] = cell
    buffer = _buffer(legend, change.event)
    if (buffer, RECEIVED) in legend.locations:  # an event that nobody receives has no such location
        place[buffer] = legend.locations.index((buffer, RECEIVED))
    kernel.restore(place, ints, reals)
    arrays, counts, (status, must_look, _, still, _), _, loop = kernel.save()
    kernel.load((arrays, counts, (status, must_look, goal[2] + 1, still, goal[4]), draws, loop))


def _buffer(legend: Legend, event: str) -> int:
    """The instance that buffers an event; -1 if there is none."""
    names = (instance.automaton.name for instance in legend.layout.instances)
    return next((number for number, name in enumerate(names) if name == event), -1)


def _cells(value: Plain) -> list[Any]:
    return [cell for element in value for cell in _cells(element)] if isinstance(value, list) else [value]
