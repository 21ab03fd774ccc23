# SPDX-License-Identifier: Apache-2.0
"""The constants that are sent in a field although no receiver expects them, and those that a receiver expects and
nothing sends. One of each is one mistake, which is reported at the sender only (unexpected-value)."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TypeAlias

from roaml.exact_number import exact_number
from roaml.model.expand import PortConstant
from roaml.model.message_constants import MessageField, unexpected
from roaml.model.system import Channel, ChannelEndpoint, System, SystemAutomaton
from roaml.roles import ProtocolPart

WrongFields: TypeAlias = "dict[tuple[str, MessageField], tuple[Fraction, Fraction]]"
"""The name of an automaton, and a field that it sends or receives -> the only constant that nothing expects, and the
expected one that nothing sends."""


def wrong_fields(system: System, automaton: SystemAutomaton) -> Mapping[MessageField, tuple[Fraction, Fraction]]:
    """Field that an automaton sends or receives -> the only constant that is sent and that nothing expects, and the
    only one that is expected and that nothing sends."""
    known: dict[str, WrongFields] = system.__dict__.setdefault("_wrong_fields", {})
    if "fields" not in known:
        fields: WrongFields = {}
        for channels in (system.topics, system.services, system.actions):
            for channel in channels.values():
                _compare(channel, fields)
        known["fields"] = fields
    return {field: pair for (name, field), pair in known["fields"].items() if name == automaton.name}


def _compare(channel: Channel, known: WrongFields) -> None:
    for part in (ProtocolPart.MESSAGE, ProtocolPart.REQUEST, ProtocolPart.GOAL):
        sides = (channel.sources, channel.users) if part is ProtocolPart.MESSAGE else (channel.users, channel.sources)
        senders = [endpoint for endpoint in sides[0] if part in endpoint.use.sends]
        receivers = [endpoint for endpoint in sides[1] if part in endpoint.use.receives]
        for path in _paths(part, senders):
            sent, expected = _sent(part, path, senders), _expected(part, path, receivers)
            pair = unexpected(sent, expected) if sent and expected else None
            for endpoint in (*senders, *receivers):
                if pair is not None:
                    known[endpoint.automaton.name, MessageField(part, endpoint.use.handle, path)] = pair


def _paths(part: ProtocolPart, senders: list[ChannelEndpoint]) -> set[str]:
    return {
        sent.field.path
        for endpoint in senders
        for sent in endpoint.automaton.outline.constants
        if sent.field.part is part and sent.field.handle == endpoint.use.handle
    }


def _sent(part: ProtocolPart, path: str, senders: list[ChannelEndpoint]) -> frozenset[Fraction]:
    """The constants that are sent in a field; none if something else may be sent."""
    numbers: set[Fraction] = set()
    for endpoint in senders:
        automaton = endpoint.automaton
        field = MessageField(part, endpoint.use.handle, path)
        sent = next((sent for sent in automaton.outline.constants if sent.field == field), None)
        ports = [port_constant(automaton, port) for port in sent.ports] if sent is not None else []
        if sent is None or not sent.complete or None in ports:
            return frozenset()
        numbers |= sent.constants | {number for number in ports if number is not None}
    return frozenset(numbers)


def _expected(part: ProtocolPart, path: str, receivers: list[ChannelEndpoint]) -> frozenset[Fraction]:
    """The constants with which the receivers compare a field; none if one of them does something else with it."""
    numbers: set[Fraction] = set()
    for endpoint in receivers:
        field = MessageField(part, endpoint.use.handle, path)
        choice = next((choice for choice in endpoint.automaton.outline.choices if choice.field == field), None)
        if choice is None:
            return frozenset()
        numbers |= choice.constants
    return frozenset(numbers)


def port_constant(automaton: SystemAutomaton, port: str) -> Fraction | None:
    value = automaton.port(port)
    return exact_number(value.text) if isinstance(value, PortConstant) else None
