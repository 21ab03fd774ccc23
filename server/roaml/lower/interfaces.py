# SPDX-License-Identifier: Apache-2.0
"""The events for the parts of ROS interfaces (docs/spec/plain-scxml.md#events), and their fields."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from roaml.expr.types import Type, leaves
from roaml.lower.expressions import SEPARATOR
from roaml.model.globals import FIELD_PREFIX
from roaml.model.system import Automaton, Channel, Endpoint, safe_name, sanitise
from roaml.model.value_types import INTERFACE_KINDS, Environment


def topic_event(topic: str) -> str:
    return f"topic_{sanitise(topic)}_msg"


@dataclass(frozen=True, slots=True)
class ServiceEvents:
    """The names of the events of one service."""

    service: str

    @property
    def stem(self) -> str:
        return f"srv_{sanitise(self.service)}"

    @property
    def request(self) -> str:
        return f"{self.stem}_request"

    @property
    def response(self) -> str:
        return f"{self.stem}_response"

    def request_of(self, client: Automaton) -> str:
        return f"{self.stem}_req_client_{safe_name(client.name)}"

    def response_to(self, client: Automaton) -> str:
        return f"{self.stem}_response_client_{safe_name(client.name)}"


@dataclass(frozen=True, slots=True)
class ActionEvents:
    """The names of the events of one action."""

    action: str

    @property
    def stem(self) -> str:
        return f"action_{sanitise(self.action)}"

    @property
    def goal(self) -> str:
        return f"{self.stem}_goal_handle"

    @property
    def accepted(self) -> str:
        return f"{self.stem}_goal_accepted"

    @property
    def rejected(self) -> str:
        return f"{self.stem}_goal_rejected"

    @property
    def feedback(self) -> str:
        return f"{self.stem}_feedback"

    @property
    def result(self) -> str:
        return f"{self.stem}_result"

    @property
    def thread_start(self) -> str:
        return f"{self.stem}_thread_start"

    @property
    def thread_free(self) -> str:
        return f"{self.stem}_thread_free"

    def goal_of(self, client: Automaton) -> str:
        return f"{self.stem}_goal_req_client_{safe_name(client.name)}"

    def accept_for(self, client: Automaton) -> str:
        return f"{self.stem}_goal_accept_client_{safe_name(client.name)}"

    def reject_for(self, client: Automaton) -> str:
        return f"{self.stem}_goal_reject_client_{safe_name(client.name)}"

    def feedback_for(self, client: Automaton) -> str:
        return f"{self.stem}_feedback_handle_client_{safe_name(client.name)}"

    def result_for(self, client: Automaton) -> str:
        return f"{self.stem}_result_handle_client_{safe_name(client.name)}"


def fields(channel: Channel, part: str, environment: Environment) -> dict[str, Type]:
    """The leaf fields of a part of a service or action as event parameters, in the order of the ROS definition.

    Fields that need not be set (`InterfaceType.optional`) are included only if an automaton sends them.
    """
    sent = set[str]().union(*(sent_parameters(endpoint, part) for endpoint in channel.endpoints))
    for endpoint in channel.endpoints:
        interface = environment.interface(INTERFACE_KINDS[endpoint.use.kind], endpoint.use.type)
        if interface is not None:
            required = {parameter(path.split(".")) for path in interface.required(part)}
            found = {parameter(path): type_ for path, type_ in leaves(interface.part(part))}
            return {name: type_ for name, type_ in found.items() if name in required or name in sent}
    return {}


def sent_parameters(endpoint: Endpoint, part: str) -> set[str]:
    """The event parameters that one side sends for the fields of a part."""
    return {
        parameter((*field.name.split("."), *path))
        for field in dict(endpoint.use.fields).get(part, ())
        for path, _ in leaves(field.type)
    }


def parameter(path: Iterable[str]) -> str:
    """The event parameter of a leaf field."""
    return FIELD_PREFIX + SEPARATOR.join(path)
