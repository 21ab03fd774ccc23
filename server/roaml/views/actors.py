# SPDX-License-Identifier: Apache-2.0
"""The automata of a translated system, named in the terms of ROS and BehaviorTree.CPP."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.exhaustive import assert_never
from roaml.jani.model import Automaton, Model
from roaml.regex import regex
from roaml.scxml.events import Role
from roaml.scxml.names import (
    ACTION_HANDLER_PREFIX,
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


def name_of(automaton: Automaton) -> str:
    """The name of an automaton for users; for a node of the tree, its name and number, such as `Wait (bt_1003)`; for an
    action thread, the name of its machine and its number, such as `server, goal thread 0`."""
    if automaton.thread_of:
        return f"{_machine_name(automaton.thread_of)}, {automaton.thread}"
    return _machine_name(automaton.name)


def names_of(automata: Iterable[Automaton]) -> dict[str, str]:
    """The name of an automaton -> its name for users (`name_of`)."""
    return {automaton.name: name_of(automaton) for automaton in automata}


def _machine_name(automaton: str) -> str:
    if conditions := _CONDITIONS.fullmatch(automaton):
        return f"the conditions of {conditions[2]} (bt_{conditions[1]})"
    node = NODE_AUTOMATON.fullmatch(automaton)
    return f"{node[2]} (bt_{node[1]})" if node else automaton


def actor(automaton: Automaton) -> str:
    """A phrase for an automaton that does not buffer an event, without backquotes around the name of a machine or
    node."""
    name = automaton.name
    role = automaton_role(name)
    match role:
        case Role.MACHINE:
            return name_of(automaton)
        case Role.TREE_ROOT:
            return "the tree"
        case Role.CLOCK:
            return "the clock"
        case Role.BLACKBOARD:
            return "the blackboard"
        case Role.HANDLER:
            is_service = name.startswith(SERVICE_HANDLER_PREFIX)
            what, prefix = ("service", SERVICE_HANDLER_PREFIX) if is_service else ("action", ACTION_HANDLER_PREFIX)
            return f"the {what} `/{name.removeprefix(prefix).replace('__', '/')}`"
        case _:
            return assert_never(role)


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
            yield name, actor(automaton)


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
                return "the next tick of the tree"
            return f"the timer `{timer.removesuffix(f'__{safe_name(user)}')}` of {name}"
    return f"the timer `{timer}`"
