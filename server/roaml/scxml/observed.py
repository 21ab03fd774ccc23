# SPDX-License-Identifier: Apache-2.0
"""Properties of a system in plain SCXML, with the events and parameters that they observe
(docs/spec/xml-properties.md)."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.comparison import Comparison
from roaml.expr.tree import Expr
from roaml.expr.types import Type
from roaml.observers.properties import Property
from roaml.record import Record
from roaml.text import Location


class PortEvent(Record, frozen=True):
    """An event of the translation that a port observes.

    Attributes:
        name: the name of the event.
        sender: the automaton that must send the event, itself or by one of its threads; "" if any automaton may.
        constants: the values that the event itself determines: kind of variable and value.
    """

    name: str
    sender: str = ""
    constants: tuple[tuple[str, int | bool], ...] = ()


class ObservedVariable(Record, frozen=True):
    """A variable whose value the events of a port determine.

    Attributes:
        kind: the kind of the variable. If an event has a constant of this kind, the constant is the value.
        parameter: the parameter of the events that contains the value; "" if there is none.
        initial: the value before the first event; `None` for a variable that is true only when the event is sent.
    """

    id: str
    kind: str
    type: Type
    parameter: str
    initial: Expr | None


class ObservedPort(Record, frozen=True):
    events: tuple[PortEvent, ...]
    variables: tuple[ObservedVariable, ...]


class ObservedProperty(Record, frozen=True):
    """A property with the ports that it observes.

    Attributes:
        conditions: input of the observer -> its expression over the ids of the variables.
        comment: a sentence that states the property.
        assumptions: the properties that are assumed to hold.
        expected: the expected probability; `None` if there is no expectation.
    """

    name: str
    property: Property
    conditions: Mapping[str, Expr]
    ports: tuple[ObservedPort, ...]
    origin: Location
    comment: str = ""
    assumptions: tuple[ObservedProperty, ...] = ()
    expected: Comparison | None = None
