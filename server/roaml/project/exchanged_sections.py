# SPDX-License-Identifier: Apache-2.0
"""Services whose request and response are exchanged in their definition: all machines that send one of them set the
fields of the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Severity
from roaml.interfaces.report import CODE as INTERFACE_SYNTAX
from roaml.interfaces.types import Definition
from roaml.model.machine import Machine, RosSend
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart

_SECTIONS = {ProtocolPart.REQUEST: 0, ProtocolPart.RESPONSE: 1}
"""The parts of a service -> their sections in the definition."""


def exchanged_sections(definition: Definition, machines: Iterable[Machine]) -> Iterator[Finding]:
    """The warning at the first field of a service whose machines send the fields of the request in responses, or those
    of the response in requests, and nothing else."""
    if not definition.is_complete:
        return
    names = [{field.name for field in section.fields} for section in definition.sections]
    is_sent = False
    for machine in machines:
        for statement in (statement for chart in machine.charts for statement in chart.statements):
            if not isinstance(statement, RosSend) or statement.part not in _SECTIONS or not statement.fields:
                continue
            declaration = find_handle(machine, statement)
            if declaration is None or declaration.type is None or not _is_type(declaration.type.value, definition):
                continue
            sent = {field.name.value.partition(".")[0] for field in statement.fields if field.name is not None}
            own = _SECTIONS[statement.part]
            if sent & names[own] or not sent or not sent <= names[1 - own]:
                return
            is_sent = True
    field = next((field for section in definition.sections for field in section.fields), None)
    if is_sent and field is not None:
        message = (
            "the request and the response seem to be exchanged: the machines of the system set the fields of one of "
            "them in the other; the fields of the request are above `---`, those of the response below it"
        )
        yield Finding(INTERFACE_SYNTAX, field.name_span, message, Severity.WARNING)


def _is_type(name: str, definition: Definition) -> bool:
    package, _, rest = name.partition("/")
    return package == definition.package and rest.rpartition("/")[2] == definition.name
