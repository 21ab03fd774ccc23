# SPDX-License-Identifier: Apache-2.0
"""The values that the global variables of topics can have, which properties in JANI compare
(docs/spec/jani.md#global-variables)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.expr.types import INTEGER_RANGES, Scalar, leaves
from roaml.model.ros import InterfaceType
from roaml.model.system import Channel, System
from roaml.model.value_types import INTERFACE_KINDS, section_of
from roaml.model.values.analyse import DataChannel, Sent, of_type
from roaml.model.values.arriving import FindInterface
from roaml.model.values.domain import ANYTHING, ValueSet, exactly, joined
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.scxml.names import FIELD_PREFIX, topic_message


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


def topic_values(
    system: System, sent: Mapping[str, Sent | None], interface: FindInterface
) -> Mapping[str, GlobalValues]:
    """The values of the global variables for integer fields of topics, by name.

    Args:
        sent: path of a machine of the complete `system` -> what it sends; `None` if this is not known.
    """
    return {
        f"{topic_message(topic.name)}__{FIELD_PREFIX}{'__'.join(path)}": GlobalValues(type_, values)
        for topic in system.topics.values()
        for path, type_, values in _fields(topic, sent, interface)
    }


def _fields(
    topic: Channel, sent: Mapping[str, Sent | None], interface: FindInterface
) -> Iterator[tuple[tuple[str, ...], Scalar, ValueSet]]:
    sources = [endpoint for endpoint in topic.sources if ProtocolPart.MESSAGE in endpoint.use.sends]
    types = {endpoint.use.type for endpoint in sources}
    found = interface(INTERFACE_KINDS[sources[0].use.kind], sources[0].use.type) if len(types) == 1 else None
    if not isinstance(found, InterfaceType):
        return
    for path, type_ in leaves(found.part(section_of(ProtocolPart.MESSAGE))):
        if not isinstance(type_, Scalar) or type_.name not in INTEGER_RANGES:
            continue
        values = [exactly(0)]
        for endpoint in sources:
            messages = sent.get(endpoint.automaton.path)
            fields = None if messages is None else messages.get(DataChannel(ProtocolPart.MESSAGE, endpoint.use.handle))
            values.append(ANYTHING if fields is None else fields.get(".".join(path), ANYTHING))
        yield path, type_, joined(values)
