# SPDX-License-Identifier: Apache-2.0
"""Places elsewhere in a machine that are probably wrong, because they make a condition constant."""

from __future__ import annotations

from collections.abc import Sequence

from roaml.diagnostics import Related
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Name, walk
from roaml.model.machine import Assign, State, Statement
from roaml.model.syntax import Expression
from roaml.model.syntax import Name as SyntaxName
from roaml.model.values.analyse import ChartValues
from roaml.model.values.domain import TRUE
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, replacements
from roaml.rules.support.alternatives import guarded_statements
from roaml.rules.support.constant_conditions import ConstantPart, because, values_in
from roaml.rules.support.steps import step_of
from roaml.text import Span

_TOWARDS = {Operator.LESS: 1, Operator.LESS_EQUAL: 1, Operator.GREATER: -1, Operator.GREATER_EQUAL: -1}
"""An operator between a variable and a limit -> the sign of the steps that lead to the limit."""


def at_step(context: MachineContext, span: Span) -> ConstantPart | None:
    """What to report about a condition at `span` that is always true because what it allows leads away from its
    limit."""
    for chart in context.machine.charts:
        values = context.local_values.charts.get(chart.scope)
        known = values.conditions.get(span) if values is not None else None
        for cond, body in guarded_statements(chart) if known is not None and known.alone == TRUE else ():
            away = _step_away(cond.tree, body) if cond.span == span else None
            if values is not None and away is not None and _begins_beyond(values, cond.tree):
                where, name, how = away
                text = " ".join(cond.text.split())
                message = f"`{name}` only {how} here, so the condition `{text}` is always true"
                why = because(values_in(values, cond.tree))
                related = (Related(span, "always true"),)
                return ConstantPart(where, f"{message}{why}; change one of them", related=related)
    return None


def at_target(context: MachineContext, span: Span) -> ConstantPart | None:
    """What to report about a condition at `span` that is constant because a handler assigns another value to a variable
    of the condition and then does not go to its state, as another handler with such an assignment does."""
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
                related = (
                    Related(assigned.element.name_span, "assigned here"),
                    Related(right[0].span, f"goes to `{own}`"),
                    Related(span, f"{how} true"),
                )
                return ConstantPart(target.span, message, fixes=(*replacements(target.span, (own,)),), related=related)
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
