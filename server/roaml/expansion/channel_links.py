# SPDX-License-Identifier: Apache-2.0
"""Puts channels between the machines of a system (docs/spec/channels.md#expansion).

A channel of a topic becomes a machine for each file that subscribes to it; the subscribers of the file get another
topic. A channel of a service becomes one machine; its server gets another service.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from roaml.diagnostics import Severity
from roaml.expansion.channel_machines import Fields, Way, service_machine, topic_machine
from roaml.expansion.channels import ChannelKind, DeclaredChannel, interface_key
from roaml.expansion.instances import interface_edits
from roaml.expansion.problems import ExpansionProblem, Problems
from roaml.expr.types import Type, leaves
from roaml.interfaces.types import Kind
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Name, name_of
from roaml.record import Record
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean
from roaml.text import TextEdit
from roaml.xml_syntax import Document, Element

_NO_IDENTIFIER = regex(r"\W", re.ASCII)
_DECLARING = {
    ChannelKind.TOPIC: ("ros_topic_publisher", "ros_topic_subscriber"),
    ChannelKind.SERVICE: ("ros_service_client", "ros_service_server"),
}
"""The elements that declare senders and receivers."""
_ATTRIBUTES = {ChannelKind.TOPIC: "topic", ChannelKind.SERVICE: "service_name"}
_PARTS: Mapping[ChannelKind, Kind] = {ChannelKind.TOPIC: "msg", ChannelKind.SERVICE: "srv"}

FindInterface = Callable[[str, str], "InterfaceType | None"]
"""The kind and the name of a ROS type -> the type; `None` if it cannot be read."""


class ListedMachine(Record, frozen=True, eq=False):
    """A machine that a system lists, expanded.

    Attributes:
        path: the path under which it is analysed.
    """

    path: str
    document: Document


class DeliveredName(Record, frozen=True):
    """The name `sent/to_receiver` from which a machine receives (docs/spec/channels.md#expansion).

    Attributes:
        sent: the name of the topic or service.
        receiver: the name of the machine.
        path: the path under which the machine is analysed.
    """

    kind: ChannelKind
    sent: str
    receiver: str
    path: str


class Links(Record, frozen=True):
    """The channels between machines.

    Attributes:
        edits: the path of a machine -> the edits that connect it with channels.
        machines: the machines of channels: the channel, the name of the machine and its text.
        delivered: the names from which receivers receive.
    """

    edits: Mapping[str, Sequence[TextEdit]]
    machines: Sequence[tuple[DeclaredChannel, str, str]]
    delivered: Sequence[DeliveredName]


class _End(Record, frozen=True, eq=False):
    """A machine that declares an interface."""

    machine: ListedMachine
    element: Element
    name: str | None
    """`None` if it is the value of a port."""
    type: Name | None


def link(
    channels: Iterable[DeclaredChannel], machines: Sequence[ListedMachine], interface: FindInterface, problems: Problems
) -> Links:
    """The machines and edits for the channels of a system.

    Args:
        problems: receives the channels that cannot be put between the machines.
    """
    linker = _Linker(machines, interface, problems)
    for channel in channels:
        linker.link(channel)
    return Links(linker.edits, linker.made, linker.delivered)


def declares(document: Document, channel: DeclaredChannel) -> bool:
    """Whether a machine declares the topic or service of a channel with its name."""
    elements, attribute = _DECLARING[channel.kind], _ATTRIBUTES[channel.kind]
    machine = ListedMachine("", document)
    return any(_is_named(end, channel) for element in elements for end in _ends([machine], element, attribute))


class _Linker:
    def __init__(self, machines: Sequence[ListedMachine], interface: FindInterface, problems: Problems) -> None:
        self._interface = interface
        self._reported = problems
        self._problems = problems
        self._ends = {
            element: tuple(_ends(machines, element, _ATTRIBUTES[kind]))
            for kind, elements in _DECLARING.items()
            for element in elements
        }
        self._taken = {_name(machine.document) for machine in machines}
        self.edits: dict[str, list[TextEdit]] = {}
        self.made: list[tuple[DeclaredChannel, str, str]] = []
        self.delivered: list[DeliveredName] = []

    def link(self, channel: DeclaredChannel) -> None:
        self._problems = self._reported if channel.is_valid else Problems()
        name = channel.name.value
        senders, receivers = (self._ends[element] for element in _DECLARING[channel.kind])
        from_, to = ([end for end in ends if _is_named(end, channel)] for ends in (senders, receivers))
        if not from_ or not to:
            self._unknown(channel, from_, to, (*senders, *receivers))
            return
        types = {end.type.value for end in (*from_, *to) if end.type is not None}
        if len(types) != 1:
            shown = ", ".join(f"`{type_}`" for type_ in sorted(types))
            message = f"the machines declare different types for `{name}`, {shown}; a channel needs one type"
            self._problems.add(ExpansionProblem.CHANNEL, channel.name.span, message)
            return
        (type_,) = types
        hidden = [end for end in receivers if end.name is None and end.type is not None and end.type.value == type_]
        if hidden:
            message = (
                f"a port of `{_name(hidden[0].machine.document)}` names the {channel.kind.value} of a receiver with "
                f"the type `{type_}`, so it is not known whether this channel leads to it; write the name into the "
                "machine"
            )
            self._problems.add(ExpansionProblem.CHANNEL, channel.name.span, message)
            return
        found = self._interface(_PARTS[channel.kind], type_)
        if found is None:
            return  # the machines report the type
        if channel.kind is ChannelKind.SERVICE:
            self._report_clients(channel, from_)
            request = Fields(_leaves(found, "request", _set_fields(from_)))
            response = Fields(_leaves(found, "response", _set_fields(to)))
            self._put(channel, to, type_, lambda way: service_machine(channel, way, request, response))
            return
        message_fields = Fields(_leaves(found, "message", _set_fields(from_)))
        for path in dict.fromkeys(end.machine.path for end in to):
            ends = [end for end in to if end.machine.path == path]
            self._put(channel, ends, type_, lambda way: topic_machine(channel, way, message_fields))

    def _put(self, channel: DeclaredChannel, ends: Sequence[_End], type_: str, machine: Callable[[Way], str]) -> None:
        """Put a machine between an interface and the receivers in one machine, which get another name."""
        name = channel.name.value
        receiver = _NO_IDENTIFIER.sub("_", _name(ends[0].machine.document)) or "receiver"
        new = f"{name.rstrip('/')}/to_{receiver}"
        automaton = self._fresh(f"channel_{_NO_IDENTIFIER.sub('_', name.strip('/'))}_to_{receiver}")
        for end in ends:
            edits = self.edits.setdefault(end.machine.path, [])
            edits += interface_edits(end.machine.document, end.element, lambda _: new)
        self.made.append((channel, automaton, machine(Way(automaton, name, new, type_))))
        if receiver == _name(ends[0].machine.document):
            self.delivered.append(DeliveredName(channel.kind, name.rstrip("/"), receiver, ends[0].machine.path))

    def _fresh(self, name: str) -> str:
        fresh, number = name, 2
        while fresh in self._taken:
            fresh = f"{name}_{number}"
            number += 1
        self._taken.add(fresh)
        return fresh

    def _unknown(
        self, channel: DeclaredChannel, senders: list[_End], receivers: list[_End], known: Iterable[_End]
    ) -> None:
        name = channel.name.value
        if channel.kind is ChannelKind.TOPIC:
            missing = "publishes to" if not senders else "subscribes to"
        else:
            missing = "is a client of" if not senders else "is a server of"
        close: tuple[str, ...] = ()
        if not senders and not receivers:
            close = tuple(close_names(name, {end.name for end in known if end.name is not None}))
            missing = "publishes or subscribes to" if channel.kind is ChannelKind.TOPIC else "declares"
        hint = did_you_mean(close) if close else "; correct the name, or remove the channel"
        message = f"no machine of this system {missing} the {channel.kind.value} `{name}`{hint}"
        self._problems.add(ExpansionProblem.CHANNEL, channel.name.span, message, close=close)

    def _report_clients(self, channel: DeclaredChannel, clients: Sequence[_End]) -> None:
        """Report that the requests of other clients stop the clock (docs/spec/semantics.md#time)."""
        if channel.step and len({end.machine.path for end in clients}) > 1:
            message = (
                f"the service `{channel.name.value}` has several clients: while a request is on its way, the request "
                "of another client waits, and the clock stops; delay the topics or timers of the clients instead"
            )
            self._problems.add(ExpansionProblem.CHANNEL, channel.name.span, message, severity=Severity.WARNING)


def _ends(machines: Sequence[ListedMachine], element: str, attribute: str) -> Iterator[_End]:
    for machine in machines:
        for child in machine.document.root.elements if machine.document.root else ():
            if child.name != element:
                continue
            name = name_of(child.get(attribute))
            written = name.value if name is not None else None
            inner = child.find(attribute)
            if written is None and inner is not None and (content := machine.document.content(inner)) is not None:
                written = content.text
            yield _End(machine, child, written, name_of(child.get("type")))


def _is_named(end: _End, channel: DeclaredChannel) -> bool:
    return end.name is not None and (channel.kind, interface_key(channel.kind, end.name)) == channel.key


def _name(document: Document) -> str:
    name = name_of(document.root.get("name")) if document.root is not None else None
    return name.value if name is not None else ""


def _leaves(type_: InterfaceType, part: str, optional: Iterable[str]) -> tuple[tuple[str, Type], ...]:
    """The leaf fields that a channel forwards: all that must be set, and those of `optional`."""
    kept = {*type_.required(part), *optional}
    paths = ((".".join(path), leaf) for path, leaf in leaves(type_.part(part)))
    return tuple((path, leaf) for path, leaf in paths if path in kept)


def _set_fields(ends: Iterable[_End]) -> Iterator[str]:
    """The fields that machines set in any message."""
    for document in {id(end.machine): end.machine.document for end in ends}.values():
        for element in document.root.walk() if document.root is not None else ():
            if element.name == "field" and (name := name_of(element.get("name"))) is not None:
                yield name.value
