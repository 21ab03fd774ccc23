# SPDX-License-Identifier: Apache-2.0
"""The rule `invalid-status`, which invalid_status.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.types import ScalarKind, Unknown, is_kind
from roaml.model.machine import Chart, ReturnStatus
from roaml.model.syntax import Name
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, replacements
from roaml.rules.support import misspelled
from roaml.scxml.names import STATUSES

NUMBERS = {str(number): status for status, number in STATUSES.items()}


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, ReturnStatus) and statement.status and statement.status.value not in STATUSES:
                yield from _check(context, chart, statement.status)


def _check(context: MachineContext, chart: Chart, status: Name) -> Iterator[Finding]:
    variables = context.typed.variables.get(chart.scope, {})
    type_ = variables.get(status.value)
    if type_ is None:
        if misspelled.declaration(context.machine, "data", status.value):
            return
        ints = [name for name, type_ in variables.items() if is_kind(type_, ScalarKind.INT)]
        known = (NUMBERS[status.value],) if status.value in NUMBERS else close_names(status.value, (*STATUSES, *ints))
        hint = did_you_mean(known) or "; write `SUCCESS`, `FAILURE`, `RUNNING` or the name of an int variable"
        yield RULE.at(status.span, f"`{status.value}` is not a status{hint}", *replacements(status.span, known))
    elif not (isinstance(type_, Unknown) or is_kind(type_, ScalarKind.INT)):
        message = f"a variable that holds a status must be an integer (1 SUCCESS, 2 FAILURE, 3 RUNNING), not `{type_}`"
        yield RULE.at(status.span, message)


RULE = Rule("invalid-status", Severity.ERROR, "A plugin returns an invalid status.", machine=check)
