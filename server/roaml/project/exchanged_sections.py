# SPDX-License-Identifier: Apache-2.0
"""Services whose request and response are exchanged in their definition: all machines that send one of them set the
fields of the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.interfaces.report import CODE as INTERFACE_SYNTAX
from roaml.interfaces.types import Definition
from roaml.model.machine import Machine, RosSend
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.text import Span, TextEdit

_SECTIONS = {ProtocolPart.REQUEST: 0, ProtocolPart.RESPONSE: 1}
"""The parts of a service -> their sections in the definition."""


def exchanged_sections(text: str, definition: Definition, machines: Iterable[Machine]) -> Iterator[Finding]:
    """The warning at the first field of a service whose machines send the fields of the request in responses, or those
    of the response in requests, and nothing else.

    Args:
        text: the file with the definition.
    """
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
        yield Finding(INTERFACE_SYNTAX, field.name_span, message, Severity.WARNING, tuple(_exchange(text)))


def _exchange(text: str) -> Iterator[Fix]:
    """The exchange of the parts before and after the line `---`."""
    lines = text.splitlines(keepends=True)
    middle = next((number for number, line in enumerate(lines) if line.rstrip() == "---"), None)
    if middle is not None:
        before, after = "".join(lines[:middle]), "".join(lines[middle + 1 :])
        ending = "" if not after or after.endswith("\n") else "\n"
        edit = TextEdit(Span(0, len(text)), f"{after}{ending}{lines[middle]}{before}")
        yield Fix("Exchange the request and the response", (edit,), preferred=True)


def _is_type(name: str, definition: Definition) -> bool:
    package, _, rest = name.partition("/")
    return package == definition.package and rest.rpartition("/")[2] == definition.name
