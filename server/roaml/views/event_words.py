# SPDX-License-Identifier: Apache-2.0
"""Phrases, in the terms of ROS and BehaviorTree.CPP, for events of a translated system
(docs/spec/plain-scxml.md#events)."""

from __future__ import annotations

import re
from collections.abc import Collection

from roaml.scxml.events import Role
from roaml.scxml.names import (
    BLACKBOARD_ANSWER,
    BLACKBOARD_REQUEST,
    BLACKBOARD_WRITE_PREFIX,
    CANCEL_PREFIX,
    TIMER_PREFIX,
    is_timer,
    safe_name,
)

_FORMS = (
    (r"bt_\d+_tick", "its tick"),
    (r"bt_\d+_halt", "its halt"),
    (r"bt_\d+_response", "the status of its tick"),
    (r"bt_\d+_halt_response", "the end of its halt"),
    (r"topic_(.+)_msg", "a message on the topic `/{}`"),
    (r"srv_(.+)_req(?:uest)?", "a request to the service `/{}`"),
    (r"srv_(.+)_response", "the response of the service `/{}`"),
    (rf"{CANCEL_PREFIX}(.+)", "a request to cancel a goal of the action `/{}`"),
    (r"action_(.+)_goal_(?:req|handle)", "a goal of the action `/{}`"),
    (r"action_(.+)_goal_(?:accept|accepted|reject|rejected)", "the response to the goal of the action `/{}`"),
    (r"action_(.+)_feedback(?:_handle)?", "feedback of the action `/{}`"),
    (r"action_(.+)_result(?:_handle)?", "the result of the action `/{}`"),
    (r"action_(.+)_thread_start", "the start of a thread of the action `/{}`"),
    (r"action_(.+)_thread_free", "the end of a thread of the action `/{}`"),
)
_COMPILED = tuple((re.compile(form), text) for form, text in _FORMS)


def said(event: str, clients: Collection[str], role: Role = Role.MACHINE, taken: bool = False) -> str:
    """A phrase for an event.

    Args:
        clients: the automata of the system; the name of an event may end with one of them.
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
    if event in (BLACKBOARD_REQUEST, BLACKBOARD_ANSWER) or event.startswith(BLACKBOARD_WRITE_PREFIX):
        return "the blackboard"
    text, interface = _form_of(event, clients)
    return text.format(interface.removeprefix("/")) if text else f"the event `{event}`"


def interface_name(event: str, clients: Collection[str]) -> str:
    """The name of the topic, service or action of an event, with a leading `/`; "" if the event has none.

    Args:
        clients: the automata of the system.
    """
    return _form_of(event, clients)[1]


def _form_of(event: str, clients: Collection[str]) -> tuple[str, str]:
    """The phrase for an event, and the name of its interface. Each is "" if there is none."""
    name, _, client = event.partition("_client_")
    if client not in clients:
        name = event
    for form, text in _COMPILED:
        match = form.fullmatch(name)
        if match:
            return text, "".join("/" + group.replace("__", "/") for group in match.groups())
    return "", ""
