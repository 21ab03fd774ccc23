# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-variable`, which unused_variable.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity, Tag
from roaml.edit.elements import removal, remove
from roaml.expr.operators import OperatorKind
from roaml.expr.tree import Binary, Call, Expr, Name, access_path, walk
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import Assign, CallChild, Chart, Data, ReturnStatus
from roaml.model.syntax import Expression, Value
from roaml.model.value_types import ValueUse
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.words import difference, words_of
from roaml.text import Span


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        values = [value.value for value in context.typed.values if value.place.chart is chart]
        if any(isinstance(value, Expression) and value.broken for value in values):
            continue  # the part that cannot be read may use the variable
        used = _used(values, chart)
        written = _only_written(values, chart) if context.system is not None else {}
        for data in chart.data:
            if data.id is None:
                continue
            if data.id.value not in used:
                message = f"the variable `{data.id.value}` is never used"
                yield RULE.at(data.id.span, message, _remove(context, data), tags=(Tag.UNNECESSARY,))
            elif data.id.value in written:
                message = f"the variable `{data.id.value}` is assigned, but its value is never read"
                spans, computed = written[data.id.value]
                related = [Related(span, "assigned here") for span in spans]
                twin = _twin(context, chart, data.id.value, spans)
                if twin is not None:
                    message += f", although that of `{twin}` is, which the same handler does not assign"
                severity = Severity.WARNING if computed or twin is not None else None
                yield RULE.at(data.id.span, message, related=related, severity=severity)


def _remove(context: MachineContext, data: Data) -> Fix:
    """A fix that removes a variable together with the comment that states its type."""
    title, text = "Remove the variable", context.source.text
    if not data.comment_type or data.type is None:
        return remove(context.document, data.element, title, preferred=True)
    start = text.rfind("<!--", 0, data.type.span.start)
    return Fix(title, (removal(text, Span(start, data.element.span.end)),))


def _only_written(values: list[Value], chart: Chart) -> dict[str, tuple[list[Span], bool]]:
    """Variable that is assigned and read nowhere else than in its own assignments -> the places of the assignments, and
    whether one of them computes its value, as in `n + 1`."""
    assigned: dict[str, list[Span]] = {}
    own: dict[Span, str] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            root = (access_path(statement.location.tree) or ("",))[0]
            assigned.setdefault(root, []).append(statement.location.span)
            own[statement.location.span] = root
            if isinstance(statement.value, Expression):
                own[statement.value.span] = root
    read, computed = _named(chart), set()
    locations = {span for spans in assigned.values() for span in spans}
    for value in values:
        if not isinstance(value, Expression):
            continue
        target = own.get(value.span)
        nodes = list(walk(value.tree))
        read |= {node.name for node in nodes if isinstance(node, Name) and node.name != target}
        if target is not None and value.span not in locations and any(_computes(node, target) for node in nodes):
            computed.add(target)
    return {name: (spans, name in computed) for name, spans in assigned.items() if name not in read}


def _twin(context: MachineContext, chart: Chart, name: str, spans: Sequence[Span]) -> str | None:
    """A variable that is probably read by mistake instead of `name`: its name differs in one word, it is not assigned
    in the handlers that assign `name`, and both only get data that arrive."""
    if len(words_of(name)) < 2:
        return None
    types = context.typed.variables.get(chart.scope, {})
    handlers = {value.place.handler for value in context.typed.values if value.value.span in spans}
    assigned: set[str] = set()
    read: set[str] = set()
    for value in context.typed.values:
        if value.place.chart is chart and isinstance(value.value, Expression):
            if value.use is not ValueUse.LOCATION:
                read |= variables_in((value.value.tree,))
            elif value.place.handler in handlers:
                assigned |= variables_in((value.value.tree,))
    others: dict[str, list[Assign]] = {}
    for statement in chart.statements:
        if isinstance(statement, Assign) and statement.location is not None:
            others.setdefault((access_path(statement.location.tree) or ("",))[0], []).append(statement)
    for other, type_ in types.items():
        is_similar = str(type_) == str(types.get(name)) and difference(name, other) is not None
        received = (*others.get(name, ()), *others.get(other, ()))
        if is_similar and other in read - assigned and other in others and all(map(_is_received, received)):
            return other
    return None


def _is_received(statement: Assign) -> bool:
    return isinstance(statement.value, Expression) and any(
        name.startswith("_") for name in variables_in((statement.value.tree,))
    )


def _computes(node: Expr, variable: str) -> bool:
    if isinstance(node, Name):
        return node.name == variable
    return isinstance(node, Call) or (isinstance(node, Binary) and node.operator.kind is OperatorKind.ARITHMETIC)


def _used(values: list[Value], chart: Chart) -> set[str]:
    used = {
        node.name
        for value in values
        if isinstance(value, Expression)
        for node in walk(value.tree)
        if isinstance(node, Name)
    }
    return used | _named(chart)


def _named(chart: Chart) -> set[str]:
    """The variables in attributes that contain a name instead of an expression."""
    named = {handler.child.value for state in chart.states for handler in state.handlers if handler.child}
    for statement in chart.statements:
        match statement:
            case ReturnStatus(status=name) | CallChild(child=name) if name is not None:
                named.add(name.value)
    return named


RULE = Rule("unused-variable", Severity.HINT, "A variable is never used.", machine=check, whole=True)
