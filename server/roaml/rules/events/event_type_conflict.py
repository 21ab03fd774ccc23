# SPDX-License-Identifier: Apache-2.0
"""The rule `event-type-conflict`, which event_type_conflict.md describes."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.expr.types import EmptyArray, ScalarKind, Struct, Type, Unknown, is_kind, leaves, same_kind, unwrap
from roaml.model.machine import Declaration, Param, RosSend, Send
from roaml.model.outline import SentField
from roaml.model.system import PlainEvent
from roaml.model.value_types import TypedValue, ValueUse, find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import channels_of
from roaml.rules.support.types import phrase

ROUND = "; a number like `2.0` becomes an integer when it is sent; store it in a variable of a float type"


def check(context: MachineContext) -> Iterator[Finding]:
    values = {
        value.element: value for value in context.typed.values if value.use in (ValueUse.PARAMETER, ValueUse.FIELD)
    }
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, Send) and statement.event and context.system:
                event = context.system.events.get(statement.event.value)
                for param in statement.params if event else ():
                    if event is not None and param.element in values:
                        yield from _parameter(event, param, values[param.element])
    for (declaration, _), fields in _sent_fields(context).items():
        sent = [(field.name.value, values[field.element]) for field in fields if field.name and field.element in values]
        yield from _fields(sent, _real_elsewhere(context, declaration))


def _parameter(event: PlainEvent, param: Param, value: TypedValue) -> Iterator[Finding]:
    """Report parameters that have different types in two senders of an event; the types must be equal
    (docs/spec/machines.md#send)."""
    if param.name is None:
        return
    for automaton, sent in event.senders:
        for other in sent.params:
            for name, mine, theirs in _differing(param.name.value, value.sent, other):
                there = phrase(theirs)
                hint = ROUND if value.type != value.sent and same_kind(value.type, theirs) else "; use the same type"
                yield RULE.at(
                    value.value.span,
                    f"`{name}` is {phrase(mine)} here, but {there} in another `<send>` of `{event.name}`{hint}",
                    related=(Related(Symbol(automaton.path, SymbolKind.EVENT, event.name), f"sent as {there}"),),
                )
                return


def _differing(name: str, type_: Type, other: SentField) -> Iterator[tuple[str, Type, Type]]:
    """The parameters for which two senders differ: their names, and their types in the two senders."""
    if flat(name) == flat(other.name) and _is_struct(type_) is not _is_struct(other.type):
        if not isinstance(type_, (Unknown, EmptyArray)) and not isinstance(other.type, (Unknown, EmptyArray)):
            yield name, type_, other.type
        return
    theirs = flattened(other.name, other.type)
    for leaf, mine in flattened(name, type_).items():
        if leaf in theirs and not same_kind(mine, theirs[leaf]):
            yield leaf, mine, theirs[leaf]


def _is_struct(type_: Type) -> bool:
    return isinstance(unwrap(type_)[0], Struct)


def flat(name: str) -> str:
    return name.replace(".", "__")


def flattened(name: str, type_: Type) -> dict[str, Type]:
    """The leaves of a parameter, by name, with their types: the translation has one parameter for each leaf of a struct
    (docs/spec/types.md#leaves)."""
    return {"__".join((flat(name), *path)): leaf for path, leaf in leaves(type_)}


# ------------------------------------------------------------------ ROS fields


def _sent_fields(context: MachineContext) -> dict[tuple[Declaration, ProtocolPart], list[Param]]:
    """The fields that the machine sends, grouped by declaration and part of the interface."""
    sent_fields: defaultdict[tuple[Declaration, ProtocolPart], list[Param]] = defaultdict(list)
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, RosSend) and (declaration := find_handle(context.machine, statement)):
                sent_fields[declaration, statement.part] += statement.fields
    return sent_fields


def _fields(sent: list[tuple[str, TypedValue]], real_elsewhere: set[str]) -> Iterator[Finding]:
    """Report real fields that are set to an integer here and to a real number elsewhere. The reference translator gives
    a field the type of its value (docs/spec/expressions.md#whole-reals)."""
    real = {name for name, value in sent if is_kind(value.sent, ScalarKind.REAL)} | real_elsewhere
    for name, value in sent:
        if (
            name in real
            and is_kind(value.sent, ScalarKind.INT)
            and value.required
            and is_kind(value.required, ScalarKind.REAL)
        ):
            hint = ROUND if is_kind(value.type, ScalarKind.REAL) else ""
            message = f"`{name}` is an integer here, but a real number where it is sent elsewhere{hint}"
            yield RULE.at(value.value.span, message, severity=Severity.INFORMATION)


def _real_elsewhere(context: MachineContext, declaration: Declaration) -> set[str]:
    """The fields that publishers or servers in other machines send as real numbers, for the topic, service or action of
    `declaration`."""
    return {
        field.name
        for automaton, topic in channels_of(context, declaration)
        for endpoint in topic.sources
        if endpoint.automaton.path != automaton.path
        for _, fields in endpoint.use.fields
        for field in fields
        if is_kind(field.type, ScalarKind.REAL)
    }


RULE = Rule(
    "event-type-conflict",
    Severity.ERROR,
    "Senders of an event use different types for a parameter.",
    machine=check,
    whole=True,
)
