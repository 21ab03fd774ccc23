# SPDX-License-Identifier: Apache-2.0
"""The rule `handler-without-effect`, which handler_without_effect.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.machine import Handler, State
from roaml.model.triggers import Trigger, trigger
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule

_DISCARDED = {
    ProtocolPart.MESSAGE: "messages of the topic",
    ProtocolPart.EVENT: "events",
}
"""What is discarded in a state without a handler, so that a handler without effect is useless."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report messages and events all of whose handlers do nothing."""
    if context.system is None:
        return
    handlers: dict[Trigger, list[tuple[State, Handler]]] = {}
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                key = trigger(context.machine, handler)
                if handler.effective and handler.trigger in _DISCARDED and key is not None:
                    handlers.setdefault(key, []).append((state, handler))
    if not any(
        _has_effect(state, h) for chart in context.machine.charts for state in chart.states for h in state.handlers
    ):
        return  # the machine represents the receivers of the messages
    for pairs in handlers.values():
        event = pairs[0][1].event
        is_observed = event is not None and context.system.is_observed(event.value)
        if not is_observed and not any(_has_effect(state, handler) for state, handler in pairs):
            handler = pairs[0][1]
            what = _DISCARDED[handler.trigger] if handler.trigger else ""
            message = f"the machine receives {what} and does nothing; use the data, or remove the handler"
            yield RULE.at(handler.element.name_span, message)


def _has_effect(state: State, handler: Handler) -> bool:
    if (state.entry and state.entry.statements) or (state.exit and state.exit.statements):
        return True
    return any(
        target.body or target.state is None or state.id is None or target.state.value != state.id.value
        for target in handler.targets
    )


RULE = Rule(
    "handler-without-effect",
    Severity.WARNING,
    "All handlers of an event or message do nothing.",
    machine=check,
    whole=True,
)
