# SPDX-License-Identifier: Apache-2.0
"""Hover texts for the parts of an expression that no model defines: functions, operators, event variables, statuses."""

from __future__ import annotations

from roaml.distributions.laws import LAWS
from roaml.expr.operators import FUNCTIONS
from roaml.expr.tree import Binary, Call, Conditional, Expr, Member, Unary, walk
from roaml.expr.tree import Name as NameExpr
from roaml.expr.types import Struct, Type
from roaml.ide.describe import language as describe_language
from roaml.ide.hover.place import Place
from roaml.model.machine import Handler, Machine
from roaml.model.value_types import bindings
from roaml.roles import ValuePart
from roaml.scxml.names import STATUSES
from roaml.text import Span


def in_expression(place: Place) -> tuple[Span, str] | None:
    """The description of the part of an expression at a place; `None` outside of expressions, or if there is none."""
    if place.expression is None:
        return None
    for node in reversed(walk(place.expression.tree)):
        described = _part(place, node)
        if described is not None and described[1]:
            return described
    return None


def _part(place: Place, node: Expr) -> tuple[Span, str] | None:
    offset = place.offset
    match node:
        case NameExpr(name="Math") if node.span.contains(offset):
            return node.span, describe_language.math()
        case NameExpr() if node.span.contains(offset):
            return node.span, _name(place, node.name)
        case Member(object=NameExpr(name="Math")) if node.name in FUNCTIONS and node.name_span.contains(offset):
            return Span(node.object.span.start, node.name_span.end), describe_language.function(FUNCTIONS[node.name])
        case Member(object=NameExpr(name="_event"), name="data") if node.name_span.contains(offset):
            event = _known(place).get("_event")
            data = event.member("data") if isinstance(event, Struct) else None
            return node.name_span, describe_language.event_data(data) if isinstance(data, Struct) else ""
        case Member(name="length") if node.name_span.contains(offset):
            return node.name_span, describe_language.length(place.text[node.object.span.start : node.object.span.end])
        case Call(function=NameExpr() as called) if called.name in LAWS and called.span.contains(offset):
            return called.span, describe_language.law(LAWS[called.name])
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


def _name(place: Place, name: str) -> str:
    known = _known(place)
    if name in known:
        return describe_language.event_variable(name, known[name])
    if "_bt" in known and name in STATUSES:
        return describe_language.status(name, STATUSES[name])
    return ""


def _known(place: Place) -> dict[str, Type]:
    """The event variables that are available at a place, with their types."""
    machine = place.analysis.machine(place.path)
    handler = handler_at(machine, place.offset) if machine else None
    if machine is None or handler is None:
        return {}
    is_condition = handler.cond is not None and handler.cond.span.contains(place.offset)
    part = ValuePart.COND if is_condition else ValuePart.BODY
    return bindings(handler, part, machine, place.analysis.environment(place.systems[0]))


def handler_at(machine: Machine, offset: int) -> Handler | None:
    """The transition or callback around a place; `None` if there is none."""
    for chart in machine.charts:
        for state in chart.states:
            if state.element.span.contains(offset):
                return next((h for h in state.handlers if h.element.span.contains(offset)), None)
    return None
