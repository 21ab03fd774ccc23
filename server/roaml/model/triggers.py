# SPDX-License-Identifier: Apache-2.0
"""The triggers of handlers: handlers of a state with equal triggers are tested in order for the same event."""

from __future__ import annotations

from typing import TypeAlias

from roaml.model.machine import Handler, Machine
from roaml.model.syntax import Name
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.scxml.names import sanitise

Trigger: TypeAlias = "tuple[ProtocolPart | None, str, int]"
"""The part of the protocol that is received; the name of its topic, handle, event or child, or ""; and the result code
of an action, or 0. Triggers can be compared within a state."""


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
