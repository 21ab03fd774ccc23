# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-bounds`, which invalid_bounds.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import removal
from roaml.expr.infer import constant
from roaml.expr.types import is_number
from roaml.model.machine import Data
from roaml.model.syntax import Expression, Value
from roaml.rules.rule import MachineContext, Rule
from roaml.text import Edit, TextEdit

BOUNDS = ("lower_bound_incl", "upper_bound_incl")


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        types = context.typed.variables.get(chart.scope, {})
        for data in chart.data:
            if data.lower is None and data.upper is None:
                continue
            type_ = types.get(data.id.value) if data.id else None
            if type_ is not None and str(type_) != "unknown" and not is_number(type_):
                span = (data.lower or data.upper).span  # type: ignore[union-attr]
                fix = Fix("Remove the bounds", tuple(_without_bounds(context, data)))
                yield RULE.at(span, f"only numbers can have bounds, not `{type_}`", fix)
            else:
                yield from _order(context, data)


def _without_bounds(context: MachineContext, data: Data) -> Iterator[Edit]:
    spans = [a.span for a in data.element.attributes if a.name in BOUNDS]
    spans += [e.span for e in data.element.elements if e.name in BOUNDS]
    return (removal(context.source.text, span) for span in spans)


def _order(context: MachineContext, data: Data) -> Iterator[Finding]:
    low, high, initial = (_number(value) for value in (data.lower, data.upper, data.value))
    if low is not None and high is not None and low > high:
        assert data.lower is not None
        assert data.upper is not None
        related = (Related(data.upper.span, "the upper bound"),)
        lower, upper = (context.source.text[slice(*value.span)] for value in (data.lower, data.upper))
        swap = Fix("Swap the bounds", (TextEdit(data.lower.span, upper), TextEdit(data.upper.span, lower)))
        yield RULE.at(
            data.lower.span, f"the lower bound {low} is greater than the upper bound {high}", swap, related=related
        )
    elif initial is not None and ((low is not None and initial < low) or (high is not None and initial > high)):
        assert data.value is not None
        is_below = low is not None and initial < low
        bound, nearest = (f"below {low}", low) if is_below else (f"above {high}", high)
        fix = Fix(f"Change the initial value to {nearest}", (TextEdit(data.value.span, str(nearest)),), preferred=False)
        message = f"the initial value {initial} is outside the bounds of the variable: {bound}"
        # The bounds state the intended values; the translation does not read them (docs/spec/machines.md#data).
        yield RULE.at(data.value.span, message, fix, severity=Severity.WARNING)


def _number(value: Value | None) -> int | float | None:
    return constant(value.tree) if isinstance(value, Expression) else None


RULE = Rule(
    "invalid-bounds", Severity.ERROR, "The bounds of a variable contradict each other or its value.", machine=check
)
