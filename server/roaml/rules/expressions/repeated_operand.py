# SPDX-License-Identifier: Apache-2.0
"""The rule `repeated-operand`, which repeated_operand.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.format import format_expr
from roaml.expr.infer import constant
from roaml.expr.operators import Operator, OperatorKind
from roaml.expr.tree import Binary, Expr, is_draw, walk
from roaml.jani import expressions as jani
from roaml.jani.operators import BinaryOperator, Signature
from roaml.jani.properties import BinaryFormula, Formula
from roaml.jani.properties import walk as walk_formula
from roaml.model.property_file import WrittenProperty, WrittenScope
from roaml.model.property_links import LinkedFile
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.observers.properties import Pattern, ScopeKind
from roaml.rules.rule import MachineContext, PropertiesContext, Rule
from roaml.rules.support.compared_numbers import required
from roaml.text import Span

_JOINING = (Operator.AND, Operator.OR)

_JOINING_IN_JANI = (BinaryOperator.AND, BinaryOperator.OR)
_COMPARING = (Signature.EQUALITY, Signature.ORDER)
_CONSTANTS = (jani.Integer, jani.Real)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the operands of `&&` and `||` that an earlier operand repeats, in the expressions of a machine."""
    for value in context.typed.values:
        if isinstance(value.value, Expression) and not value.value.broken:
            yield from _repeated(value.value.tree)
            yield from _equal_twice(value.value.tree)


def _equal_twice(tree: Expr) -> Iterator[Finding]:
    """Report a field that must be equal to a number and, in the same chain of `&&`, to something else: it is then the
    other one that is compared with the number."""
    nested: set[int] = set()
    for node in walk(tree):
        if not isinstance(node, Binary) or node.operator is not Operator.AND or id(node) in nested:
            continue
        numbers: dict[str, Expr] = {}
        others: dict[str, Expr] = {}
        for operand in _operands(node, nested):
            if isinstance(operand, Binary) and operand.operator is Operator.EQUAL:
                for tested, other in ((operand.left, operand.right), (operand.right, operand.left)):
                    place = place_of(tested)
                    if place is not None and place.startswith("_"):
                        (others if constant(other) is None else numbers).setdefault(place, operand)
        for place in sorted(numbers.keys() & others.keys()):
            message = f"`{place}` must also be equal to something else in this `&&`; did you mean another field?"
            yield RULE.at(numbers[place].span, message, related=[Related(others[place].span, "compared here, too")])


def check_properties(file: LinkedFile) -> Iterator[Finding]:
    """Report the same in the conditions of properties in XML, and patterns whose two events are the same."""
    for written in file.file.properties:
        events = [condition for condition in written.conditions if not condition.broken]
        if len(events) == 2 and format_expr(events[0].tree) == format_expr(events[1].tree):
            message = (
                "this is also the first event of the property, so the pattern decides nothing; did you mean another?"
            )
            yield RULE.at(events[1].span, message, related=[Related(events[0].span, "the same event")])
        elif len(events) == 2:
            yield from _implied(written, events)
        for scope in written.scopes:
            yield from _never_begun(scope)
            yield from _decided_by_scope(written, scope, events)
        for expression in written.expressions:
            if not expression.broken:
                yield from _repeated(expression.tree)
                yield from _compared_with_itself(expression.tree)


def _implied(written: WrittenProperty, events: Sequence[Expression]) -> Iterator[Finding]:
    """Report a response that its own cause implies, and a precedence that its own effect implies."""
    pattern = written.pattern.value if written.pattern is not None else ""
    if pattern not in _ORDERED or any(interval.after is not None for interval in written.intervals):
        return
    cause, answer = events if pattern == Pattern.RESPONSE.value else (events[1], events[0])
    if _parts(answer) <= _parts(cause):
        message = (
            "this always holds when the other event of the property happens, so the pattern decides nothing; did you "
            "mean another?"
        )
        yield RULE.at(answer.span, message, related=[Related(cause.span, "the event that contains it")])


def _never_begun(scope: WrittenScope) -> Iterator[Finding]:
    """Report a scope whose end holds whenever its begin does: it begins only where its end does not hold."""
    event, until = scope.event, scope.until
    if event is None or until is None or event.broken or until.broken:
        return
    if _parts(until) <= _parts(event):
        message = "this always holds when the scope would begin, so the scope never begins; did you mean another event?"
        yield RULE.at(until.span, message, related=[Related(event.span, "the begin of the scope")])


def _decided_by_scope(written: WrittenProperty, scope: WrittenScope, events: Sequence[Expression]) -> Iterator[Finding]:
    """Report a scope that ends before its event could happen in it, and one that begins with the event that must exist
    in it."""
    pattern = written.pattern.value if written.pattern is not None else ""
    kind = scope.type.value if scope.type is not None else ""
    if pattern not in (Pattern.ABSENCE.value, Pattern.EXISTENCE.value) or len(events) != 1:
        return
    is_absence = pattern == Pattern.ABSENCE.value
    is_late = any(interval.after is not None for interval in written.intervals)
    begin, end = (None, scope.event) if kind in _FROM_START else (scope.event, scope.until)
    if end is not None and not end.broken and _parts(end) <= _parts(events[0]):
        effect = f"so the property {'always' if is_absence else 'never'} holds; did you mean another?"
        message = f"the scope ends before the event of the property, {effect}"
        yield RULE.at(end.span, message, related=[Related(events[0].span, "the event that contains it")])
    elif begin is not None and not begin.broken and not is_late and _parts(events[0]) <= _parts(begin):
        effect = f"so the property {'never' if is_absence else 'always'} holds; did you mean another?"
        message = f"the scope begins with this event, {effect}"
        yield RULE.at(events[0].span, message, related=[Related(begin.span, "the begin of the scope")])


def _parts(condition: Expression) -> set[str]:
    """The texts of the parts that a condition joins with `&&`."""
    parts = list(required(condition.tree))
    return {format_expr(part) for part in parts if not (isinstance(part, Binary) and part.operator is Operator.AND)}


def _compared_with_itself(tree: Expr) -> Iterator[Finding]:
    for node in walk(tree):
        if isinstance(node, Binary) and node.operator.kind in (OperatorKind.EQUALITY, OperatorKind.ORDER):
            left, right = format_expr(node.left), format_expr(node.right)
            if left == right:
                message = f"`{left}` is compared with itself; did you mean another?"
                yield RULE.at(node.right.span, message, related=[Related(node.left.span, "the same operand")])


_FROM_START = (ScopeKind.BEFORE.value, ScopeKind.UNTIL.value)
"""The scopes that begin at the start of the trace and end with their only event."""
_ORDERED = (Pattern.RESPONSE.value, Pattern.PRECEDENCE.value)


def check_jani(context: PropertiesContext) -> Iterator[Finding]:
    """Report the same in properties in JANI, where the operators are `∧` and `∨`."""
    for property_ in context.properties:
        nested: set[int] = set()
        for node in walk_formula(property_.expression):
            if isinstance(node, jani.Binary) and node.operator.signature in _COMPARING and node.left == node.right:
                yield from _same_sides(context, node)
            if _joining(node) is None or id(node) in nested:
                continue
            first: dict[str, tuple[Formula, Span]] = {}
            operands = list(_operands_in_jani(node, nested))
            if _joining(node) == BinaryOperator.AND.symbol:
                yield from _equal_to_several(context, operands)
            for operand in operands:
                if operand.origin is None:
                    continue
                span = operand.origin.span
                # Equal operands have equal texts, so that few of them are compared.
                text = "".join(context.source.text[span.start : span.end].split())
                earlier, place = first.setdefault(text, (operand, span))
                if earlier is not operand and earlier == operand:
                    yield _finding(span, place, str(_joining(node)), "this operand")


def _same_sides(context: PropertiesContext, node: jani.Binary) -> Iterator[Finding]:
    if node.left.origin is not None and node.right.origin is not None:
        left, right = node.left.origin.span, node.right.origin.span
        message = f"`{context.source.text[right.start : right.end]}` is compared with itself; did you mean another?"
        yield RULE.at(right, message, related=[Related(left, "the same operand")])


def _equal_to_several(context: PropertiesContext, operands: Sequence[Formula]) -> Iterator[Finding]:
    """Report an operand of a chain of `∧` that requires another constant for what an earlier one has compared."""
    first: dict[jani.Expression, tuple[object, Span]] = {}
    for operand in operands:
        if not isinstance(operand, jani.Binary) or operand.operator is not BinaryOperator.EQUAL:
            continue
        for tested, other in ((operand.left, operand.right), (operand.right, operand.left)):
            place = tested.origin.span if tested.origin is not None else None
            if place is None or isinstance(tested, _CONSTANTS) or not isinstance(other, _CONSTANTS):
                continue
            value, earlier = first.setdefault(tested, (other.value, place))
            if value != other.value:
                text = context.source.text[place.start : place.end]
                message = f"`{text}` must also be equal to {value} in this `∧`; did you mean another variable?"
                yield RULE.at(place, message, related=[Related(earlier, "compared here, too")])


def _repeated(tree: Expr) -> Iterator[Finding]:
    nested: set[int] = set()
    for node in walk(tree):
        if not isinstance(node, Binary) or node.operator not in _JOINING or id(node) in nested:
            continue
        first: dict[str, Expr] = {}
        for operand in _operands(node, nested):
            if any(is_draw(part) for part in walk(operand)):
                continue
            text = format_expr(operand)
            earlier = first.setdefault(text, operand)
            if earlier is not operand:
                yield _finding(operand.span, earlier.span, node.operator.symbol, f"`{text}`")


def _operands(tree: Binary, nested: set[int]) -> Iterator[Expr]:
    """What a chain of the operator of `tree` joins, from left to right. Adds the inner operations to `nested`."""
    stack: list[Expr] = [tree]
    while stack:
        node = stack.pop()
        if isinstance(node, Binary) and node.operator is tree.operator:
            nested.add(id(node))
            stack += (node.right, node.left)
        else:
            yield node


def _joining(formula: Formula) -> str | None:
    """The symbol of a `∧` or `∨`; `None` for other formulas."""
    if isinstance(formula, (jani.Binary, BinaryFormula)) and formula.operator in _JOINING_IN_JANI:
        return formula.operator.symbol
    return None


def _operands_in_jani(formula: Formula, nested: set[int]) -> Iterator[Formula]:
    """What a chain of the operator of `formula` joins, from left to right. Adds the inner operations to `nested`."""
    stack = [formula]
    while stack:
        node = stack.pop()
        if isinstance(node, (jani.Binary, BinaryFormula)) and _joining(node) == _joining(formula):
            nested.add(id(node))
            stack += (node.right, node.left)
        else:
            yield node


def _finding(place: Span, earlier: Span, operator: str, what: str) -> Finding:
    message = f"{what} is already an operand of this `{operator}`, so it has no effect; did you mean another one?"
    return RULE.at(place, message, related=[Related(earlier, "the same operand")])


RULE = Rule(
    "repeated-operand",
    Severity.WARNING,
    "Two operands of `&&` or `||` are the same, or test the same field.",
    machine=check,
    properties=check_jani,
    xml_properties=check_properties,
)
