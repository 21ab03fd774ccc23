# SPDX-License-Identifier: Apache-2.0
"""The rule `wrong-limit`, which wrong_limit.md describes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from fractions import Fraction
from typing import TypeGuard

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.format import format_expr
from roaml.expr.infer import constant
from roaml.expr.operators import MIRRORED, Operator, OperatorKind
from roaml.expr.tree import Binary, Call, Expr, Member, Name, walk
from roaml.expr.types import INTEGER_RANGES
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import Assign, Chart, If, RosSend, Send, State, Statement, bodies, statements
from roaml.model.syntax import Expression
from roaml.model.values.evaluate import place_of
from roaml.model.waits import fixed_variables
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.steps import step_of
from roaml.text import TextEdit

_LIMITING = {"max": -1, "min": 1}
"""A function of `Math` -> the sign of the steps that it limits."""


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        fixed = {name: value for name, value in fixed_variables(chart).items() if isinstance(value, Fraction)}
        types = context.typed.variables.get(chart.scope, {})
        positive = {name for name, value in fixed.items() if value > 0}
        positive |= {name for name, type_ in types.items() if INTEGER_RANGES.get(str(type_), (-1, 0))[0] == 0}
        yield from _one_beyond(chart)
        for statement in chart.statements:
            if isinstance(statement, If):
                yield from _tested(statement)
                yield from _clamped(statement)
            if isinstance(statement, Assign) and statement.location is not None:
                place = place_of(statement.location.tree)
                tree = statement.value.tree if isinstance(statement.value, Expression) else None
                if place is not None and isinstance(tree, Call):
                    found = list(_check(tree, place, positive, fixed))
                    # What bounds a variable is searched for in the whole machine, so only where it matters.
                    if found and not _is_bounded(chart, statement, place):
                        yield from found


_OPPOSITE = {Operator.ADD: Operator.SUBTRACT, Operator.SUBTRACT: Operator.ADD}


def _tested(statement: If) -> Iterator[Finding]:
    """Report a step in the other direction than the step that the condition compares with a limit."""
    parts = statement.parts
    steps = [
        (part, place, assign.value.tree)
        for part in parts
        for assign in part.body
        if isinstance(assign, Assign) and isinstance(assign.value, Expression) and assign.location is not None
        if (place := place_of(assign.location.tree)) is not None
    ]
    for branch in statement.branches:
        for test in walk(branch.cond.tree) if branch.cond is not None else ():
            if not isinstance(test, Binary) or test.operator.kind is not OperatorKind.ORDER:
                continue
            for step in (test.left, test.right):
                if not isinstance(step, Binary) or step.operator not in _OPPOSITE:
                    continue
                # A step back where the tested step would pass the limit is a turn: a ball bounces.
                passes = _passes(test, step)
                made = [
                    tree
                    for part, place, tree in steps
                    if (part is branch) is not passes and _is_step(tree, place) and place_of(step.left) == place
                ]
                same = [tree for tree in made if format_expr(tree.right) == format_expr(step.right)]
                if same and all(tree.operator is _OPPOSITE[step.operator] for tree in same):
                    yield from (_reversed(tree, step) for tree in same)


def _clamped(statement: If) -> Iterator[Finding]:
    """Report an `<if>` that assigns a limit where the step that it compares with the limit does not pass it, or that
    takes a step of another size than the one that it compares."""
    if len(statement.branches) != 1 or statement.otherwise is None:
        return
    branch, otherwise = statement.branches[0], statement.otherwise
    test = branch.cond.tree if branch.cond is not None else None
    if not isinstance(test, Binary) or test.operator.kind is not OperatorKind.ORDER:
        return
    for step, limit in ((test.left, test.right), (test.right, test.left)):
        place = place_of(step.left) if isinstance(step, Binary) and step.operator in _OPPOSITE else None
        values = [_only_value(part.body, place) for part in (branch, otherwise)] if place is not None else []
        if not isinstance(step, Binary) or place is None or None in values:
            continue
        kept = [value for value in values if value is not None and format_expr(value) == format_expr(limit)]
        taken = [v for v in values if v is not None and _is_step(v, place) and v.operator is step.operator]
        if len(kept) != 1 or len(taken) != 1 or not _is_step(taken[0], place):
            continue
        amount = taken[0].right
        if (kept[0] is values[0]) is not _passes(test, step):
            symbol = MIRRORED[test.operator].symbol
            message = (
                f"`{place}` is set to the limit `{format_expr(limit)}` where `{format_expr(step)}` does not pass it, "
                f"and passes it otherwise; use `{symbol}`"
            )
            text = symbol.replace("<", "&lt;").replace(">", "&gt;")
            fix = Fix(f"Change to `{symbol}`", (TextEdit(test.operator_span, text),))
            yield RULE.at(test.operator_span, message, fix)
        elif format_expr(amount) != format_expr(step.right):
            tested = format_expr(step.right)
            message = (
                f"the condition compares `{format_expr(step)}` with the limit, and `{place}` becomes "
                f"`{format_expr(taken[0])}`, which may pass it; use `{tested}`"
            )
            fix = Fix(f"Change to `{tested}`", (TextEdit(amount.span, tested),))
            yield RULE.at(amount.span, message, fix, related=[Related(step.span, "the step that is tested")])


def _only_value(body: Sequence[Statement], place: str) -> Expr | None:
    """The value of the only assignment to `place` in `body`; `None` if there are several or none."""
    values = [s.value for s in body if isinstance(s, Assign) and _assigns(s, place)]
    value = values[0] if len(values) == 1 else None
    return value.tree if isinstance(value, Expression) and not value.broken else None


def _one_beyond(chart: Chart) -> Iterator[Finding]:
    """Report a variable that a state counts up while it is at most a limit, so that it ends one beyond the limit,
    although other states compare it with the limit itself, and none with the number behind it."""
    equal: dict[str, list[tuple[Binary, Expr, State]]] = {}
    counted: list[tuple[Binary, str, Expr, State]] = []
    for state in chart.states:
        for tree in _conditions_in(state):
            for node in walk(tree):
                if isinstance(node, Binary) and node.operator is Operator.EQUAL:
                    for variable, limit in ((node.left, node.right), (node.right, node.left)):
                        if isinstance(variable, Name):
                            equal.setdefault(variable.name, []).append((node, limit, state))
        for handler in state.handlers:
            test = handler.cond.tree if handler.cond is not None and not handler.cond.broken else None
            body = [s for target in handler.targets for s in target.body]
            if not isinstance(test, Binary) or test.operator is not Operator.LESS_EQUAL:
                continue
            place = place_of(test.left)
            if any(
                isinstance(s, Assign) and isinstance(s.value, Expression) and place is not None and _assigns(s, place)
                # A step of 1 is the only one that cannot miss the limit.
                and step_of(s.value.tree, place) > 0 and isinstance(s.value.tree, Binary)
                and constant(s.value.tree.right) == 1
                for s in body
            ):  # fmt: skip
                assert place is not None
                counted.append((test, place, test.right, state))
    for test, place, limit, state in counted:
        others = equal.get(place, ())
        same = [(node, where) for node, other, where in others if format_expr(other) == format_expr(limit)]
        number = constant(limit)
        beyond = number is not None and any(constant(other) == number + 1 for _, other, _ in others)
        if same and not beyond and all(where is not state for _, where in same) and not _begins_at_one(chart, place):
            message = (
                f"`{place}` is counted beyond `{format_expr(limit)}`, although another state compares it with "
                f"`{format_expr(limit)}`; use `<`"
            )
            fix = Fix("Change to `<`", (TextEdit(test.operator_span, "&lt;"),))
            yield RULE.at(test.operator_span, message, fix, related=[Related(same[0][0].span, "compared here")])


def _begins_at_one(chart: Chart, name: str) -> bool:
    """Whether a variable counts from 1, or a higher number, so that `<=` is right: the limit is the last number."""
    values = [data.value for data in chart.data if data.id is not None and data.id.value == name]
    values += [s.value for s in chart.statements if isinstance(s, Assign) and _assigns(s, name)]
    trees = [value.tree for value in values if isinstance(value, Expression) and not value.broken]
    starts = [number for tree in trees if (number := constant(tree)) is not None]
    return bool(starts) and all(not isinstance(number, str) and number >= 1 for number in starts)


def _conditions_in(state: State) -> Iterator[Expr]:
    """The expressions in a state: its conditions, and the values that it assigns or sends."""
    bodies_in = [b.statements for b in (state.entry, state.exit) if b is not None]
    bodies_in += [target.body for handler in state.handlers for target in handler.targets]
    values: list[object] = [handler.cond for handler in state.handlers]
    for statement in (s for body in bodies_in for s in statements(body)):
        match statement:
            case If(branches=branches):
                values += [branch.cond for branch in branches]
            case Assign(value=value):
                values.append(value)
            case Send(params=params) | RosSend(fields=params):
                values += [param.value for param in params]
    yield from (value.tree for value in values if isinstance(value, Expression) and not value.broken)


def _passes(test: Binary, step: Binary) -> bool:
    """Whether a comparison holds if `step`, one of its sides, passes the limit, which is the other side."""
    is_greater = test.operator in (Operator.GREATER, Operator.GREATER_EQUAL)
    return (is_greater == (step is test.left)) == (step.operator is Operator.ADD)


def _is_step(tree: Expr, place: str) -> TypeGuard[Binary]:
    return isinstance(tree, Binary) and tree.operator in _OPPOSITE and place_of(tree.left) == place


def _reversed(tree: Binary, tested: Binary) -> Finding:
    symbol = tested.operator.symbol
    message = (
        f"`{format_expr(tree)}` is a step in the other direction than `{format_expr(tested)}`, which the condition "
        f"compares with a limit; use `{symbol}`"
    )
    fix = Fix(f"Change to `{symbol}`", (TextEdit(tree.operator_span, symbol),))
    return RULE.at(tree.operator_span, message, fix, related=[Related(tested.span, "the step that is tested")])


def _is_bounded(chart: Chart, assign: Assign, place: str) -> bool:
    """Whether the variable has something else that limits it: a condition under which it is assigned compares it, or it
    also gets a negative constant, which usually means that its value is not known yet."""
    for _, handler, body in bodies(chart):
        above = _conditions_above(body, assign)
        if above is not None:
            conditions = (*above, handler.cond if handler is not None else None)
            if any(cond is not None and place in variables_in((cond.tree,)) for cond in conditions):
                return True
    values = [data.value for data in chart.data if data.id is not None and data.id.value == place]
    values += [s.value for s in chart.statements if isinstance(s, Assign) and _assigns(s, place)]
    numbers = [constant(value.tree) for value in values if isinstance(value, Expression)]
    return any(number is not None and number < 0 for number in numbers)


def _assigns(statement: Assign, place: str) -> bool:
    return statement.location is not None and place_of(statement.location.tree) == place


def _conditions_above(body: Sequence[Statement], assign: Assign) -> tuple[Expression | None, ...] | None:
    """The conditions of the branches in which `assign` is; `None` if it is not in `body`."""
    for statement in body:
        if statement is assign:
            return ()
        if isinstance(statement, If):
            for branch in statement.branches:
                inner = _conditions_above(branch.body, assign)
                if inner is not None:
                    return (*inner, branch.cond)
            inner = _conditions_above(statement.otherwise.body, assign) if statement.otherwise else None
            if inner is not None:
                return (*inner, *(branch.cond for branch in statement.branches))
    return None


def _check(call: Call, place: str, positive: Collection[str], fixed: Collection[str]) -> Iterator[Finding]:
    function = call.function
    if not isinstance(function, Member) or place_of(function.object) != "Math" or len(call.arguments) != 2:
        return
    sign = _LIMITING.get(function.name)
    for step, limit in (call.arguments, call.arguments[::-1]):
        direction = step_of(step, place, positive)
        if sign is not None and direction == -sign and (constant(limit) is not None or place_of(limit) in fixed):
            right = "max" if function.name == "min" else "min"
            how, bound = ("falls", "an upper") if direction < 0 else ("grows", "a lower")
            message = (
                f"`{place}` {how} here, and `Math.{function.name}` only gives it {bound} limit; use `Math.{right}`"
            )
            fix = Fix(f"Change to `Math.{right}`", (TextEdit(function.name_span, right),))
            yield RULE.at(function.name_span, message, fix)


RULE = Rule(
    "wrong-limit",
    Severity.WARNING,
    "A number that falls has an upper limit only, or one that grows a lower limit.",
    machine=check,
    whole=True,
)
