# SPDX-License-Identifier: Apache-2.0
"""Searches for what is certain about the properties of a system, within limits that they share."""

from __future__ import annotations

import enum
from collections.abc import Mapping, Sequence

from roaml.comparison import Comparison
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, Space, StateLimits, explore
from roaml.explicit.values import NoValueError, values_of
from roaml.interruption import checkpoint
from roaml.jani.properties import Property
from roaml.project.exploration import MAX_BYTES
from roaml.record import Record
from roaml.scxml.names import flag_of
from roaml.scxml.observed import ObservedPort, ObservedProperty, ObservedVariable, PortEvent
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.names import Storage
from roaml.smc.registers import REAL
from roaml.smc.statistics import Bounds

MAX_STATES = 20_000
"""The maximum number of states of each search."""
MAX_STEPS, MAX_CAUSE_STEPS = 400_000, 2_000_000
"""The limits of the steps of all searches for the properties of a system, including their preparation, and of those for
the causes of what they have found."""
PREPARATION = 10
"""The steps that take as long as the preparation of one instruction of a model for a search."""


class Doubt(enum.Enum):
    """What is certain about a property, and certainly not intended.

    Attributes:
        SCOPE: its scope never begins, so that it holds in all runs.
        TRIGGER: nothing ever happens after which it requires something, so that it holds in all runs.
        NEVER: no run meets it.
        UNMET: no value that it can have meets its expectation.
    """

    SCOPE = enum.auto()
    TRIGGER = enum.auto()
    NEVER = enum.auto()
    UNMET = enum.auto()


class Doubted(Record, frozen=True):
    """A property with a doubt.

    Attributes:
        values: the bounds of its values over all runs and schedulers.
        observed: its observer; `None` for a property in JANI.
        expected: its expectation that no value meets; `None` if there is none, or if it is a part of the formula.
        is_instant: whether the doubt is only known if all machines react at once.
        simulated: the number of simulated runs from which the doubt is known, of which `values` is the share that
            satisfies the property; for `NEVER`, of those that test it. 0 if all states are known.
    """

    doubt: Doubt
    values: Bounds
    property: Property
    observed: ObservedProperty | None
    expected: Comparison | None
    is_instant: bool
    simulated: int = 0


class PropertySearch:
    """Searches for answers about models of one system, within limits that they share."""

    def __init__(self, steps: int) -> None:
        self._left = steps

    def values(self, checker: ModelChecker, property_: CompiledProperty) -> Bounds | None:
        """The bounds of the values of a property over all schedulers; `None` if they are not known."""
        space = self.space(checker, property_)
        return None if space is None else values_in(space)

    def space(self, checker: ModelChecker, property_: CompiledProperty) -> Space | None:
        """The states of a model that are reached before a property is decided; `None` if they are not known."""
        own = checker.reduced(property_)
        subject = property_ if own is checker else own.compiled_properties[0]
        self._left -= PREPARATION * len(own.program.code)
        if self._left <= 0:
            return None
        limits = StateLimits(MAX_STATES, MAX_BYTES, combinations=4_096, transitions=self._left)
        is_reduced = can_be_reduced(own.program, subject.goal)
        try:
            space = explore(own, subject, limits, lambda _: checkpoint(), is_reduced=is_reduced)
        except LimitError as error:
            self._left -= 0 if error.search is None else error.search.transitions + error.search.passed
            return None
        self._left -= space.search.transitions + space.search.passed
        return space if space.problem is None else None

    def never(
        self, checker: ModelChecker, ports: Sequence[ObservedPort], *, is_notable: bool
    ) -> Mapping[str, set[float]] | None:
        """See `roaml.project.property_causes.Evidence`."""
        space = self.space(checker, checker.compiled_properties[0])
        values = None if space is None else values_in(space)
        if space is None or values is None or values.upper > 0.0:
            return None
        variables = ((port, variable) for port in ports for variable in port.variables if variable.initial is not None)
        return {variable.id: _reached(space, port.events, variable) for port, variable in variables}

    def always(self, checker: ModelChecker) -> bool:
        """See `roaml.project.property_causes.Evidence`."""
        values = self.values(checker, checker.compiled_properties[0])
        return values is not None and values.lower == 1.0

    def is_impossible(self, checker: ModelChecker, asked: Property) -> bool:
        """Whether the property `asked`, that something happens at some time, holds in no run."""
        try:
            other = checker.asking(asked)
        except FaultError:
            return False
        values = self.values(other, other.compiled_properties[0])
        return values is not None and values.upper == 0.0


def values_in(space: Space) -> Bounds | None:
    """The bounds of the values of a property over all schedulers; `None` if they are not known."""
    try:
        values = values_of(space)
    except NoValueError:
        return None
    return Bounds(values.minimum.lower, values.maximum.upper)


def _reached(space: Space, events: tuple[PortEvent, ...], variable: ObservedVariable) -> set[float]:
    """The values that a variable of a port has after the events of the port; empty if they are not known."""
    from roaml.explicit.spreads import cell_value  # noqa: PLC0415 - most properties have no doubt

    shared = {storage.name: storage for storage in space.checker.legend.layout.shared}
    values: set[float] = set()
    for event in events:
        value, flag = shared.get(f"{event.name}__{variable.parameter}"), shared.get(flag_of(event.name))
        if value is None or flag is None or value.shape:
            return set()
        cells = _cell(space, value), _cell(space, flag)
        for state in range(space.states):
            key = space.search.key(state)
            if key[cells[1]]:
                values.add(cell_value(key[cells[0]], value.kind))
    return values


def _cell(space: Space, storage: Storage) -> int:
    program = space.checker.program
    return program.instances + storage.base + (program.int_count if storage.kind == REAL else 0)
