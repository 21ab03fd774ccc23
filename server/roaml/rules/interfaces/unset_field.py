# SPDX-License-Identifier: Apache-2.0
"""The rule `unset-field`, which unset_field.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.tree import Member, access_path, walk
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import Handler
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Expression
from roaml.model.system import Channel
from roaml.model.value_types import INTERFACE_KINDS, find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.event_data import known_here
from roaml.rules.support.interfaces import channels_of, other_kind

PREFIXES = {"_msg": 1, "_req": 1, "_res": 1, "_goal": 1, "_feedback": 1, "_wrapped_result": 2}


def check(context: MachineContext) -> Iterator[Finding]:
    """Report fields that are read and never set. Only fields that need not be set are checked: the reference translator
    omits these fields, so they are empty."""
    if context.system is None:
        return
    for value in context.typed.values:
        handler = value.place.handler
        if handler is None or not isinstance(value.value, Expression):
            continue
        prefixes = PREFIXES.keys() & known_here(value.place)
        for node in walk(value.value.tree) if prefixes else ():
            path = access_path(node) if isinstance(node, Member) else None
            if isinstance(node, Member) and path is not None and path[0] in prefixes:
                yield from _check(context, handler, node, ".".join(path[PREFIXES[path[0]] :]))


def _check(context: MachineContext, handler: Handler, node: Member, field: str) -> Iterator[Finding]:
    declaration = find_handle(context.machine, handler)
    if (
        context.system is None
        or declaration is None
        or declaration.type is None
        or declaration.kind not in INTERFACE_KINDS
    ):
        return
    interface = context.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)
    part = ProtocolPart.GOAL if handler.trigger is ProtocolPart.THREAD_START else handler.trigger
    if part is None or not isinstance(interface, InterfaceType):
        return
    if field not in dict(interface.optional).get(part.value, frozenset()):
        return
    for _, channel in channels_of(context, declaration):
        unread = context.system.may(InterfaceAct(other_kind(declaration.kind), part, True), channel.name)
        if not unread and not any(field in sent for sent in _sent(channel, part)):
            yield RULE.at(
                node.name_span,
                (
                    f"no machine sets the field `{field}` of `{channel.name}`, so the field is always empty; set it in "
                    "the sending element"
                ),
            )
            return


def _sent(channel: Channel, part: ProtocolPart) -> Iterator[set[str]]:
    for endpoint in channel.endpoints:
        yield {field.name for field in dict(endpoint.use.fields).get(part, ())}


RULE = Rule("unset-field", Severity.WARNING, "No machine sets a field that is read.", machine=check)
