# SPDX-License-Identifier: Apache-2.0
"""The values that the global variables of interfaces and of the nodes of trees can have, which properties in JANI
compare (docs/spec/jani.md#global-variables)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from roaml.expr.types import INTEGER_RANGES, Scalar, ScalarKind, leaves
from roaml.model.node_effects import statuses
from roaml.model.ros import InterfaceType
from roaml.model.system import Channel, ChannelEndpoint, System
from roaml.model.value_types import INTERFACE_KINDS, section_of
from roaml.model.values.analyse import RESULT_CODE, DataChannel, Sent, of_type
from roaml.model.values.arriving import FindInterface
from roaml.model.values.domain import ANYTHING, ValueSet, exactly, joined, listed
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.scxml.names import (
    FIELD_PREFIX,
    TreeEventKind,
    action_stem,
    safe_name,
    service_stem,
    topic_message,
    tree_event_name,
)


class GlobalValues(Record, frozen=True):
    """The values of a variable that contains an integer.

    Attributes:
        type: the type of the field in the ROS definition.
        sent: the values that machines send, and the initial value 0; `ANYTHING` if they are not known.
    """

    type: Scalar
    sent: ValueSet

    @property
    def by_type(self) -> ValueSet:
        """All values of the type."""
        return of_type(self.type)


def global_values(
    system: System, sent: Mapping[str, Sent | None], interface: FindInterface
) -> Mapping[str, GlobalValues]:
    """The values of the global variables for integer fields of interfaces, codes of results and statuses, by name.

    Args:
        sent: path of a machine of the complete `system` -> what it sends; `None` if this is not known.
    """
    result: dict[str, GlobalValues] = {}
    for events, part, endpoints in _messages(system):
        senders = [endpoint for endpoint in endpoints if part in endpoint.use.sends]
        fields = [
            (f"{FIELD_PREFIX}{'__'.join(path)}", ".".join(path), type_)
            for path, type_ in _fields(senders, part, interface)
        ]
        if part is ProtocolPart.RESULT and senders:
            fields.append(("code", RESULT_CODE, _INTEGER))
        for parameter, path, type_ in fields:
            values = GlobalValues(type_, joined((exactly(0), *_sent(senders, part, path, sent))))
            result.update((f"{event}__{parameter}", values) for event in events)
    for instance in system.instances:
        values = GlobalValues(_INTEGER, listed((0, *statuses(system, instance))))
        result[f"{tree_event_name(instance.number, TreeEventKind.RESPONSE)}__status"] = values
    return result


_INTEGER = Scalar(ScalarKind.INT, "int32")
"""The type of codes of results and of statuses."""

_Messages: TypeAlias = "tuple[Sequence[str], ProtocolPart, list[ChannelEndpoint]]"
"""The names of events that carry the same data, with the part of the protocol and the endpoints that send it."""


def _messages(system: System) -> Iterator[_Messages]:
    for topic in system.topics.values():
        yield (topic_message(topic.name),), ProtocolPart.MESSAGE, topic.sources
    for service in system.services.values():
        stem, clients = service_stem(service.name), _names(service)
        requests = [f"{stem}_request", *(f"{stem}_req_client_{who}" for who in clients)]
        yield requests, ProtocolPart.REQUEST, service.users
        responses = [f"{stem}_response", *(f"{stem}_response_client_{who}" for who in clients)]
        yield responses, ProtocolPart.RESPONSE, service.sources
    for action in system.actions.values():
        stem, clients = action_stem(action.name), _names(action)
        goals = [f"{stem}_goal_handle", *(f"{stem}_goal_req_client_{who}" for who in clients)]
        yield goals, ProtocolPart.GOAL, action.users
        for part in (ProtocolPart.FEEDBACK, ProtocolPart.RESULT):
            events = [f"{stem}_{part.value}", *(f"{stem}_{part.value}_handle_client_{who}" for who in clients)]
            yield events, part, action.sources


def _names(channel: Channel) -> list[str]:
    """The names of the clients of a service or action, as in the names of its events."""
    return [safe_name(client.automaton.name) for client in channel.users]


def _fields(
    senders: Sequence[ChannelEndpoint], part: ProtocolPart, interface: FindInterface
) -> Iterator[tuple[tuple[str, ...], Scalar]]:
    """The integers in what `senders` send, if all of them send the same type."""
    types = {endpoint.use.type for endpoint in senders}
    found = interface(INTERFACE_KINDS[senders[0].use.kind], senders[0].use.type) if len(types) == 1 else None
    for path, type_ in leaves(found.part(section_of(part))) if isinstance(found, InterfaceType) else ():
        if isinstance(type_, Scalar) and type_.name in INTEGER_RANGES:
            yield path, type_


def _sent(
    senders: Sequence[ChannelEndpoint], part: ProtocolPart, path: str, sent: Mapping[str, Sent | None]
) -> Iterator[ValueSet]:
    for endpoint in senders:
        messages = sent.get(endpoint.automaton.path)
        fields = None if messages is None else messages.get(DataChannel(part, endpoint.use.handle))
        yield ANYTHING if fields is None else fields.get(path, ANYTHING)
