# SPDX-License-Identifier: Apache-2.0
"""Hover texts for the parts of an expression that are not names: functions, operators, event variables."""

from __future__ import annotations

from roaml.expr.operators import FUNCTIONS
from roaml.expr.tree import Binary, Conditional, Expr, Member, Unary, walk
from roaml.expr.tree import Name as NameExpr
from roaml.expr.types import Struct, Type
from roaml.ide.describe import language as describe_language
from roaml.ide.names.lookup import systems_of
from roaml.ide.syntax import XmlFile, expression_at
from roaml.model.machine import Handler, Machine
from roaml.model.value_types import STATUSES, bindings
from roaml.project.analysis import Analysis
from roaml.text import Span


def in_expression(analysis: Analysis, path: str, file: XmlFile, offset: int) -> tuple[Span, str] | None:
    """The description of a part of an expression; `None` outside of expressions and if there is none."""
    expression = expression_at(file, offset)
    if expression is None:
        return None
    for node in reversed(walk(expression.tree)):
        found = _part(analysis, path, node, offset, expression.span)
        if found is not None and found[1]:
            return found
    return None


def _part(analysis: Analysis, path: str, node: Expr, offset: int, around: Span) -> tuple[Span, str] | None:
    match node:
        case NameExpr(name="Math") if node.span.contains(offset):
            return node.span, describe_language.math()
        case NameExpr() if node.span.contains(offset):
            return node.span, _name(analysis, path, node.name, offset)
        case Member(object=NameExpr(name="Math")) if node.name in FUNCTIONS and node.name_span.contains(offset):
            return Span(node.object.span.start, node.name_span.end), describe_language.function(FUNCTIONS[node.name])
        case Member(object=NameExpr(name="_event"), name="data") if node.name_span.contains(offset):
            event = _known(analysis, path, offset).get("_event")
            data = event.member("data") if isinstance(event, Struct) else None
            return node.name_span, describe_language.event_data(data) if isinstance(data, Struct) else ""
        case Member(name="length") if node.name_span.contains(offset):
            return node.name_span, describe_language.length(_text(analysis, path, node.object.span))
        case Binary() if node.operator_span.contains(offset):
            return node.operator_span, describe_language.operator(node.operator)
        case Unary() if node.span.start <= offset < node.operand.span.start:
            return Span(node.span.start, node.operand.span.start), describe_language.operator(node.operator)
        case Conditional() if any(
            left.span.end <= offset < right.span.start
            for left, right in ((node.test, node.then), (node.then, node.otherwise))
        ):
            return node.span, describe_language.conditional()
    return None


def _text(analysis: Analysis, path: str, span: Span) -> str:
    source = analysis.source(path)
    return source.text[span.start : span.end] if source else ""


def _name(analysis: Analysis, path: str, name: str, offset: int) -> str:
    known = _known(analysis, path, offset)
    if name in known:
        return describe_language.event_variable(name, known[name])
    if "_bt" in known and name in STATUSES:
        return describe_language.status(name, STATUSES[name])
    return ""


def _known(analysis: Analysis, path: str, offset: int) -> dict[str, Type]:
    """The event variables available at a place."""
    machine = analysis.machine(path)
    handler = handler_at(machine, offset) if machine else None
    if machine is None or handler is None:
        return {}
    part = "cond" if handler.cond is not None and handler.cond.span.contains(offset) else "body"
    return bindings(handler, part, machine, analysis.environment(systems_of(analysis, path)[0]))


def handler_at(machine: Machine, offset: int) -> Handler | None:
    """The transition or callback around a place."""
    for chart in machine.charts:
        for state in chart.states:
            if state.element.span.contains(offset):
                return next((h for h in state.handlers if h.element.span.contains(offset)), None)
    return None
