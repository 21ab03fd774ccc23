# SPDX-License-Identifier: Apache-2.0
"""The events that represent the parts of ROS interfaces and of the tree protocol (docs/spec/plain-scxml.md#events), and
the fields that they carry."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.expr.types import Type, leaves
from roaml.lower.expressions import SEPARATOR
from roaml.model.system import Channel, ChannelEndpoint, SystemAutomaton
from roaml.model.value_types import INTERFACE_KINDS, Environment, section_of
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.scxml.events import EventRole, ScxmlEvent
from roaml.scxml.names import (
    FIELD_PREFIX,
    TreeEventKind,
    action_stem,
    cancel_request,
    named,
    safe_name,
    service_stem,
    topic_message,
    tree_event_name,
)


def topic_event(topic: str) -> ScxmlEvent:
    return ScxmlEvent(topic_message(topic))


def tree_event(node: int | str, kind: TreeEventKind) -> ScxmlEvent:
    """An event between a node of the tree and its parent.

    Args:
        node: the number of the node, or its address if it has conditions (`roaml.lower.library_tree`).
    """
    return ScxmlEvent(tree_event_name(node, kind), EventRole.BLOCKING)


class ServiceEvents(Record, frozen=True):
    """The events of one service."""

    service: str

    @property
    def stem(self) -> str:
        return service_stem(self.service)

    @property
    def request(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_request", EventRole.BLOCKING)

    @property
    def response(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_response", EventRole.BLOCKING)

    def request_of(self, client: SystemAutomaton) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_req_client_{safe_name(client.name)}", EventRole.BLOCKING)

    def response_to(self, client: SystemAutomaton) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_response_client_{safe_name(client.name)}", EventRole.BLOCKING)


class ActionEvents(Record, frozen=True):
    """The events of one action. The name of the action determines whether its feedback waits for its receivers
    (docs/spec/jani.md#synchronising-names)."""

    action: str

    @property
    def stem(self) -> str:
        return action_stem(self.action)

    @property
    def goal(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_goal_handle", EventRole.BLOCKING)

    @property
    def cancel(self) -> ScxmlEvent:
        """The request to cancel a goal. It is received only while no event that starts a thread waits
        (docs/spec/ros.md#cancel).

        Its name does not begin like the names of the other events of the action, so it never waits for its receivers
        (docs/spec/jani.md#synchronising-names).
        """
        return ScxmlEvent(cancel_request(self.action), after=self.thread_start.name)

    @property
    def accepted(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_goal_accepted", EventRole.BLOCKING)

    @property
    def rejected(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_goal_rejected", EventRole.BLOCKING)

    @property
    def feedback(self) -> ScxmlEvent:
        return named(f"{self.stem}_feedback")

    @property
    def result(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_result", EventRole.BLOCKING)

    @property
    def thread_start(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_thread_start", EventRole.BLOCKING)

    @property
    def thread_free(self) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_thread_free", EventRole.BLOCKING)

    def goal_of(self, client: SystemAutomaton) -> ScxmlEvent:
        """The goal of a client. It is received only after all earlier cancel requests (docs/spec/ros.md#cancel)."""
        name = f"{self.stem}_goal_req_client_{safe_name(client.name)}"
        return ScxmlEvent(name, EventRole.BLOCKING, after=self.cancel.name)

    def accept_for(self, client: SystemAutomaton) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_goal_accept_client_{safe_name(client.name)}", EventRole.BLOCKING)

    def reject_for(self, client: SystemAutomaton) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_goal_reject_client_{safe_name(client.name)}", EventRole.BLOCKING)

    def feedback_for(self, client: SystemAutomaton) -> ScxmlEvent:
        return named(f"{self.stem}_feedback_handle_client_{safe_name(client.name)}")

    def result_for(self, client: SystemAutomaton) -> ScxmlEvent:
        return ScxmlEvent(f"{self.stem}_result_handle_client_{safe_name(client.name)}", EventRole.BLOCKING)


def fields(channel: Channel, part: ProtocolPart, environment: Environment) -> dict[str, Type]:
    """The leaf fields of a part of a service or action as event parameters, in the order of the ROS definition.

    Fields that need not be set (`InterfaceType.optional`) are included only if an automaton sends them.
    """
    sent = set[str]().union(*(sent_parameters(endpoint, part) for endpoint in channel.endpoints))
    for endpoint in channel.endpoints:
        interface = environment.interface(INTERFACE_KINDS[endpoint.use.kind], endpoint.use.type)
        if interface is not None:
            required = {parameter(path.split(".")) for path in interface.required(section_of(part))}
            parameters = {parameter(path): type_ for path, type_ in leaves(interface.part(section_of(part)))}
            return {name: type_ for name, type_ in parameters.items() if name in required or name in sent}
    return {}


def sent_parameters(endpoint: ChannelEndpoint, part: ProtocolPart) -> set[str]:
    """The names of the event parameters that one client or server sends for the fields of a part."""
    return {
        parameter((*field.name.split("."), *path))
        for field in dict(endpoint.use.fields).get(part, ())
        for path, _ in leaves(field.type)
    }


def parameter(path: Iterable[str]) -> str:
    """The name of the event parameter for a leaf field."""
    return FIELD_PREFIX + SEPARATOR.join(path)
