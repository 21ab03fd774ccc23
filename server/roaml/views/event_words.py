# SPDX-License-Identifier: Apache-2.0
"""Phrases, in the terms of ROS and BehaviorTree.CPP, for events of a translated system
(docs/spec/plain-scxml.md#events)."""

from __future__ import annotations

from collections.abc import Callable, Collection

from roaml.scxml.events import Role
from roaml.scxml.names import (
    TIMER_PREFIX,
    InterfaceEvent,
    InterfaceEventKind,
    TreeEventKind,
    cancel_request,
    client_of,
    entry_name,
    is_acceptance,
    is_blackboard_answer,
    is_blackboard_event,
    is_blackboard_request,
    is_timer,
    read_executes_goal,
    read_interface_event,
    read_tree_event,
    safe_name,
    written_entry,
)

_TREE_PHRASES = {
    TreeEventKind.TICK: "its tick",
    TreeEventKind.HALT: "its halt",
    TreeEventKind.RESPONSE: "the status of its tick",
    TreeEventKind.HALT_RESPONSE: "the end of its halt",
}
_PHRASES = {
    InterfaceEventKind.MESSAGE: "a message on the topic",
    InterfaceEventKind.REQUEST: "a request to the service",
    InterfaceEventKind.RESPONSE: "the response of the service",
    InterfaceEventKind.CANCEL: "a request to cancel a goal of the action",
    InterfaceEventKind.GOAL: "a goal of the action",
    InterfaceEventKind.GOAL_ANSWER: "the response to the goal of the action",
    InterfaceEventKind.FEEDBACK: "feedback of the action",
    InterfaceEventKind.RESULT: "the result of the action",
    InterfaceEventKind.THREAD_START: "the start of a thread of the action",
    InterfaceEventKind.THREAD_FREE: "the end of a thread of the action",
}


_SHORT_PHRASES = {
    InterfaceEventKind.MESSAGE: "",
    InterfaceEventKind.REQUEST: "a request to ",
    InterfaceEventKind.RESPONSE: "the response of ",
    InterfaceEventKind.CANCEL: "a request to cancel a goal of ",
    InterfaceEventKind.GOAL: "a goal of ",
    InterfaceEventKind.FEEDBACK: "feedback of ",
    InterfaceEventKind.RESULT: "the result of ",
    InterfaceEventKind.THREAD_START: "the start of a thread of ",
    InterfaceEventKind.THREAD_FREE: "the end of a thread of ",
}


def event_phrase(event: str, clients: Collection[str], role: Role = Role.MACHINE, taken: bool = False) -> str:
    """A phrase for an event.

    Args:
        clients: the names of the automata of the system; the name of an event may end with one of them.
        role: the role of the automaton that waits for the event, or receives it.
        taken: whether this automaton receives the tick of a timer, instead of waiting for the timer.
    """
    if is_timer(event):
        timer = event.removeprefix(TIMER_PREFIX)
        for user in clients:
            timer = timer.removesuffix(f"__{safe_name(user)}")
        if role is Role.TREE_ROOT:
            return "its next tick"
        return f"the tick of its timer `{timer}`" if taken else f"its timer `{timer}`"
    if is_blackboard_event(event):
        return "the blackboard"
    tree = read_tree_event(event)
    if tree is not None:
        return _TREE_PHRASES[tree.kind]
    interface = read_interface_event(event, clients)
    return f"the event `{event}`" if interface is None else f"{_PHRASES[interface.kind]} `{_ros_name(interface)}`"


def interface_phrase(event: str, clients: Collection[str]) -> str:
    """A short phrase for an event of a topic, service or action, such as `/level` or `a request to /adder`; "" for
    other events.

    Args:
        clients: the names of the automata of the system.
    """
    interface = read_interface_event(event, clients)
    if interface is None:
        return ""
    name = _ros_name(interface)
    if interface.kind is InterfaceEventKind.GOAL_ANSWER:
        answer = "acceptance" if is_acceptance(event, client_of(event, clients)) else "rejection"
        return f"the {answer} of a goal of {name}"
    return f"{_SHORT_PHRASES[interface.kind]}{name}"


def blackboard_phrase(event: str) -> str:
    """A short phrase for an event of the blackboard; "" for other events."""
    if entry := written_entry(event):
        return f"the blackboard entry {entry_name(entry)}"
    if is_blackboard_request(event):
        return "a request to the blackboard"
    return "the blackboard" if is_blackboard_answer(event) else ""


def interface_name(event: str, clients: Collection[str]) -> str:
    """The name of the topic, service or action of an event, with a leading `/`; "" if the event has none.

    Args:
        clients: the names of the automata of the system.
    """
    interface = read_interface_event(event, clients)
    return "" if interface is None else _ros_name(interface)


def goal_phrases(variables: Collection[str], is_event: Callable[[str], bool]) -> dict[str, str]:
    """Phrases for the variables that state which goals an automaton executes (docs/spec/plain-scxml.md#cancel).

    Args:
        variables: the names of all variables of the automaton.
        is_event: whether a name denotes an event of the system.

    Returns:
        Name of a variable -> its phrase.
    """
    phrases = {}
    for variable in variables:
        goal = read_executes_goal(variable)
        # The name with a further underscore is chosen if the machine has a variable of this name.
        if goal is not None and is_event(cancel_request(goal[0])) and f"{variable}_" not in variables:
            phrases[variable] = f"executes goal {goal[1]} of {_absolute(goal[0])}"
    return phrases


def _ros_name(interface: InterfaceEvent) -> str:
    return _absolute(interface.name)


def _absolute(name: str) -> str:
    return "/" + name.replace("__", "/")
