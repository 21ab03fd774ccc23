# SPDX-License-Identifier: Apache-2.0
"""Comparisons with the values that other machines send, whose results are constant."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping

from roaml.diagnostics import Fix, Severity
from roaml.expr.operators import Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import Binary, Expr, Name, String, Unary, walk
from roaml.interruption import checkpoint
from roaml.model.machine import Assign, Chart, Handler
from roaml.model.syntax import Expression
from roaml.model.value_types import CONDITIONS, ValuePlace, find_handle
from roaml.model.values.analyse import ChartValues, DataChannel
from roaml.model.values.describe import described
from roaml.model.values.domain import FALSE, MAX_LISTED, TRUE, ValueSet, interval, joined
from roaml.model.values.evaluate import compared, place_of
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, close_names
from roaml.rules.support.compared_numbers import reached
from roaml.rules.support.constant_conditions import ConstantPart
from roaml.rules.support.message_constants import wrong_fields
from roaml.rules.support.ranges import is_validation, pairs
from roaml.rules.support.received_lengths import length_never_sent
from roaml.text import Span, TextEdit

_FROM_SENDERS = {ProtocolPart.MESSAGE: "_msg.", ProtocolPart.EVENT: "_event.data."}
"""What machines send without being asked -> the beginning of the places of its data."""


_ASKED = {ProtocolPart.REQUEST: "_req.", ProtocolPart.GOAL: "_goal."}
"""What clients ask for -> the beginning of the places of its data."""


_CHOSEN = (*_FROM_SENDERS.values(), *_ASKED.values())


def never_sent(context: MachineContext, reported: Collection[Span]) -> Iterator[ConstantPart]:
    """The comparisons with a text that no machine sends, if a similar one is sent and no text is ever equal. Other
    conditions that no message of the system makes true are not reported, because machines of the environment often
    answer in one way only."""
    yield from _numbers_never_sent(context, reported)
    compared: dict[tuple[Chart, str], list[tuple[String, ValueSet]]] = {}
    for value in context.typed.values:
        chart = context.values.charts.get(value.place.chart.scope)
        tree = value.value.tree if isinstance(value.value, Expression) else None
        if chart is None or tree is None or value.value.span in reported:
            continue
        for node in walk(tree):
            if isinstance(node, Binary) and node.operator in (Operator.EQUAL, Operator.NOT_EQUAL):
                for text, other in ((node.left, node.right), (node.right, node.left)):
                    known, place = chart.at(other), place_of(other)
                    if isinstance(text, String) and place is not None and known is not None:
                        compared.setdefault((value.place.chart, place), []).append((text, known))
    for (_, place), comparisons in compared.items():
        is_sent = any(known.includes(text.value) for text, known in comparisons)
        for text, known in comparisons:
            if known.includes(text.value):
                continue
            close = close_names(text.value, [sent for sent in known.only or () if isinstance(sent, str)])
            if is_sent:  # other texts differ in a number: they name similar things
                close = tuple(sent for sent in close if _letters(sent) != _letters(text.value))
            if close:
                message = f"`{place}` is never `'{text.value}'`; did you mean `'{close[0]}'`?"
                quote = context.source.text[text.span.start]
                fix = Fix(f"Change to `'{close[0]}'`", (TextEdit(text.span, f"{quote}{close[0]}{quote}"),))
                yield ConstantPart(text.span, message, fixes=(fix,))


def _letters(text: str) -> str:
    return re.sub(r"\d", "", text)


def _numbers_never_sent(context: MachineContext, reported: Collection[Span]) -> Iterator[ConstantPart]:
    """The comparisons of a field of a message or event with a constant whose result is the same for all numbers
    that machines send."""
    stored = {
        chart.scope: (_received_variables(chart, _CHOSEN), _received_variables(chart, (*_CHOSEN, "_res.")))
        for chart in context.machine.charts
    }
    for value in context.typed.values:
        checkpoint()
        chart = context.values.charts.get(value.place.chart.scope)
        tree = value.value.tree if isinstance(value.value, Expression) else None
        if chart is None or tree is None or value.value.span in reported:
            continue
        for node in walk(tree):
            if isinstance(node, Binary) and node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER):
                for field, other in ((node.left, node.right), (node.right, node.left)):
                    sent = _sent(context, value.place.handler, field, _FROM_SENDERS)
                    if sent is not None:
                        yield from _compared_with_sent(context, value.place, chart, node, field, other, tree, sent)
                        continue
                    chosen, limited = stored[value.place.chart.scope]
                    if (message := length_never_sent(chart, node, field, chosen)) is not None:
                        yield ConstantPart(node.span, message)
                    elif node.operator is Operator.EQUAL and value.use in CONDITIONS:
                        yield from _never_chosen(context, value.place, chart, node, field, other, chosen)
                    elif node.operator.kind is OperatorKind.ORDER and place_of(field) in limited:
                        known = chart.at(field)
                        if known is not None:
                            yield from _compared_with_sent(context, value.place, chart, node, field, other, tree, known)


def _is_reported_at_sender(context: MachineContext, number: object) -> bool:
    """Whether unexpected-value reports that something else is sent instead of `number`."""
    if context.system is None or not isinstance(number, int | float):
        return False
    pairs = (wrong_fields(context.system, automaton).values() for automaton in context.automata)
    return any(missing == number for of_one in pairs for _, missing in of_one)


def _compared_with_sent(
    context: MachineContext,
    place: ValuePlace,
    chart: ChartValues,
    node: Binary,
    field: Expr,
    constant: Expr,
    tree: Expr,
    known: ValueSet,
) -> Iterator[ConstantPart]:
    number = chart.at(constant)
    if number is None or number.value is None:
        return
    if known.value is not None:
        return  # machines that represent the environment often send one value only
    if isinstance(number.value, str):
        return  # a text that is like no other is a guard against texts of other machines; `never_sent` finds the others
    if node.operator is Operator.EQUAL and _names_all_sent(context, place, chart, node, field, known):
        return  # what is sent is distinguished already, so the comparison is a guard against other numbers
    if node.operator is Operator.EQUAL and isinstance(constant, Name) and constant.name.isupper():
        return  # nor do they send all values of an enumeration, such as errors
    sides = (reached(known), number) if field is node.left else (number, reached(known))
    result = compared(node.operator, *sides)
    what = f"the values that machines send are {described(known)}"
    if result == FALSE:
        if not _is_reported_at_sender(context, number.value) and not _is_highest_level(
            context, place, chart, node, field
        ):
            severity = Severity.INFORMATION if is_validation(tree, node, place.handler) else None
            message = f"this comparison is never true: {what}"
            yield ConstantPart(node.span, message, is_true=False, severity=severity)
    elif result == TRUE and node.operator is not Operator.NOT_EQUAL:
        if any(node is limit.node for pair in pairs(tree, Operator.AND) for limit in pair):
            return  # a part of a range, as in a comparison with a tolerance
        conditions = chart.conditions.get(tree.span)
        if conditions is None or (node is tree and conditions.alone == TRUE):
            yield ConstantPart(node.span, f"this comparison is always true: {what}", is_true=True)


def _names_all_sent(
    context: MachineContext, place: ValuePlace, values: ChartValues, node: Binary, field: Expr, known: ValueSet
) -> bool:
    """Whether other comparisons with the same field name each number that machines send."""
    name = place_of(field)
    named: set[object] = set()
    for other in _comparisons(context, place):
        for side, constant in ((other.left, other.right), (other.right, other.left)):
            number = values.at(constant)
            if other is not node and other.operator is Operator.EQUAL and place_of(side) == name and number is not None:
                named.add(number.value)
    return bool(known.only) and named >= set(known.only or ())


def _is_highest_level(
    context: MachineContext, place: ValuePlace, values: ChartValues, node: Binary, field: Expr
) -> bool:
    """Whether an order that never holds is one of several levels, of which another one can be reached: the environment
    of a model often does not reach the level of an emergency. A level that is missed by at most 1 may be a mistake."""
    name, is_upper = place_of(field), _is_upper_limit(node, field)
    met, level = values.at(field), values.at(node.right if field is node.left else node.left)
    if met is None or level is None or not isinstance(level.value, int | float):
        return False
    if (level.value - interval(met).high if is_upper else interval(met).low - level.value) <= 1:
        return False
    for other in _comparisons(context, place):
        for side, limit in ((other.left, other.right), (other.right, other.left)):
            if other is node or name is None or place_of(side) != name or other.operator.kind is not OperatorKind.ORDER:
                continue
            known, number = values.at(side), values.at(limit)
            if _is_upper_limit(other, side) is not is_upper or known is None or number is None or number.value is None:
                continue
            sides = (reached(known), number) if side is other.left else (number, reached(known))
            if compared(other.operator, *sides) != FALSE:
                return True
    return False


def _comparisons(context: MachineContext, place: ValuePlace) -> Iterator[Binary]:
    """The operations with two sides in the conditions of the chart that contains `place`."""
    for value in context.typed.values:
        if value.use in CONDITIONS and value.place.chart is place.chart and isinstance(value.value, Expression):
            yield from (node for node in walk(value.value.tree) if isinstance(node, Binary))


def _is_upper_limit(node: Binary, field: Expr) -> bool:
    """Whether a comparison holds for great values of one of its sides."""
    return (node.operator in (Operator.GREATER, Operator.GREATER_EQUAL)) is (field is node.left)


def _never_chosen(
    context: MachineContext,
    place: ValuePlace,
    chart: ChartValues,
    node: Binary,
    choice: Expr,
    other: Expr,
    stored: Collection[str],
) -> Iterator[ConstantPart]:
    """A part in which a field of a request or goal, or a variable of `stored`, is compared with a constant that it
    never has, although it has several values."""
    number = chart.at(other)
    known = _sent(context, place.handler, choice, _ASKED)
    if known is None and isinstance(choice, Name) and choice.name in stored:
        known = _compared_values(context, chart, choice.name)
    if number is None or number.value is None or known is None or known.only is None or known.value is not None:
        return
    if known.only and not known.includes(number.value) and not isinstance(number.value, str | bool):
        if _is_reported_at_sender(context, number.value):
            return
        sent = described(known, most=MAX_LISTED)
        yield ConstantPart(node.span, f"this comparison is never true: the values that machines send are {sent}")


def _compared_values(context: MachineContext, values: ChartValues, name: str) -> ValueSet:
    """The values of a variable in all conditions of a chart: earlier conditions exclude values in later ones."""
    trees = (v.value.tree for v in context.typed.values if v.use in CONDITIONS and isinstance(v.value, Expression))
    names = (n for tree in trees for n in walk(tree) if isinstance(n, Name) and n.name == name)
    return joined(known for n in names if (known := values.at(n)) is not None)


def _received_variables(chart: Chart, prefixes: tuple[str, ...]) -> frozenset[str]:
    """The variables to which all assignments store a received field as it is, whose place begins with a prefix."""
    stores: dict[str, bool] = {}
    for statement in chart.statements:
        name = place_of(statement.location.tree) if isinstance(statement, Assign) and statement.location else None
        if name is not None and isinstance(statement, Assign):
            place = place_of(statement.value.tree) if isinstance(statement.value, Expression) else None
            stores[name] = stores.get(name, True) and place is not None and place.startswith(prefixes)
    return frozenset(name for name, is_received in stores.items() if is_received)


def never_handled(context: MachineContext, reported: Collection[Span]) -> Iterator[ConstantPart]:
    """The handlers of a message whose conditions test the same Boolean field, if all machines send the same value in
    it, with which none of the handlers does anything."""
    for chart in context.machine.charts:
        groups: dict[str, list[tuple[Handler, ValueSet | None]]] = {}
        for handler in (handler for state in chart.states for handler in state.handlers):
            if handler.trigger is ProtocolPart.MESSAGE and handler.handle is not None:
                groups.setdefault(handler.handle.value, []).append((handler, _holds_for_sent(context, handler)))
        for handlers in groups.values():
            if all(holds == FALSE for _, holds in handlers):
                cond = handlers[0][0].cond
                if cond is not None and cond.span not in reported:
                    sent = "true" if isinstance(cond.tree, Unary) else "false"
                    message = (
                        f"this condition is never true, and nothing else handles the message: the only value that "
                        f"machines send is {sent}"
                    )
                    yield ConstantPart(cond.span, message)


def _holds_for_sent(context: MachineContext, handler: Handler) -> ValueSet | None:
    """The result of a condition that is a Boolean field of a message, or its negation, for the only value that machines
    send in the field; `None` for other conditions and if several values are sent."""
    tree = handler.cond.tree if handler.cond is not None and not handler.cond.broken else None
    is_negated = isinstance(tree, Unary) and tree.operator is UnaryOperator.NOT
    field = tree.operand if isinstance(tree, Unary) else tree
    known = _sent(context, handler, field, _FROM_SENDERS) if field is not None else None
    if known is None or not isinstance(known.value, bool):
        return None
    return FALSE if known.value is is_negated else TRUE


def _sent(
    context: MachineContext, handler: Handler | None, field: Expr, parts: Mapping[ProtocolPart, str]
) -> ValueSet | None:
    """The values of a field of one of the `parts` that machines send; `None` for other expressions."""
    place = place_of(field)
    prefix = parts.get(handler.trigger) if handler is not None and handler.trigger is not None else None
    if handler is None or handler.trigger is None or prefix is None or place is None or not place.startswith(prefix):
        return None
    declaration = find_handle(context.machine, handler)
    name = declaration.handle if declaration is not None else handler.event
    fields = context.values.arriving.get(DataChannel(handler.trigger, name.value if name is not None else ""), {})
    return fields.get(place.removeprefix(prefix))
