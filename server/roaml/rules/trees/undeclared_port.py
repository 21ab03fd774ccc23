# SPDX-License-Identifier: Apache-2.0
"""The rule `undeclared-port`, which undeclared_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import after, first_in
from roaml.expr.types import Scalar
from roaml.model.machine import Machine, SetOutput
from roaml.model.syntax import Name, PortRead
from roaml.model.system_file import SystemSection
from roaml.model.vocabulary import DEFAULT_TYPES
from roaml.roles import Direction
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support import misspelled
from roaml.rules.support.ports import reads, writes


def check(context: MachineContext) -> Iterator[Finding]:
    if context.listed_as == {SystemSection.NODE_MODELS}:
        return  # tree-element-in-node reports that a node has no ports
    ports = {port.key.value: port for port in context.machine.ports if port.key}
    inputs = [key for key in reads(context.machine, context.typed) if key.value not in ports]
    for key in inputs:
        if not _is_misspelled_declaration(context.machine, key.value):
            close = close_names(key.value, ports)
            message = f"there is no port `{key.value}`{did_you_mean(close) or '; declare it'}"
            yield RULE.at(key.span, message, *replacements(key.span, close), *_declare(context, key, Direction.IN))
    outputs = [name for name, port in ports.items() if port.direction is Direction.OUT]
    for key in writes(context.machine):
        port = ports.get(key.value)
        close = close_names(key.value, outputs)
        if port is None and not _is_misspelled_declaration(context.machine, key.value):
            message = f"there is no output port `{key.value}`{did_you_mean(close) or '; declare it'}"
            yield RULE.at(key.span, message, *replacements(key.span, close), *_declare(context, key, Direction.OUT))
        elif port is not None and port.direction is Direction.IN:
            message = f"`{key.value}` is an input port and cannot be written{did_you_mean(close)}"
            yield RULE.at(key.span, message, *replacements(key.span, close))


def _declare(context: MachineContext, key: Name, direction: Direction) -> Iterator[Fix]:
    """A fix that declares a port, if its type can be inferred from its uses. Nodes of the tree must then set the
    port."""
    type_ = _type_of(context, key)
    if type_ is not None:
        text = f'<bt_declare_port_{direction} key="{key.value}" type="{type_}" />'
        ports, document = context.machine.ports, context.document
        edit = after(document, ports[-1].element, text) if ports else first_in(document, context.machine.element, text)
        yield Fix(f"Declare the port `{key.value}` as {type_}", (edit,), preferred=False)


def _type_of(context: MachineContext, key: Name) -> str | None:
    for value in context.typed.values:
        if isinstance(value.value, PortRead) and value.value.key is key:
            return value.required.name if isinstance(value.required, Scalar) and value.required.name else None
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, SetOutput) and statement.key is key:
                types = [v.type for v in context.typed.values if v.value is statement.value]
                return next((t.name or DEFAULT_TYPES[t.kind] for t in types if isinstance(t, Scalar)), None)
    declared = [d for d in context.machine.declarations for read in (d.interface,) if isinstance(read, PortRead)]
    return "string" if any(isinstance(d.interface, PortRead) and d.interface.key is key for d in declared) else None


def _is_misspelled_declaration(machine: Machine, key: str) -> bool:
    tags = ("bt_declare_port_in", "bt_declare_port_out")
    return any(misspelled.declaration(machine, tag, key) for tag in tags)


RULE = Rule("undeclared-port", Severity.ERROR, "A port is used but not declared.", machine=check)
