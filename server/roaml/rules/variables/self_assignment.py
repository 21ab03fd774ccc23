# SPDX-License-Identifier: Apache-2.0
"""The rule `self-assignment`, which self_assignment.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import remove
from roaml.expr.types import UNKNOWN, ScalarKind, is_kind
from roaml.model.machine import Assign, Chart
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.assignments import is_unchanged
from roaml.rules.support.elements import stands_alone
from roaml.text import TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, Assign) and statement.location is not None and is_unchanged(statement):
                assert isinstance(statement.value, Expression)
                text = statement.location.text
                message = f"this assigns `{text}` to itself, which has no effect; change `expr`"
                yield RULE.at(statement.value.span, message, *_fixes(context, chart, statement, text))


def _fixes(context: MachineContext, chart: Chart, statement: Assign, text: str) -> Iterator[Fix]:
    """Counting, for an integer; without the assignment, conditions on the variable may never change their results."""
    types = context.typed.variables.get(chart.scope, {})
    if is_kind(types.get(text, UNKNOWN), ScalarKind.INT) and isinstance(statement.value, Expression):
        yield Fix(f"Change to `{text} + 1`", (TextEdit(statement.value.span, f"{text} + 1"),), preferred=False)
    if not stands_alone(context.document, statement.element):
        yield remove(context.document, statement.element, "Remove the assignment")


RULE = Rule("self-assignment", Severity.WARNING, "A variable is assigned to itself.", machine=check)
