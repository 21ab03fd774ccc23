# SPDX-License-Identifier: Apache-2.0
"""The rule `event-never-sent`, which event_never_sent.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import remove
from roaml.interfaces.registry import NotFound
from roaml.model.gaps import GapAct
from roaml.model.globals import event_names
from roaml.model.machine import Handler
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Name
from roaml.model.system import System
from roaml.model.system_file import SystemSection
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.scxml.names import TIMER_PREFIX, flag_of

OF_THE_TREE = ("bt_tick", "bt_halt")
"""Events that ticked and halted plugins in an older version of the language; removed-bt-event reports them."""


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    unsent = tuple(_unsent(context, system))
    if not unsent:
        return
    generated = _generated(context, system)
    sent = [event.name for event in system.events.values() if event.senders]
    for event, handler in unsent:
        unread = system.may(GapAct.SENDS, event.value) or system.may_have_variable(flag_of(event.value))
        if not unread and event.value not in generated:
            close = close_names(event.value, sent)
            message = (
                f"no machine sends the event `{event.value}`, so this transition is never taken{did_you_mean(close)}"
            )
            drop = remove(context.document, handler.element, "Remove this transition")
            yield RULE.at(event.span, message, *replacements(event.span, close), drop)


def _unsent(context: MachineContext, system: System) -> Iterator[tuple[Name, Handler]]:
    """The events of transitions that no machine sends, each with its transition. Wildcards, lists of events, and in
    plugins the events in `OF_THE_TREE`, are left out, because other rules report them."""
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                event = handler.event
                if handler.trigger is not ProtocolPart.EVENT or event is None:
                    continue
                if event.value in OF_THE_TREE and context.listed_as != {SystemSection.NODE_MODELS}:
                    continue
                if "*" in event.value or len(event.value.split()) > 1:
                    continue
                known = system.events.get(event.value)
                if known is None or not known.senders:
                    yield event, handler


def _generated(context: MachineContext, system: System) -> frozenset[str]:
    """The events that the translation generates for ROS elements, timers and the tree (docs/spec/plain-scxml.md)."""
    timers = (f"{TIMER_PREFIX}{timer.name}" for a in system.automata for timer in a.outline.timers)

    def interface(kind: str, name: str) -> InterfaceType | None:
        interface_type = context.interface(kind, name)
        return None if isinstance(interface_type, NotFound) else interface_type

    return event_names(system, interface).union(timers)


RULE = Rule(
    "event-never-sent",
    Severity.ERROR,
    "No machine sends an event that a transition waits for.",
    machine=check,
    whole=True,
)
