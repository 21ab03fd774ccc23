# SPDX-License-Identifier: Apache-2.0
"""The rule `constant-condition`, which constant_condition.md describes."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.infer import constant
from roaml.expr.operators import MIRRORED, Operator, OperatorKind, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Expr, Member, Name, String, Unary, walk
from roaml.expr.types import INTEGER_RANGES, Scalar
from roaml.facts import Facts
from roaml.forest.scripts import ScriptUse, parsed, scripts_of
from roaml.interruption import checkpoint
from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.knowledge import NOTHING, ConditionFacts, variables_in
from roaml.model.machine import Assign, Chart, Handler, If, RosSend, Send, SetOutput, State, Statement, bodies
from roaml.model.property_links import LinkedFile
from roaml.model.syntax import Expression
from roaml.model.syntax import Name as SyntaxName
from roaml.model.triggers import trigger
from roaml.model.value_types import ValuePlace, ValueUse, find_handle
from roaml.model.values.analyse import ChartValues, DataChannel, MachineValues, analyse, of_type
from roaml.model.values.arriving import arriving_by_type
from roaml.model.values.describe import described, is_informative
from roaml.model.values.domain import FALSE, MAX_LISTED, TRUE, Origin, ValueSet, exactly, joined
from roaml.model.values.evaluate import compared, place_of
from roaml.observers.properties import Pattern
from roaml.roles import ProtocolPart
from roaml.rules.rule import (
    MachineContext,
    PropertiesContext,
    Rule,
    TreeContext,
    close_names,
    replacements,
)
from roaml.rules.support.alternatives import guarded_statements
from roaml.rules.support.assignments import is_unchanged
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of
from roaml.rules.support.jani_formulas import constant_comparisons
from roaml.rules.support.message_constants import wrong_fields
from roaml.rules.support.steps import step_of
from roaml.script.tree import Comparison
from roaml.script.tree import walk as walk_script
from roaml.text import Decoded, Span, TextEdit

_FROM_SENDERS = {ProtocolPart.MESSAGE: "_msg.", ProtocolPart.EVENT: "_event.data."}
"""What machines send without being asked -> the beginning of the places of its data."""
_ASKED = {ProtocolPart.REQUEST: "_req.", ProtocolPart.GOAL: "_goal."}
"""What clients ask for -> the beginning of the places of its data."""

_CHOSEN = (*_FROM_SENDERS.values(), *_ASKED.values())

_CONDITIONS = (ValueUse.CONDITION, ValueUse.BRANCH)

_TOWARDS = {Operator.LESS: 1, Operator.LESS_EQUAL: 1, Operator.GREATER: -1, Operator.GREATER_EQUAL: -1}
"""An operator between a variable and a limit -> the sign of the steps that lead to the limit."""

MAX_TRIED = 8
"""The maximum number of conditions that are examined as the cause of the others."""

MAX_NAMED = 3
"""The maximum number of variables whose values a message states."""


class ConstantCondition(Facts, frozen=True):
    """What a condition always is."""

    is_true: bool


def check(context: MachineContext) -> Iterator[Finding]:
    findings = _findings(context, context.local_values)
    if len(findings) > 1:
        causes = _causes(context, findings)
        findings = {span: finding for span, finding in findings.items() if span in causes}
    for span, finding in findings.items():
        yield _at_step(context, span) or _at_target(context, span) or finding
    yield from _never_sent(context, findings.keys())
    yield from _beyond_type(context, findings.keys())
    yield from _decided_values(context)
    yield from _never_handled(context, findings.keys())


def _decided_values(context: MachineContext) -> Iterator[Finding]:
    """Report parts of Boolean values joined with `&&` or `||` that decide the value, because an assignment before them,
    in the same content, gives the variable a constant that it does not have elsewhere."""
    for chart in context.machine.charts:
        for _, _, body in bodies(chart):
            assigned: dict[str, Assign] = {}
            for statement in body:
                for value in _values_of(statement):
                    for node, part in _junctions(value.tree):
                        name = place_of(part)
                        before = assigned.get(name) if name is not None else None
                        last = before.value if before is not None else None
                        if before is None or not isinstance(last, Expression) or not isinstance(last.tree, Boolean):
                            continue
                        if last.tree.value is (node.operator is Operator.OR):
                            word = "true" if last.tree.value else "false"
                            message = (
                                f"this is always {word}, because `{name}` has just become {word}; use it before that "
                                "assignment"
                            )
                            related = [Related(before.element.name_span, f"becomes {word}")]
                            yield RULE.at(node.span, message, related=related)
                            break
                place = (
                    place_of(statement.location.tree) if isinstance(statement, Assign) and statement.location else None
                )
                if place is not None and isinstance(statement, Assign):
                    assigned[place] = statement
                elif isinstance(statement, If):
                    assigned.clear()


def _values_of(statement: Statement) -> Iterator[Expression]:
    """The values that a statement assigns or sends."""
    values: list[object] = []
    match statement:
        case Assign(value=value) | SetOutput(value=value):
            values = [value]
        case Send(params=params) | RosSend(fields=params):
            values = [param.value for param in params]
    yield from (value for value in values if isinstance(value, Expression) and not value.broken)


def _junctions(tree: Expr) -> Iterator[tuple[Binary, Expr]]:
    """The `&&` and `||` in `tree`, each with one of its parts."""
    for node in walk(tree):
        if isinstance(node, Binary) and node.operator in (Operator.AND, Operator.OR):
            yield node, node.left
            yield node, node.right


def _never_handled(context: MachineContext, reported: Collection[Span]) -> Iterator[Finding]:
    """Report handlers of a message whose conditions test the same Boolean field, if all machines send the same value in
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
                    yield RULE.at(cond.span, message)


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


def check_properties(file: LinkedFile) -> Iterator[Finding]:
    """Report comparisons in conditions of properties whose result is the same for all values of the type, and the
    comparisons with a number that is never sent, in conditions that are expected to hold at some time."""
    types = {variable.id: variable.type for port in file.ports for variable in port.variables}
    for written in file.file.properties:
        pattern = written.pattern.value if written.pattern is not None else ""
        limits = [limit for scope in written.scopes for limit in (scope.event, scope.until) if limit is not None]
        for expression in written.expressions:
            required = [] if expression.broken else list(_required(expression.tree))
            for conjunction, name in () if expression.broken else _contradictions(expression.tree):
                message = f"this is never true: the comparisons of `{name}` contradict each other; did you mean `||`?"
                yield RULE.at(conjunction.span, message)
            for node, name, number in () if expression.broken else _comparisons(expression.tree):
                type_ = types.get(name)
                if not isinstance(type_, Scalar) or type_.name not in INTEGER_RANGES:
                    continue
                by_type = _by_type(node, name, type_, number)
                known = file.values.get(name)
                if by_type is not None:
                    holds, message = by_type
                    # As a part, `x >= 0` states a range completely: `x >= 0 && x <= 9`.
                    is_range = holds and node is not expression.tree
                    yield RULE.at(node.span, message, severity=Severity.INFORMATION if is_range else None)
                elif (
                    (pattern in _OCCURRING or expression in limits or _is_part(pattern, expression.tree, node))
                    and any(node is part for part in required)
                    and known is not None
                    and known.value is None
                    and _never_holds(node, name, known, number)
                ):
                    sent = described(known, most=MAX_LISTED)
                    yield RULE.at(node.span, f"this comparison is never true: the values of `{name}` are {sent}")


def check_jani(context: PropertiesContext) -> Iterator[Finding]:
    """Report the same in properties in JANI."""
    for comparison in constant_comparisons(context):
        yield RULE.at(comparison.span, comparison.message)


def _is_part(pattern: str, tree: Expr, node: Binary) -> bool:
    """Whether a comparison is only a part of what must be absent. Alone, it may be a number that must not occur; beside
    other parts, it makes these superfluous."""
    return pattern == Pattern.ABSENCE.value and node is not tree and node.operator is Operator.EQUAL


_OCCURRING = frozenset(p.value for p in Pattern) - {Pattern.ABSENCE.value, Pattern.UNIVERSALITY.value}
"""The patterns whose conditions are expected to hold at some time."""


def _required(tree: Expr) -> Iterator[Expr]:
    """The parts of a condition without which it cannot hold: itself, and what it joins with `&&`."""
    yield tree
    if isinstance(tree, Binary) and tree.operator is Operator.AND:
        yield from _required(tree.left)
        yield from _required(tree.right)


def _contradictions(tree: Expr) -> Iterator[tuple[Expr, str]]:
    """The conjunctions in a condition whose comparisons of a variable with constants exclude each other, each with the
    name of the variable."""
    if not isinstance(tree, Binary) or tree.operator is not Operator.AND:
        for side in (tree.left, tree.right) if isinstance(tree, Binary) else ():
            yield from _contradictions(side)
        return
    allowed: dict[str, tuple[float, bool, float, bool]] = {}
    for part in _required(tree):
        for node, name, number in _comparisons(part) if isinstance(part, Binary) else ():
            operator = node.operator if isinstance(node.left, Name) else MIRRORED.get(node.operator)
            if node is not part or operator is None:
                continue
            low, open_low, high, open_high = allowed.get(name, (-math.inf, False, math.inf, False))
            if operator in (Operator.EQUAL, Operator.GREATER, Operator.GREATER_EQUAL):
                low, open_low = max((low, open_low), (number, operator is Operator.GREATER))
            if operator in (Operator.EQUAL, Operator.LESS, Operator.LESS_EQUAL):
                high, not_open = min((high, not open_high), (number, operator is not Operator.LESS))
                open_high = not not_open
            allowed[name] = low, open_low, high, open_high
    for name, (low, open_low, high, open_high) in allowed.items():
        if low > high or (low == high and (open_low or open_high)):
            yield tree, name
            return


def _comparisons(tree: Expr) -> Iterator[tuple[Binary, str, float]]:
    """The comparisons of a variable with a constant: each with the name of the variable and the constant."""
    for node in walk(tree):
        if isinstance(node, Binary) and node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER):
            for variable, other in ((node.left, node.right), (node.right, node.left)):
                number = constant(other)
                if isinstance(variable, Name) and number is not None:
                    yield node, variable.name, number


def _never_holds(node: Binary, name: str, known: ValueSet, number: float) -> bool:
    """Whether a comparison with a number is false for all values that are sent."""
    if node.operator is Operator.EQUAL:
        return known.only is not None and not known.includes(number)
    is_left = isinstance(node.left, Name) and node.left.name == name
    sides = (_reached(known), exactly(number)) if is_left else (exactly(number), _reached(known))
    return node.operator.kind is OperatorKind.ORDER and compared(node.operator, *sides) == FALSE


def _by_type(node: Binary, name: str, type_: Scalar, number: float) -> tuple[bool, str] | None:
    """The result of a comparison that is the same for all values of an integer type, and a message about it."""
    is_left = isinstance(node.left, Name) and node.left.name == name
    sides = (of_type(type_), exactly(number)) if is_left else (exactly(number), of_type(type_))
    result = compared(node.operator, *sides)
    if result.value is None:
        return None
    how = "always" if result == TRUE else "never"
    message = f"this comparison is {how} true: the values of `{type_}` are {described(of_type(type_))}"
    return result == TRUE, message


def _causes(context: MachineContext, findings: Mapping[Span, Finding]) -> Collection[Span]:
    """The conditions that are constant by themselves. Others are constant only because one of these is: a part that is
    never executed assigns no values."""
    arriving = arriving_by_type(context.machine, context.interface)

    def constant_without(ignored: frozenset[Span]) -> Collection[Span]:
        relaxed = analyse(context.machine, context.typed, arriving, ignored)
        return _findings(context, relaxed).keys() & findings.keys()

    causes = constant_without(frozenset(findings))
    if causes:
        return causes
    # Each one is constant because of another one: the cause is the one without which the fewest others are constant.
    tried = list(findings)[:MAX_TRIED]
    return (min(tried, key=lambda span: len(constant_without(frozenset((span,))))),)


def _beyond_type(context: MachineContext, reported: Collection[Span]) -> Iterator[Finding]:
    """Report comparisons of a variable with a constant that its type does not have."""
    for value in context.typed.values:
        tree = value.value.tree if isinstance(value.value, Expression) else None
        if tree is None or value.use not in _CONDITIONS or value.value.span in reported:
            continue
        types = context.typed.variables.get(value.place.chart.scope, {})
        for node, name, number in _comparisons(tree):
            type_ = types.get(name)
            if isinstance(type_, Scalar) and type_.name in INTEGER_RANGES:
                by_type = _by_type(node, name, type_, number)
                if by_type is not None:
                    yield RULE.at(node.span, by_type[1])


def _never_sent(context: MachineContext, reported: Collection[Span]) -> Iterator[Finding]:
    """Report comparisons with a text that no machine sends, if a similar one is sent and no text is ever equal. Other
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
                yield RULE.at(text.span, message, fix)


def _letters(text: str) -> str:
    return re.sub(r"\d", "", text)


def _numbers_never_sent(context: MachineContext, reported: Collection[Span]) -> Iterator[Finding]:
    """Report the comparisons of a field of a message or event with a constant whose result is the same for all numbers
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
                        yield from _compared_with_sent(context, chart, node, field, other, tree, sent)
                        continue
                    chosen, limited = stored[value.place.chart.scope]
                    if node.operator is Operator.EQUAL and value.use in _CONDITIONS:
                        yield from _never_chosen(context, value.place, chart, node, field, other, chosen)
                    elif node.operator.kind is OperatorKind.ORDER and place_of(field) in limited:
                        known = chart.at(field)
                        if known is not None:
                            yield from _compared_with_sent(context, chart, node, field, other, tree, known)


def _is_reported_at_sender(context: MachineContext, number: object) -> bool:
    """Whether unexpected-value reports that something else is sent instead of `number`."""
    if context.system is None or not isinstance(number, int | float):
        return False
    pairs = (wrong_fields(context.system, automaton).values() for automaton in context.automata)
    return any(missing == number for of_one in pairs for _, missing in of_one)


def _never_chosen(
    context: MachineContext,
    place: ValuePlace,
    chart: ChartValues,
    node: Binary,
    choice: Expr,
    other: Expr,
    stored: Collection[str],
) -> Iterator[Finding]:
    """Report that a field of a request or goal, or a variable of `stored`, is compared with a constant that it never
    has, although it has several values."""
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
        yield RULE.at(node.span, f"this comparison is never true: the values that machines send are {sent}")


def _compared_values(context: MachineContext, values: ChartValues, name: str) -> ValueSet:
    """The values of a variable in all conditions of a chart: earlier conditions exclude values in later ones."""
    trees = (v.value.tree for v in context.typed.values if v.use in _CONDITIONS and isinstance(v.value, Expression))
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


def _reached(values: ValueSet) -> ValueSet:
    """The values without the bounds that only widening or a type gives."""
    if values.only is not None:
        return values
    low = values.low if values.low_from is Origin.REACHED else -math.inf
    high = values.high if values.high_from is Origin.REACHED else math.inf
    return ValueSet(None, low, high, values.low_from, values.high_from)


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


def _compared_with_sent(
    context: MachineContext,
    chart: ChartValues,
    node: Binary,
    field: Expr,
    constant: Expr,
    tree: Expr,
    known: ValueSet,
) -> Iterator[Finding]:
    number = chart.at(constant)
    if number is None or number.value is None:
        return
    if known.value is not None:
        return  # machines that represent the environment often send one value only
    if node.operator is Operator.EQUAL and isinstance(constant, Name) and constant.name.isupper():
        return  # nor do they send all values of an enumeration, such as errors
    sides = (_reached(known), number) if field is node.left else (number, _reached(known))
    result = compared(node.operator, *sides)
    what = f"the values that machines send are {described(known)}"
    if result == FALSE:
        if not _is_reported_at_sender(context, number.value):
            yield RULE.at(node.span, f"this comparison is never true: {what}", facts=ConstantCondition(False))
    elif result == TRUE and node.operator is not Operator.NOT_EQUAL:
        conditions = chart.conditions.get(tree.span)
        if conditions is None or (node is tree and conditions.alone == TRUE):
            yield RULE.at(node.span, f"this comparison is always true: {what}", facts=ConstantCondition(True))


def _findings(context: MachineContext, machine: MachineValues) -> dict[Span, Finding]:
    """The findings by the places of the conditions."""
    findings: list[Finding] = []
    for chart in context.machine.charts:
        values = machine.charts.get(chart.scope)
        if values is None:
            continue
        facts = condition_facts(chart)
        unjudged = _unjudged(context, chart)
        for state in chart.states:
            for handlers in _groups(context, state):
                findings += _first(values, facts, [h.cond for h in handlers], "transition", unjudged)
        for statement in chart.statements:
            if isinstance(statement, If):
                findings += _first(values, facts, [b.cond for b in statement.branches], "branch", unjudged)
    return {finding.span: finding for finding in findings}


def _unjudged(context: MachineContext, chart: Chart) -> frozenset[str]:
    """The variables whose values are not a reason to report a condition: those that are assigned to themselves, which
    self-assignment reports and, in a machine without a system, which may not be finished, those that are never
    assigned."""
    assignments = [s for s in chart.statements if isinstance(s, Assign) and s.location is not None]
    unchanged = variables_in(s.location.tree for s in assignments if s.location is not None and is_unchanged(s))
    if context.system is not None:
        return unchanged
    assigned = variables_in(s.location.tree for s in assignments if s.location is not None)
    return unchanged | {data.id.value for data in chart.data if data.id and data.id.value not in assigned}


def _groups(context: MachineContext, state: State) -> Iterable[list[Handler]]:
    """The handlers of a state, grouped by their triggers."""
    groups: dict[object, list[Handler]] = {}
    for number, handler in enumerate(state.handlers):
        if handler.effective:
            key = trigger(context.machine, handler)
            groups.setdefault(number if key is None else key, []).append(handler)
    return groups.values()


def _first(
    values: ChartValues,
    facts: ConditionFacts,
    conditions: Iterable[Expression | None],
    what: str,
    unjudged: frozenset[str],
) -> Iterator[Finding]:
    """Report the conditions that are never true, up to the first one that is always true: the conditions after it are
    not tested."""
    for cond in conditions:
        names = variables_in((cond.tree,)) if cond is not None else frozenset()
        if cond is None or cond.broken or not names:
            continue
        results = values.conditions.get(cond.span)
        if results is None:
            continue
        contradicts = not any(facts.assume(NOTHING, cond.tree))
        if names & unjudged and not contradicts:
            continue
        if results.alone == FALSE or contradicts:
            effect = "transition is never taken" if what == "transition" else "branch is never executed"
            why = _why(values, cond.tree) or ("its parts contradict each other" if contradicts else "")
            message = f"this condition is never true{_because(why)}, so the {effect}"
            yield RULE.at(cond.span, message, facts=ConstantCondition(False))
        elif results.alone == TRUE:
            why = _why(values, cond.tree)
            after = "has no effect; later ones are never tested"
            message = f"this condition is always true{_because(why)}, so it {after}"
            yield RULE.at(cond.span, message, facts=ConstantCondition(True))
            return


def _at_step(context: MachineContext, span: Span) -> Finding | None:
    """The finding about a condition at `span` that is always true because what it allows leads away from its limit."""
    for chart in context.machine.charts:
        values = context.local_values.charts.get(chart.scope)
        known = values.conditions.get(span) if values is not None else None
        for cond, body in guarded_statements(chart) if known is not None and known.alone == TRUE else ():
            away = _step_away(cond.tree, body) if cond.span == span else None
            if values is not None and away is not None and _begins_beyond(values, cond.tree):
                where, name, how = away
                text = " ".join(cond.text.split())
                message = f"`{name}` only {how} here, so the condition `{text}` is always true"
                why = _because(_why(values, cond.tree))
                return RULE.at(where, f"{message}{why}; change one of them", related=[Related(span, "always true")])
    return None


def _at_target(context: MachineContext, span: Span) -> Finding | None:
    """The finding about a condition at `span` that is constant because a handler assigns another value to a variable of
    the condition and then does not go to its state, as another handler with such an assignment does."""
    for chart in context.machine.charts:
        values = context.local_values.charts.get(chart.scope)
        known = values.conditions.get(span) if values is not None else None
        reader = next((s for s in chart.states if s.id is not None and s.element.span.contains(span.start)), None)
        cond = next((cond for cond, _ in guarded_statements(chart) if cond.span == span), None)
        if values is None or known is None or reader is None or reader.id is None or cond is None:
            continue
        own = reader.id.value
        for node in walk(cond.tree):
            only = values.at(node) if isinstance(node, Name) else None
            if not isinstance(node, Name) or only is None or only.value is None:
                continue
            for state in chart.states:
                lost, right = _leading(values, state, node.name, only.value, own)
                if len(lost) != 1 or not right or state is reader:
                    continue
                target, assigned = lost[0]
                text = " ".join(cond.text.split())
                how = "always" if known.alone == TRUE else "never"
                message = (
                    f"`{node.name}` gets a new value here, but this goes to `{target.value}` instead of `{own}`, so "
                    f"the condition `{text}` in `{own}` is {how} true; did you mean `{own}`?"
                )
                related = [
                    Related(assigned.element.name_span, "assigned here"),
                    Related(right[0].span, f"goes to `{own}`"),
                    Related(span, f"{how} true"),
                ]
                return RULE.at(target.span, message, *replacements(target.span, (own,)), related=related)
    return None


def _leading(
    values: ChartValues, state: State, name: str, only: object, reader: str
) -> tuple[list[tuple[SyntaxName, Assign]], list[SyntaxName]]:
    """Of the handlers of a state that assign a constant to the variable `name`: the targets other than `reader` of
    those that assign another value than `only`, with the assignments, and the targets that are `reader`. The former
    handle something of the same interface as one of the latter."""
    lost: list[tuple[SyntaxName, Assign, str]] = []
    right: dict[str, SyntaxName] = {}
    for handler in state.handlers:
        handle = handler.handle.value if handler.handle is not None else ""
        for target in handler.targets if handle else ():
            for statement in target.body:
                if not isinstance(statement, Assign) or statement.location is None or target.state is None:
                    continue
                value = values.at(statement.value.tree) if isinstance(statement.value, Expression) else None
                if place_of(statement.location.tree) != name or value is None or value.value is None:
                    continue
                if target.state.value == reader:
                    right.setdefault(handle, target.state)
                elif value.value != only:
                    lost.append((target.state, statement, handle))
    return [(target, assigned) for target, assigned, handle in lost if handle in right], [*right.values()]


def _begins_beyond(values: ChartValues, tree: Expr) -> bool:
    """Whether the variable that `tree` compares with a limit never has the limit itself as a value. If it begins there,
    the comparison is probably wrong, not the step."""
    sides = (values.at(tree.left), values.at(tree.right)) if isinstance(tree, Binary) else (None, None)
    known, limit = sides[0], sides[1].value if sides[1] is not None else None
    return known is not None and limit is not None and not known.includes(limit)


def _step_away(tree: Expr, body: Sequence[Statement]) -> tuple[Span, str, str] | None:
    """The place of the only assignment in `body` to the variable that `tree` compares with a limit, its name, and what
    happens to it, if the assignment leads away from the limit: the step then has the wrong sign."""
    if not isinstance(tree, Binary) or tree.operator not in _TOWARDS or not isinstance(tree.left, Name):
        return None
    name = tree.left.name
    assigned = [s for s in body if isinstance(s, Assign) and s.location and place_of(s.location.tree) == name]
    value = assigned[0].value if len(assigned) == 1 else None
    if not isinstance(value, Expression) or step_of(value.tree, name) != -_TOWARDS[tree.operator]:
        return None
    return value.span, name, "grows" if _TOWARDS[tree.operator] < 0 else "falls"


def _because(why: str) -> str:
    return f": {why}" if why else ""


def _why(values: ChartValues, tree: Expr) -> str:
    """The values of the variables in a condition, where the values are known."""
    texts: dict[str, None] = {}
    for node in walk(tree):
        place = place_of(node) if isinstance(node, Name | Member) else None
        known = values.at(node) if place is not None else None
        if place is not None and known is not None and is_informative(known):
            texts[f"`{place}` is {'always ' if known.value is not None else ''}{described(known)}"] = None
    return ", ".join(list(texts)[:MAX_NAMED])


def check_trees(context: TreeContext) -> Iterator[Finding]:
    """Report conditions in scripts whose result is the same for all values that scripts assign to their entries."""
    forest = trees_of(context)
    uses = [use for _, node in forest.own_nodes for use in scripts_of(forest, node)] if forest is not None else []
    conditions = [use for use in uses if use.is_condition]
    if forest is None or not conditions:
        return
    from roaml.forest.script_values import condition_results  # noqa: PLC0415 - few trees contain conditions

    results = condition_results(forest, entries_of(forest))
    for use in conditions:
        result = results.get((use.node, use.attribute.name))
        if result is None or len(result.truth) != 1 or not result.values:
            continue
        (holds,) = result.truth
        skips = _SKIPPING.get(use.attribute.name) is holds
        is_setting = all(values.value is not None for values in result.values.values())
        if not skips and (is_setting or use.attribute.name not in _SKIPPING or not _compares_equal(use)):
            continue
        known = {name: values for name, values in result.values.items() if is_informative(values)}
        why = ", ".join(
            f"`{name}` is {'always ' if values.value is not None else ''}{described(values)}"
            for name, values in list(known.items())[:MAX_NAMED]
        )
        effect = "the node is never ticked" if skips else "it has no effect"
        message = f"this condition is {'always' if holds else 'never'} true{_because(why)}, so {effect}"
        yield RULE.at(use.attribute.value_span, message, facts=ConstantCondition(holds))


def _compares_equal(use: ScriptUse) -> bool:
    """Whether a script compares with `==`. An order that never holds often only excludes impossible values."""
    script, _ = parsed(Decoded(use.attribute.value, 0))
    return any(isinstance(part, Comparison) and "==" in part.operators for part in walk_script(script))


_SKIPPING = {"_skipIf": True, "_failureIf": True, "_successIf": True, "_while": False}
"""Conditions of a node -> the result with which the node is not ticked."""


RULE = Rule(
    "constant-condition",
    Severity.WARNING,
    "A condition is always true or never true.",
    machine=check,
    tree=check_trees,
    properties=check_jani,
    xml_properties=check_properties,
    whole=True,
    facts=ConstantCondition,
)
