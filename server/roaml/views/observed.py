# SPDX-License-Identifier: Apache-2.0
"""The steps of an observer (docs/spec/jani.md#observers) in words: what it observes, and what this means for its
property."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from roaml.scxml.names import (
    CLOCK_ACTION,
    OPEN,
    PENDING,
    SATISFIED,
    TIME_OVER_ACTION,
    VIOLATED,
    observer_automaton,
    observer_prefix,
    prefix_of_observer,
    safe_name,
    sent_by,
)
from roaml.views.actors import event_subject
from roaml.views.arrays import DeclaredChange

_BECOMES_TRUE = {
    VIOLATED: "the property is violated",
    SATISFIED: "the property is satisfied",
    OPEN: "the time ends before the deadline of the property",
    PENDING: "the property requires an event from now on",
}

REQUIRED_OCCURRED = "the required event has occurred"


def observed_property(observer: str, property_: str) -> str:
    """The name of the property of an observer.

    Args:
        property_: the name of the property for which a trace is explained. Its observer has this name with `_` instead
            of some characters; the other observers have the names of assumptions.
    """
    prefix = prefix_of_observer(observer)
    return property_ if prefix.rstrip("_") == safe_name(property_).rstrip("_") else prefix


def observation(action: str | None, automata: Mapping[str, str]) -> str:
    """What an observer observes in a step with an action of the model.

    Args:
        automata: the names of all automata, with their names for users.
    """
    if action == CLOCK_ACTION:
        return "observes a step of the clock"
    if action == TIME_OVER_ACTION:
        return "observes the end of time"
    event = sent_by(action or "")
    return f"observes {event_subject(event, automata)}" if event else "observes a step"


def effects(changes: Sequence[DeclaredChange]) -> Iterator[str]:
    """What the changes of the variables of an observer mean for its property."""
    values = {_ending(change): change.after for change in changes}
    yield from (text for ending, text in _BECOMES_TRUE.items() if values.get(ending) is True)
    if values.get(PENDING) is False and not values.get(VIOLATED) and not values.get(OPEN):
        yield REQUIRED_OCCURRED


def _ending(change: DeclaredChange) -> str:
    return change.variable.name.rpartition("__")[2]


def observer_phrase(variable: str, automata: Collection[str]) -> str:
    """A phrase for a variable of the model that belongs to an observer, with the name of the property and of the
    variable; "" for another variable."""
    prefix, separator, ending = variable.rpartition("__")
    return f"{prefix}: {ending}" if separator and observer_automaton(prefix) in automata else ""


def reads_observer(variable: str, automata: Collection[str]) -> bool:
    """Whether a variable of the model belongs to an observer."""
    prefix = observer_prefix(variable, VIOLATED, SATISFIED, PENDING, OPEN)
    return bool(prefix) and observer_automaton(prefix) in automata
