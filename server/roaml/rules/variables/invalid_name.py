# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-name`, which invalid_name.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.expand import PortConstant
from roaml.model.gaps import is_interface_name
from roaml.model.machine import Declaration, Send
from roaml.model.name_forms import EVENT, VARIABLE, variable_problem
from roaml.model.syntax import Name
from roaml.model.value_types import CHANNEL_KINDS
from roaml.model.vocabulary import EVENT_VARIABLES
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule, TreeContext
from roaml.rules.support.interfaces import named_by_ports, port_span
from roaml.rules.support.names import WrongName


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for data in chart.data:
            if data.id is not None:
                yield from _variable(data.id)
        for statement in chart.statements:
            if isinstance(statement, Send):
                if statement.event and not EVENT.match(statement.event.value):
                    yield _wrong(
                        statement.event,
                        f"`{statement.event.value}` is not a valid event name: it must begin with a letter or `_` "
                        "and contain only letters, digits, `.`, `-` and `_`",
                    )
                for param in statement.params:
                    if param.name:
                        yield from _parameter(param.name)
    for declaration in context.machine.declarations:
        yield from _interface(declaration)


def _variable(name: Name) -> Iterator[Finding]:
    if reason := variable_problem(name.value):
        yield _wrong(name, reason)
    elif name.value in EVENT_VARIABLES:
        message = (
            f"`{name.value}` is also the name of received data, which hides the variable where it is available; rename "
            "the variable"
        )
        yield _wrong(name, message, Severity.WARNING)


def _parameter(name: Name) -> Iterator[Finding]:
    if not all(VARIABLE.match(part) for part in name.value.split(".")) or name.value.endswith("_"):
        rule = "it must begin with a letter or `_`, contain only letters, digits and `_`, and not end in `_`"
        yield _wrong(name, f"`{name.value}` is not a valid parameter name: {rule}")


def _interface(declaration: Declaration) -> Iterator[Finding]:
    """Check names that become parts of event names."""
    kind_name = CHANNEL_KINDS.get(declaration.kind, declaration.kind).value
    name = declaration.handle if declaration.kind is SymbolKind.TIMER else declaration.interface
    if isinstance(name, Name) and not is_interface_name(name.value):
        yield _wrong(name, _with_spaces(name.value, kind_name))


def check_tree(context: TreeContext) -> Iterator[Finding]:
    """Check the names of topics, services and actions that ports pass to plugins. An error in a node with several
    instances is reported once."""
    findings: dict[Finding, None] = {}
    for node, automaton, use in named_by_ports(context):
        value = automaton.port(use.port)
        text = value.text.strip() if isinstance(value, PortConstant) else None
        if text is not None and not is_interface_name(text):
            kind_name = CHANNEL_KINDS[use.kind].value
            empty = f"`{use.port}` names {_a(kind_name)} and cannot be empty"
            message = _with_spaces(text, kind_name) if text else empty
            related = (Related(automaton.symbol(use), "used here"),)
            # A default is reported at the name of the node, and that name is not the wrong one.
            is_here = any(setting.key.value == use.port for setting in node.ports)
            facts = WrongName(text) if is_here else None
            findings[RULE.at(port_span(node, use.port), message, related=related, facts=facts)] = None
    yield from findings


def _wrong(name: Name, message: str, severity: Severity | None = None) -> Finding:
    return RULE.at(name.span, message, severity=severity, facts=WrongName(name.value))


def _with_spaces(name: str, kind_name: str) -> str:
    return f"`{name}` is not a valid name of {_a(kind_name)}: it contains spaces"


def _a(noun: str) -> str:
    return f"{'an' if noun == 'action' else 'a'} {noun}"


RULE = Rule(
    "invalid-name",
    Severity.ERROR,
    "A name is not valid.",
    machine=check,
    tree=check_tree,
    facts=WrongName,
)
