# SPDX-License-Identifier: Apache-2.0
"""What can arrive at a machine, and at the ports of a property file: the values that all senders of the system send, or
those of the types."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeAlias

from roaml.expr.parse import parse
from roaml.interfaces.registry import NotFound
from roaml.model.expand import Instance, PortConstant
from roaml.model.machine import Declaration, Machine, Port
from roaml.model.node_effects import statuses
from roaml.model.property_file import ObservedPart, PortKind, PortVariableKind
from roaml.model.property_links import LinkedFile
from roaml.model.property_ports import LinkedPort, LinkedVariable
from roaml.model.ros import InterfaceType
from roaml.model.system import Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.model.tree_paths import nodes_called
from roaml.model.value_types import INTERFACE_KINDS, section_of
from roaml.model.values.analyse import (
    RESULT_CODE,
    Arriving,
    DataChannel,
    Fields,
    Sent,
    merged,
    values_by_type,
)
from roaml.model.values.domain import ANYTHING, ValueSet, exactly, join, joined, listed
from roaml.model.values.evaluate import literal
from roaml.roles import ProtocolPart, SymbolKind
from roaml.scxml.names import sanitise
from roaml.text import Decoded

FindInterface: TypeAlias = "Callable[[str, str], InterfaceType | NotFound]"

_RECEIVED: Mapping[SymbolKind, tuple[ProtocolPart, ...]] = {
    SymbolKind.SUBSCRIBER: (ProtocolPart.MESSAGE,),
    SymbolKind.SERVICE_SERVER: (ProtocolPart.REQUEST,),
    SymbolKind.SERVICE_CLIENT: (ProtocolPart.RESPONSE,),
    SymbolKind.ACTION_SERVER: (ProtocolPart.GOAL, ProtocolPart.THREAD_START),
    SymbolKind.ACTION_CLIENT: (ProtocolPart.FEEDBACK, ProtocolPart.RESULT),
}
_FROM_USERS = (ProtocolPart.REQUEST, ProtocolPart.GOAL)
"""The parts that clients send; servers and publishers send the others."""
_OBSERVED_AT_SOURCES = {
    ObservedPart.PUBLISH: ProtocolPart.MESSAGE,
    ObservedPart.RESPONSE: ProtocolPart.RESPONSE,
    ObservedPart.FEEDBACK: ProtocolPart.FEEDBACK,
    ObservedPart.RESULT: ProtocolPart.RESULT,
}
_OBSERVED_AT_USERS = {ObservedPart.REQUEST: ProtocolPart.REQUEST, ObservedPart.GOAL_REQUEST: ProtocolPart.GOAL}


def arriving_by_type(machine: Machine, interface: FindInterface) -> Arriving:
    """What can arrive at a machine if nothing is known about the senders: all values of the types of the fields."""
    return {channel: _of_interface(declaration, channel.part, interface) for declaration, channel in _channels(machine)}


def arriving(
    machine: Machine, path: str, system: System, sent: Mapping[str, Sent | None], interface: FindInterface
) -> Arriving:
    """What can arrive at the machine in the file `path`. `system` must be complete.

    Args:
        sent: path of a machine -> what it sends; `None` if this is not known.
    """
    automata = system.automata_of(path)
    result = dict(arriving_by_type(machine, interface))
    for declaration, channel in _channels(machine):
        fields = _from(_senders(system, automata, declaration.kind, channel), sent)
        result[channel] = {**result[channel], **(fields or {})}
    for name in {h.event.value for c in machine.charts for s in c.states for h in s.handlers if h.event}:
        event, channel = system.events.get(name), DataChannel(ProtocolPart.EVENT, name)
        if event is not None:
            fields = _from(dict.fromkeys((automaton.path, channel) for automaton, _ in event.senders), sent)
            if fields:
                result[channel] = fields
    for port in machine.ports:
        if port.key is not None and automata:
            values = joined(_constant(automaton, port) for automaton in automata)
            if values != ANYTHING:
                result[DataChannel(ProtocolPart.BLACKBOARD, port.key.value)] = {"": values}
    return result


def observed_values(file: LinkedFile, system: System, sent: Mapping[str, Sent | None]) -> dict[str, ValueSet]:
    """Variable of a port -> the values that it can have. Variables about which nothing is known are left out.

    Args:
        sent: path of a machine of the complete `system` -> what it sends; `None` if this is not known.
    """
    known: dict[str, ValueSet] = {}
    for port in file.ports:
        for variable in port.variables:
            initial = variable.written.initial
            if initial is None or variable.kind in (PortVariableKind.EVENT, PortVariableKind.GOAL_ID):
                continue
            possible = _observed(port, variable, system, sent)
            if possible is not None:
                possible = join(dict(literal("", initial.tree)).get("", ANYTHING), possible)
                if possible != ANYTHING:
                    known[variable.id] = possible
    return known


def _observed(
    port: LinkedPort, variable: LinkedVariable, system: System, sent: Mapping[str, Sent | None]
) -> ValueSet | None:
    """The values that the events of a port give one of its variables; `None` if nothing is known about them."""
    name = variable.written.field
    field = RESULT_CODE if variable.kind is PortVariableKind.RESULT_CODE else name.value if name is not None else None
    if field is None:
        return None
    if port.written.kind is PortKind.NODE:
        instance = _observed_node(port, system)
        return listed(statuses(system, instance)) if instance is not None and field == "status" else None
    messages = list(_messages(port, system))
    return joined(_sent(field, channel, sent.get(path)) for path, channel in messages) if messages else None


def _observed_node(port: LinkedPort, system: System) -> Instance | None:
    nodes = nodes_called(system, port.written.name.value) if port.written.name is not None else ()
    return nodes[0] if len(nodes) == 1 else None


def _channels(machine: Machine) -> Iterator[tuple[Declaration, DataChannel]]:
    for declaration in machine.declarations:
        for part in _RECEIVED.get(declaration.kind, ()):
            yield declaration, DataChannel(part, declaration.handle.value if declaration.handle else "")


def _of_interface(declaration: Declaration, part: ProtocolPart, interface: FindInterface) -> Fields:
    type_ = interface(INTERFACE_KINDS[declaration.kind], declaration.type.value) if declaration.type else None
    if not isinstance(type_, InterfaceType):
        return {}
    struct = dict(type_.parts).get(section_of(part))
    return dict(values_by_type(struct, "")) if struct is not None else {}


def _senders(
    system: System, automata: Iterable[SystemAutomaton], kind: SymbolKind, channel: DataChannel
) -> Iterable[tuple[str, DataChannel]]:
    """The paths of the machines that may send what arrives through `channel`, each with its own channel."""
    senders: dict[tuple[str, DataChannel], None] = {}
    for automaton in automata:
        if channel.part is ProtocolPart.THREAD_START:
            senders[automaton.path, channel] = None
            continue
        use = automaton.outline.use(kind, channel.name)
        connection = system.channel(automaton, use) if use is not None else None
        endpoints: list[ChannelEndpoint] = []
        if connection is not None:
            endpoints = connection.users if channel.part in _FROM_USERS else connection.sources
        for endpoint in endpoints:
            senders[endpoint.automaton.path, DataChannel(channel.part, endpoint.use.handle)] = None
    return senders


def _from(senders: Iterable[tuple[str, DataChannel]], sent: Mapping[str, Sent | None]) -> Fields | None:
    """The fields that the senders send; `None` if nothing is sent, or if a sender is not known."""
    result: Fields | None = None
    for path, channel in senders:
        messages = sent.get(path)
        if messages is None:
            return None
        fields = messages.get(channel)
        if fields is not None:
            result = fields if result is None else merged(result, fields)
    return result


def _constant(automaton: SystemAutomaton, port: Port) -> ValueSet:
    """The constant to which a port is set; `ANYTHING` if it is not set to a constant."""
    value = automaton.port(port.key.value) if port.key else None
    if not isinstance(value, PortConstant) or port.type is None:
        return ANYTHING
    if port.type.text == "string":
        return exactly(value.text)
    tree, findings = parse(Decoded(value.text.strip(), 0))
    return dict(literal("", tree)).get("", ANYTHING) if not findings else ANYTHING


# ------------------------------------------------------------- property files


def _messages(port: LinkedPort, system: System) -> Iterator[tuple[str, DataChannel]]:
    """The paths of the machines that send what a port observes, each with its channel."""
    written = port.written
    if written.kind is PortKind.PLAIN:
        event = system.events.get(written.name.value) if written.name is not None else None
        for automaton, _ in event.senders if event is not None else ():
            yield automaton.path, DataChannel(ProtocolPart.EVENT, written.name.value if written.name else "")
        return
    channel = _observed_channel(port, system)
    if channel is None or written.part is None:
        return
    users = _OBSERVED_AT_USERS.get(written.part)
    part = users or _OBSERVED_AT_SOURCES.get(written.part)
    for endpoint in channel.users if users else channel.sources:
        if part is not None and part in endpoint.use.sends:
            yield endpoint.automaton.path, DataChannel(part, endpoint.use.handle)


def _observed_channel(port: LinkedPort, system: System) -> Channel | None:
    name = port.written.name
    if name is None:
        return None
    match port.written.kind:
        case PortKind.TOPIC:
            return system.topics.get(sanitise(name.value))
        case PortKind.SERVICE:
            return system.services.get(name.value)
        case PortKind.ACTION:
            return system.actions.get(name.value)
        case _:
            return None


def _sent(field: str, channel: DataChannel, messages: Sent | None) -> ValueSet:
    if messages is None:
        return ANYTHING
    fields = messages.get(channel)
    return joined(()) if fields is None else fields.get(field, ANYTHING)
