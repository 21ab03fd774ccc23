# SPDX-License-Identifier: Apache-2.0
"""The rule `misplaced-value`, which misplaced_value.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.tree import Name, access_path, walk
from roaml.expr.types import Scalar
from roaml.model.machine import Assign, Chart, bodies, statements
from roaml.model.syntax import Expression, PortRead
from roaml.model.value_types import ValueUse
from roaml.model.values.analyse import data_place
from roaml.model.values.evaluate import place_of
from roaml.roles import Direction
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.rules.support.ports import reads


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        yield from _received(context, chart)
    yield from _ports(context)


def _received(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """The assignments of received data to another variable than the one with the name of the field or of the handle,
    which nothing assigns although it is read."""
    types = context.typed.variables.get(chart.scope, {})
    assigned: set[str] = set()
    from_elsewhere: set[str] = set()
    for made in chart.statements:
        if isinstance(made, Assign) and made.location is not None:
            assigned.add((access_path(made.location.tree) or ("",))[0])
    for data in chart.data:
        if data.id is not None and isinstance(data.value, PortRead):
            from_elsewhere.add(data.id.value)
    read = {
        node.name
        for value in context.typed.values
        if value.place.chart is chart and isinstance(value.value, Expression) and value.use is not ValueUse.LOCATION
        for node in walk(value.value.tree)
        if isinstance(node, Name)
    }
    for _, handler, body in bodies(chart):
        prefix = data_place(handler.trigger) if handler is not None and handler.trigger is not None else None
        if handler is None or prefix is None or handler.handle is None:
            continue
        for statement in statements(body):
            if not isinstance(statement, Assign) or not isinstance(statement.value, Expression):
                continue
            field = place_of(statement.value.tree)
            location = statement.location
            if location is None or not isinstance(location.tree, Name) or field is None or not field.startswith(prefix):
                continue
            own = location.tree.name
            if own not in from_elsewhere:
                continue
            for name in (field.rpartition(".")[2], handler.handle.value):
                is_free = name in types and name not in assigned and name in read and name not in from_elsewhere
                type_, other = types.get(name), types.get(own)
                is_alike = isinstance(type_, Scalar) and isinstance(other, Scalar) and type_.kind is other.kind
                if name != own and is_free and is_alike:
                    message = (
                        f"`{own}` is the value of a port and is overwritten with received data here, and nothing "
                        f"assigns `{name}`; did you mean `{name}`?"
                    )
                    yield RULE.at(location.span, message, *replacements(location.span, (name,)))
                    break


def _ports(context: MachineContext) -> Iterator[Finding]:
    """The ports that are read into the variable with the name of another port, which is never read."""
    read = {key.value for key in reads(context.machine, context.typed)}
    declared = {port.key.value for port in context.machine.ports if port.key is not None}
    unread = {
        port.key.value: port.key
        for port in context.machine.ports
        if port.key is not None and port.direction is Direction.IN and port.key.value not in read
    }
    for chart in context.machine.charts:
        targets = [
            (statement.location.tree.name, statement.value)
            for statement in chart.statements
            if isinstance(statement, Assign) and statement.location is not None
            if isinstance(statement.location.tree, Name)
        ]
        targets += [(data.id.value, data.value) for data in chart.data if data.id is not None]
        for name, value in targets:
            if not isinstance(value, PortRead) or value.key is None or value.key.value not in declared:
                continue  # undeclared-port reports a misspelled name
            if name in unread and value.key.value != name:
                message = (
                    f"`{name}` gets the value of the port `{value.key.value}`, and nothing reads the port `{name}`"
                )
                fixes = replacements(value.key.span, (name,))
                related = [Related(unread[name].span, "never read")]
                yield RULE.at(value.key.span, f"{message}; did you mean `{name}`?", *fixes, related=related)


RULE = Rule(
    "misplaced-value",
    Severity.WARNING,
    "A received value is stored in a variable, and the one with the name of the value gets nothing.",
    machine=check,
    whole=True,
)
