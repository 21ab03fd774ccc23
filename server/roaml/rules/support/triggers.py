# SPDX-License-Identifier: Apache-2.0
"""Compares the triggers of handlers: handlers of a state with equal triggers are tested in order for the same event."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from roaml.model.behavior.explore import condition_facts
from roaml.model.machine import Chart, Handler, Machine, State
from roaml.model.syntax import Name
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.support.conditions import covered
from roaml.scxml.names import sanitise

Trigger: TypeAlias = "tuple[ProtocolPart | None, str, int]"
"""The part of the protocol that is received; the name of its topic, handle, event or child, or ""; and the result code
of an action, or 0. Triggers can be compared within a state."""


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


def trigger(machine: Machine, handler: Handler) -> Trigger | None:
    """The trigger of a handler, which can be compared with others of its state; `None` if a name that it needs is
    missing.

    Two handles of one topic wait for the same message; results with different codes are different triggers.
    """
    attributes, code = handler.type.attributes, handler.type.code
    if "name" in attributes:
        declaration = find_handle(machine, handler)
        if (
            handler.trigger is ProtocolPart.MESSAGE
            and declaration is not None
            and isinstance(declaration.interface, Name)
        ):
            return (handler.trigger, sanitise(declaration.interface.value), code)
        return (handler.trigger, handler.handle.value, code) if handler.handle else None
    if handler.trigger is ProtocolPart.EVENT:
        return (handler.trigger, handler.event.value, code) if handler.event else None
    if "id" in attributes:
        return (handler.trigger, handler.child.value, code) if handler.child else None
    return (handler.trigger, "", code)


def chooses(handler: Handler) -> bool:
    """Whether the child index of a handler is in a variable. The trigger is then also a condition on the variable."""
    return handler.child is not None and not handler.child.value.isdigit()
