# SPDX-License-Identifier: Apache-2.0
"""Finds handlers with equal triggers, and those that have no effect because of their conditions."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.machine import Chart, Handler, Machine, State
from roaml.model.triggers import Trigger, chooses, trigger
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.support.conditions import covered


def awaited(state: State) -> tuple[str, ...]:
    """The names of the events and handles that the handlers of a state wait for; of a handler with neither, the name of
    its element."""
    waiting = [handler for handler in state.handlers if handler.effective and handler.trigger is not None]
    names = [(handler.event or handler.handle, handler.element) for handler in waiting]
    return tuple(dict.fromkeys(name.value if name else element.name for name, element in names))


def conditional(machine: Machine, state: State) -> Iterator[list[Handler]]:
    """The handlers of a state that have conditions, grouped by trigger; only groups of at least two handlers."""
    groups: dict[Trigger, list[Handler]] = {}
    for handler in state.handlers:
        key = trigger(machine, handler)
        if key is not None and handler.effective and handler.cond is not None and not chooses(handler):
            groups.setdefault(key, []).append(handler)
    return (handlers for handlers in groups.values() if len(handlers) > 1)


def has_shadowed(machine: Machine, chart: Chart, handler: Handler) -> bool:
    """Whether a handler with the same trigger in the state of `handler` has a condition that has no effect because of
    earlier conditions (shadowed-transition)."""
    state = next((state for state in chart.states if handler in state.handlers), None)
    groups = conditional(machine, state) if state is not None else ()
    return any(
        any(covered(condition_facts(chart), [earlier.cond for earlier in handlers]))
        for handlers in groups
        if handler in handlers
    )


def received_event(machine: Machine, handler: Handler) -> ProtocolEvent | None:
    """The event or message that a handler receives; `None` if its name is missing."""
    if handler.trigger is ProtocolPart.EVENT:
        return ProtocolEvent(ProtocolPart.EVENT, handler.event.value) if handler.event else None
    declaration = find_handle(machine, handler)
    if declaration is None or declaration.handle is None:
        return None
    return ProtocolEvent(ProtocolPart.MESSAGE, declaration.handle.value)
