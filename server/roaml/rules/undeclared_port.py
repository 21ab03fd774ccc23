# SPDX-License-Identifier: Apache-2.0
"""undeclared-port: see undeclared_port.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.language import HL_SCXML
from roaml.model.machine import Machine, SetOutput, all_statements
from roaml.model.syntax import Name, PortRead
from roaml.model.typing import TypedMachine
from roaml.rules import misspelled
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements


def check(context: MachineContext) -> Iterator[Finding]:
    if context.listed_as == {"node_models"}:
        return  # tree-element-in-node says that a node has no ports
    ports = {port.key.value: port for port in context.machine.ports if port.key}
    inputs = [key for key in reads(context.machine, context.typed) if key.value not in ports]
    for key in inputs:
        if not _is_misspelled_declaration(context.machine, key.value):
            close = close_names(key.value, ports)
            message = f"there is no port `{key.value}`{did_you_mean(close)}"
            yield RULE.at(key.span, message, *replacements(key.span, close))
    outputs = [name for name, port in ports.items() if port.direction == "out"]
    for key in writes(context.machine):
        port = ports.get(key.value)
        close = close_names(key.value, outputs)
        if port is None and not _is_misspelled_declaration(context.machine, key.value):
            message = f"there is no output port `{key.value}`{did_you_mean(close)}"
            yield RULE.at(key.span, message, *replacements(key.span, close))
        elif port is not None and port.direction == "in":
            message = f"`{key.value}` is an input port and cannot be written{did_you_mean(close)}"
            yield RULE.at(key.span, message, *replacements(key.span, close))


def reads(machine: Machine, typed: TypedMachine) -> Iterator[Name]:
    """The ports that a machine reads."""
    for value in typed.values:
        if isinstance(value.value, PortRead) and value.value.key is not None:
            yield value.value.key
    for declaration in machine.declarations:
        for read in (declaration.interface, declaration.rate):
            if isinstance(read, PortRead) and read.key is not None:
                yield read.key


def writes(machine: Machine) -> Iterator[Name]:
    """The ports that a machine writes."""
    for chart in machine.charts:
        for statement in all_statements(chart):
            if isinstance(statement, SetOutput) and statement.key is not None:
                yield statement.key


def _is_misspelled_declaration(machine: Machine, key: str) -> bool:
    """Whether an element that the language does not know declares the port: unknown-element says so."""
    named = [e for e in machine.element.elements if (known := e.get("key")) and known.value == key]
    return any(misspelled.among(named, name, HL_SCXML) for name in ("bt_declare_port_in", "bt_declare_port_out"))


RULE = Rule("undeclared-port", Severity.ERROR, "A port is used that is not declared.", machine=check)
