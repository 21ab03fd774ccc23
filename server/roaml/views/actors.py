# SPDX-License-Identifier: Apache-2.0
"""The automata of a translated system, named in the terms of ROS and BehaviorTree.CPP."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping

from roaml.exhaustive import assert_never
from roaml.jani.model import Automaton, Model
from roaml.regex import regex
from roaml.scxml.events import Role
from roaml.scxml.names import (
    ACTION_HANDLER_PREFIX,
    BLACKBOARD,
    CONDITIONS_PREFIX,
    NODE_AUTOMATON,
    SERVICE_HANDLER_PREFIX,
    TIMER_PREFIX,
    TREE_ROOT_PREFIX,
    TreeEventKind,
    automaton_role,
    client_of,
    is_observer,
    is_timer,
    prefix_of_observer,
    read_tree_event,
    safe_name,
)
from roaml.views.ends import is_event, is_translation
from roaml.views.event_words import blackboard_phrase, event_phrase, interface_phrase

_CONDITIONS = regex(CONDITIONS_PREFIX + r"(\d+)(?:_inner\d*)?_(.+)")
_TREE_EVENTS = {
    TreeEventKind.TICK: "the tick of",
    TreeEventKind.HALT: "the halt of",
    TreeEventKind.RESPONSE: "the status of",
    TreeEventKind.HALT_RESPONSE: "the end of the halt of",
}


def names_of(automata: Iterable[Automaton]) -> dict[str, str]:
    """The name of each automaton -> its name for users.

    A node of the tree has the name of its type if no other automaton has it, such as `Wait`, otherwise its number as
    well: `Wait (bt_1003)`. An action thread has the name of its machine and its number, such as `server, goal thread
    0`.
    """
    automata = list(automata)
    machines = [automaton.thread_of or automaton.name for automaton in automata]
    types = Counter(_type_of(machine) for machine in dict.fromkeys(machines))
    return {
        automaton.name: _machine_name(machine, types) + (f", {automaton.thread}" if automaton.thread_of else "")
        for automaton, machine in zip(automata, machines, strict=True)
    }


def _type_of(machine: str) -> str:
    node = NODE_AUTOMATON.fullmatch(machine)
    return node[2] if node else machine


def _machine_name(machine: str, types: Mapping[str, int]) -> str:
    if conditions := _CONDITIONS.fullmatch(machine):
        return f"the conditions of {_node_name(conditions[1], conditions[2], types)}"
    node = NODE_AUTOMATON.fullmatch(machine)
    return _node_name(node[1], node[2], types) if node else machine


def _node_name(number: str, type_: str, types: Mapping[str, int]) -> str:
    return type_ if types[type_] == 1 else f"{type_} (bt_{number})"


def actors_of(automata: Iterable[Automaton]) -> dict[str, str]:
    """The name of each automaton -> a phrase for it, without backquotes around the name of a machine or node. Automata
    that buffer an event have no phrase of their own, only their name."""
    names = names_of(automata)
    return {automaton: _actor(automaton, name, names) for automaton, name in names.items()}


def _actor(automaton: str, name: str, automata: Collection[str]) -> str:
    role = automaton_role(automaton)
    match role:
        case Role.MACHINE:
            return name
        case Role.TREE_ROOT:
            return tree_phrase(automaton, automata)
        case Role.CLOCK:
            return "the clock"
        case Role.BLACKBOARD:
            tree = automaton.removeprefix(BLACKBOARD).removeprefix("_")
            return f"the blackboard of {tree}" if tree else "the blackboard"
        case Role.HANDLER:
            is_service = automaton.startswith(SERVICE_HANDLER_PREFIX)
            what, prefix = ("service", SERVICE_HANDLER_PREFIX) if is_service else ("action", ACTION_HANDLER_PREFIX)
            return f"the {what} `/{automaton.removeprefix(prefix).replace('__', '/')}`"
        case _:
            return assert_never(role)


def tree_phrase(root: str, automata: Iterable[str]) -> str:
    """A phrase for the tree whose root is the automaton `root`: `the tree`, with its name if there are several trees.

    Args:
        automata: the names of all automata.
    """
    alone = sum(name.startswith(TREE_ROOT_PREFIX) for name in automata) < 2
    return "the tree" if alone else f"the tree {root.removeprefix(TREE_ROOT_PREFIX)}"


def actors(model: Model) -> Mapping[str, str]:
    """Automaton -> a noun phrase for its part in the system, in the terms of users. Automata of a model that is not a
    translation are left out, except observers."""
    if not is_translation(model):
        return dict(_observers(model))
    return {**dict(_parts(model)), **dict(_observers(model))}


def _observers(model: Model) -> Iterator[tuple[str, str]]:
    """The observers of properties. The observer of an assumption, to which no property belongs, has its name."""
    properties = {property_.origin: property_.name for property_ in reversed(model.properties)}
    for automaton in model.automata:
        if is_observer(automaton.name) and (automaton.origin in properties or is_translation(model)):
            own = prefix_of_observer(automaton.name)
            observed = own if automaton.origin is None else properties.get(automaton.origin, own)
            yield automaton.name, f"what the property `{observed}` observes"


def _parts(model: Model) -> Iterator[tuple[str, str]]:
    names = names_of(model.automata)
    for automaton in model.automata:
        name = automaton.name
        if is_observer(name):
            continue
        if is_event(automaton):
            yield name, event_subject(name, names)
        elif _CONDITIONS.fullmatch(name):
            yield name, names[name]
        elif automaton_role(name) is Role.MACHINE and not NODE_AUTOMATON.fullmatch(name):
            yield name, f"`{names[name]}`"
        else:
            yield name, _actor(name, names[name], names)


def message_phrase(event: str, automata: Mapping[str, str]) -> str:
    """A short phrase for an event that an automaton sends or receives, such as `/battery` for a message on this topic,
    `a request to /adder`, or the name of a plain event.

    Args:
        automata: the names of all automata, with their names for users.
    """
    if is_timer(event):
        return event_phrase(event, automata, taken=True)
    if read_tree_event(event) is not None:
        return event_subject(event, automata)
    return interface_phrase(event, automata) or blackboard_phrase(event) or event


def event_subject(event: str, automata: Mapping[str, str]) -> str:
    """A noun phrase for an event, such as ``a message on the topic `/battery` ``.

    Args:
        automata: the names of all automata, with their names for users.
    """
    tree = read_tree_event(event)
    if tree is not None:
        number = str(tree.number)
        nodes = (node for name in automata if (node := NODE_AUTOMATON.fullmatch(name)) and node[1] == number)
        return f"{_TREE_EVENTS[tree.kind]} {next((automata[node[0]] for node in nodes), f'bt_{number}')}"
    if not is_timer(event):
        client = client_of(event, automata)
        return event_phrase(event, automata) + (f" at {automata[client]}" if client else "")
    timer = event.removeprefix(TIMER_PREFIX)
    for user, name in automata.items():
        if timer.endswith(f"__{safe_name(user)}"):
            if user.startswith(TREE_ROOT_PREFIX):
                return f"the next tick of {tree_phrase(user, automata)}"
            return f"the timer `{timer.removesuffix(f'__{safe_name(user)}')}` of {name}"
    return f"the timer `{timer}`"
