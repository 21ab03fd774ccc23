# SPDX-License-Identifier: Apache-2.0
"""Descriptions of automata, locations and actions of a translated system."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from roaml.exhaustive import assert_never
from roaml.jani.expressions import Integer
from roaml.jani.model import Automaton, Destination
from roaml.scxml.events import Role
from roaml.scxml.names import (
    CLOCK_ACTION,
    NODE_PREFIX,
    STATUS_NAMES,
    TreeEventKind,
    automaton_role,
    read_tree_event,
    received_by,
)
from roaml.views.actors import actors_of
from roaml.views.arrays import DeclaredValue

_WITHOUT_ARTICLE = (Role.CLOCK, Role.BLACKBOARD, Role.TREE_ROOT)


def who(automata: Iterable[Automaton]) -> dict[str, str]:
    """The name of each automaton -> its name in texts for users."""
    return {
        automaton: phrase.removeprefix("the ") if automaton_role(automaton) in _WITHOUT_ARTICLE else phrase
        for automaton, phrase in actors_of(automata).items()
    }


def resting(automaton: Automaton) -> frozenset[str]:
    """The locations in which an automaton waits for an event, or that it never leaves. In all other locations it next
    executes a statement of a handler."""
    leaving: dict[str, list[str]] = {}
    for edge in automaton.edges:
        leaving.setdefault(edge.source, []).append(edge.action or "")
    return frozenset(
        location.name
        for location in automaton.locations
        if all(action == CLOCK_ACTION or received_by(action) for action in leaving.get(location.name, ()))
    )


def tree_text(
    actor: str, event: str, is_sent: bool, parameters: Mapping[str, DeclaredValue], names: Mapping[str, str]
) -> str:
    """A description of how a node sends or receives an event of the tree; "" for other events.

    Args:
        actor: the name of the node in texts for users.
        parameters: the parameters of the event; empty if it has not been sent yet.
        names: the names of all automata in texts for users.
    """
    tree = read_tree_event(event)
    if tree is None:
        return ""
    prefix = f"{NODE_PREFIX}{tree.number}_"
    child = next((name for automaton, name in names.items() if automaton.startswith(prefix)), f"bt_{tree.number}")
    match tree.kind:
        case TreeEventKind.TICK:
            return f"{actor} ticks {child}" if is_sent else f"{actor} is ticked"
        case TreeEventKind.HALT:
            return f"{actor} halts {child}" if is_sent else f"{actor} is halted"
        case TreeEventKind.RESPONSE if is_sent:
            return f"{actor} returns its status"
        case TreeEventKind.RESPONSE:
            status = parameters.get("status")
            name = STATUS_NAMES.get(status, "a status") if isinstance(status, int) else "a status"
            return f"{actor} receives {name} from {child}"
        case TreeEventKind.HALT_RESPONSE if is_sent:
            return f"{actor} reports that it has halted"
        case TreeEventKind.HALT_RESPONSE:
            return f"{actor} receives the report of {child} that it has halted"
        case _:
            return assert_never(tree.kind)


def returned_status(event: str, destination: Destination) -> str:
    """The status that a node of the tree returns by sending an event; "" for another event, or if the status is not a
    constant."""
    tree = read_tree_event(event)
    if tree is None or tree.kind is not TreeEventKind.RESPONSE:
        return ""
    values = (a.value for a in destination.assignments if a.variable == f"{event}__status")
    return next((STATUS_NAMES.get(value.value, "") for value in values if isinstance(value, Integer)), "")
