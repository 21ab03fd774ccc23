# SPDX-License-Identifier: Apache-2.0
"""The rule `constant-message`, which constant_message.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.format import format_expr
from roaml.expr.tree import Boolean, Number
from roaml.expr.types import leaves
from roaml.model.machine import Declaration, RosSend
from roaml.model.syntax import Expression
from roaml.model.system import ChannelEndpoint
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.fields import sent_part
from roaml.rules.support.interfaces import channels_of


def check(context: MachineContext) -> Iterator[Finding]:
    """Report all places where a machine publishes the same Boolean or number on a topic, if there are several, a
    subscriber reads the value, and nothing else publishes on the topic. A Boolean is also reported if no machine
    subscribes to the topic: the two places are meant for a property, or for a machine that is not modelled."""
    if not context.automata:
        return
    for declaration, statements in _published(context).items():
        constants = [_constant(context, statement) for statement in statements]
        values = [constant for constant in constants if constant is not None]
        if len(statements) < 2 or len(values) < len(statements) or len({value.value for value in values}) > 1:
            continue
        channels = list(channels_of(context, declaration))
        users = [end for _, channel in channels for end in channel.users]
        if not any(end.use.reads for end in users) and (users or not isinstance(values[0], Boolean)):
            continue  # a signal, such as a heartbeat, whose receivers read no value
        if isinstance(values[0], Number) and not any(_distinguishes(end) for end in users):
            continue  # an amount or a position, with which receivers calculate
        if any(end.automaton is not own for own, channel in channels for end in channel.sources):
            continue  # the value differs from that of another publisher, as in the order of a monitor to stop
        for value in values:
            text = format_expr(value)
            message = f"all messages that this machine publishes on the topic are `{text}`, so receivers learn nothing"
            others = [Related(other.span, "also here") for other in values if other is not value]
            yield RULE.at(value.span, f"{message} from the value; change one of them", related=others)


def _distinguishes(end: ChannelEndpoint) -> bool:
    """Whether a subscriber compares a field of the messages with constants."""
    fields = (choice.field for choice in end.automaton.outline.choices)
    return any(field.part is ProtocolPart.MESSAGE and field.handle == end.use.handle for field in fields)


def _published(context: MachineContext) -> dict[Declaration, list[RosSend]]:
    """The publishers, with the elements that publish."""
    result: dict[Declaration, list[RosSend]] = {}
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, RosSend) and statement.part is ProtocolPart.MESSAGE:
                declaration = find_handle(context.machine, statement)
                if declaration is not None:
                    result.setdefault(declaration, []).append(statement)
    return result


def _constant(context: MachineContext, statement: RosSend) -> Boolean | Number | None:
    """The constant that is sent, if the message has one field, which is a Boolean or a number."""
    part = sent_part(context, statement)
    fields = list(leaves(part)) if part is not None else []
    if len(fields) != 1 or len(statement.fields) != 1:
        return None
    value = statement.fields[0].value
    return value.tree if isinstance(value, Expression) and isinstance(value.tree, Boolean | Number) else None


RULE = Rule(
    "constant-message",
    Severity.WARNING,
    "All messages that a machine publishes on a topic contain the same constant.",
    machine=check,
    whole=True,
)
