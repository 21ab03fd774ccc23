# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-variable`, which unused_variable.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity, Tag
from roaml.edit.elements import removal, remove
from roaml.expr.tree import Name, walk
from roaml.model.machine import CallChild, Chart, Data, ReturnStatus
from roaml.model.syntax import Expression, Value
from roaml.rules.rule import MachineContext, Rule
from roaml.text import Span


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        values = [value.value for value in context.typed.values if value.place.chart is chart]
        if any(isinstance(value, Expression) and value.broken for value in values):
            continue  # the part that cannot be read may use the variable
        used = _used(values, chart)
        for data in chart.data:
            if data.id is not None and data.id.value not in used:
                message = f"the variable `{data.id.value}` is never used"
                yield RULE.at(data.id.span, message, _remove(context, data), tags=(Tag.UNNECESSARY,))


def _remove(context: MachineContext, data: Data) -> Fix:
    """A fix that removes a variable together with the comment that states its type."""
    title, text = "Remove the variable", context.source.text
    if not data.comment_type or data.type is None:
        return remove(context.document, data.element, title, preferred=True)
    start = text.rfind("<!--", 0, data.type.span.start)
    return Fix(title, (removal(text, Span(start, data.element.span.end)),))


def _used(values: list[Value], chart: Chart) -> set[str]:
    used = {
        node.name
        for value in values
        if isinstance(value, Expression)
        for node in walk(value.tree)
        if isinstance(node, Name)
    }
    for statement in chart.statements:
        match statement:
            case ReturnStatus(status=name) | CallChild(child=name) if name is not None:
                used.add(name.value)
    used.update(handler.child.value for state in chart.states for handler in state.handlers if handler.child)
    return used


RULE = Rule("unused-variable", Severity.HINT, "A variable is never used.", machine=check)
