# SPDX-License-Identifier: Apache-2.0
"""The rule `blocking-event-name`, which blocking_event_name.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.machine import Declaration, Handler, Machine, RosSend, Send
from roaml.model.syntax import Name
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.scxml.names import action_stem, is_synchronising


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, Send) and statement.event and is_synchronising(statement.event.value):
                message = (
                    f"the event `{statement.event.value}` is never discarded: because of its name, it waits until "
                    "every receiver handles it; choose another name"
                )
                yield RULE.at(statement.event.span, message)
    for declaration in _with_feedback(context.machine):
        name = declaration.interface
        if isinstance(name, Name) and is_synchronising(f"{action_stem(name.value)}_feedback"):
            message = (
                f"feedback of the action `{name.value}` is never discarded: because of the name of the action, it "
                "waits until it is handled; choose another name"
            )
            yield RULE.at(name.span, message)


def _with_feedback(machine: Machine) -> Iterator[Declaration]:
    """The declarations of actions whose feedback the machine sends or handles."""
    users: list[RosSend | Handler] = []
    for chart in machine.charts:
        users += [s for s in chart.statements if isinstance(s, RosSend) and s.type.sends is ProtocolPart.FEEDBACK]
        users += [h for state in chart.states for h in state.handlers if h.trigger is ProtocolPart.FEEDBACK]
    used = [find_handle(machine, user) for user in users]
    return (declaration for declaration in machine.declarations if declaration in used)


RULE = Rule(
    "blocking-event-name",
    Severity.HINT,
    "An event waits for its receivers because of its name.",
    machine=check,
)
