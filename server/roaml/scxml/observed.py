# SPDX-License-Identifier: Apache-2.0
"""Properties of plain automata: the observed parts of the events that they send (docs/spec/xml-properties.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from roaml.comparison import Comparison
from roaml.expr.tree import Expr
from roaml.expr.types import Type
from roaml.observers.properties import Property
from roaml.text import Location


@dataclass(frozen=True, slots=True)
class PortEvent:
    """An event of the translation.

    Attributes:
        name: the name of the event.
        sender: the only automaton whose events are observed; "" for all automata.
        constants: the values that follow from the event itself: kind of variable -> value.
    """

    name: str
    sender: str = ""
    constants: tuple[tuple[str, int | bool], ...] = ()


@dataclass(frozen=True, slots=True)
class ObservedVariable:
    """Attributes:
    kind: the kind of the constant of an event, if it is one.
    parameter: the parameter of the events; "" if it is not read from a parameter.
    initial: the value before the first event; `None` for a variable that is true when the event is sent.
    """

    id: str
    kind: str
    type: Type
    parameter: str
    initial: Expr | None


@dataclass(frozen=True, slots=True)
class ObservedPort:
    events: tuple[PortEvent, ...]
    variables: tuple[ObservedVariable, ...]


@dataclass(frozen=True, slots=True)
class ObservedProperty:
    """
    Attributes:
        conditions: what the inputs of its observer are, as expressions over the ids of the variables.
        comment: what the property requires, as a sentence.
        assumptions: the properties that are assumed for it.
        expected: what is expected of its probability.
    """

    name: str
    property: Property
    conditions: Mapping[str, Expr]
    ports: tuple[ObservedPort, ...]
    origin: Location
    comment: str = ""
    assumptions: tuple[ObservedProperty, ...] = ()
    expected: Comparison | None = None
