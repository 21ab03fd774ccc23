# SPDX-License-Identifier: Apache-2.0
"""The rule `wrong-limit`, which wrong_limit.md describes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from fractions import Fraction
from typing import TypeGuard

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.format import format_expr
from roaml.expr.infer import constant
from roaml.expr.operators import Operator, OperatorKind
from roaml.expr.tree import Binary, Call, Expr, Member, walk
from roaml.expr.types import INTEGER_RANGES
from roaml.model.behavior.knowledge import variables_in
from roaml.model.machine import Assign, Chart, If, Statement, bodies
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
        for statement in chart.statements:
            if isinstance(statement, If):
                yield from _tested(statement)
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
    parts = (*statement.branches, *((statement.otherwise,) if statement.otherwise else ()))
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
