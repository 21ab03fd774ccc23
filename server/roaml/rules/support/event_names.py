# SPDX-License-Identifier: Apache-2.0
"""Noun phrases for events of machines, in the terms of ROS and BehaviorTree.CPP, for messages."""

from __future__ import annotations

from roaml.model.behavior.instants import channel_of
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.system import System, SystemAutomaton
from roaml.roles import ProtocolPart

_WHAT = {
    ProtocolPart.RESPONSE: "the response of",
    ProtocolPart.GOAL_RESPONSE: "the decision on a goal for",
    ProtocolPart.RESULT: "the result of",
    ProtocolPart.FEEDBACK: "feedback of",
    ProtocolPart.MESSAGE: "a message on",
    ProtocolPart.REQUEST: "a request for",
    ProtocolPart.GOAL: "a goal for",
    ProtocolPart.CANCEL: "a request to cancel a goal of",
}


def channel_named(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> str:
    """The name of the topic, service or action of an event; if it is unknown, the name of the event."""
    channel = channel_of(system, automaton, event)
    return f"`{channel.name if channel else event.name}`"


def named(system: System, automaton: SystemAutomaton, event: ProtocolEvent) -> str:
    """A noun phrase for an event that an automaton receives or sends."""
    match event.part:
        case ProtocolPart.TICK:
            return f"the timer `{event.name}`"
        case ProtocolPart.EVENT:
            return f"the event `{event.name}`"
        case ProtocolPart.START:
            return f"the start of `{automaton.name}`"
        case ProtocolPart.BT_TICK | ProtocolPart.BT_HALT:
            return f"the next {event.part.value[3:]} of `{automaton.name}`"
        case ProtocolPart.THREAD_START:
            return "the start of a thread"
        case ProtocolPart.THREAD_FREE:
            return "a thread that becomes free"
    return f"{_WHAT.get(event.part, event.part.value)} {channel_named(system, automaton, event)}"
