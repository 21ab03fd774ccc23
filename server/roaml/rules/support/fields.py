# SPDX-License-Identifier: Apache-2.0
"""Fields of messages, requests, responses, goals, feedback and results."""

from __future__ import annotations

from roaml.expr.types import Struct, StructKind
from roaml.model.machine import Declaration, RosSend
from roaml.model.ros import InterfaceType
from roaml.model.value_types import INTERFACE_KINDS, find_handle, section_of
from roaml.rules.rule import MachineContext


def is_ros(struct: Struct) -> bool:
    """Whether a struct is a ROS message or a part of a service or action."""
    return struct.kind is StructKind.ROS


def sent_part(context: MachineContext, statement: RosSend) -> Struct | None:
    """The fields that a sending element may set, as a struct, which is empty for elements that send no fields; `None`
    if the declaration or the type of the interface is unknown."""
    declaration = find_handle(context.machine, statement)
    return part_of(context, declaration, statement) if declaration is not None else None


def part_of(context: MachineContext, declaration: Declaration, statement: RosSend) -> Struct | None:
    """The same as `sent_part`, if the element named `declaration`."""
    if declaration.type is None or declaration.kind not in INTERFACE_KINDS:
        return None
    interface_type = context.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)
    if not isinstance(interface_type, InterfaceType):
        return None
    part = dict(interface_type.parts).get(section_of(statement.part))
    # Some elements send no fields at all: decisions on goals, and results other than success.
    return part if "field" in statement.type.children else Struct(interface_type.name, ())
