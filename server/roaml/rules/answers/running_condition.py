# SPDX-License-Identifier: Apache-2.0
"""The rule `running-condition`, which running_condition.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.machine import ReturnStatus, Statement, statements
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import behaviors, plugins
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    """Report plugins that the tree uses as a `<Condition>` and that return RUNNING, which BehaviorTree.CPP does not
    allow."""
    used = next((a for a in plugins(context) if a.instance is not None and a.instance.condition), None)
    if used is None:
        return
    for behavior in behaviors(context):
        for statement, answers in behavior.statuses.items():
            if "RUNNING" in answers:
                message = (
                    "the tree uses this plugin as a `<Condition>`, and BehaviorTree.CPP throws an exception if a "
                    "condition returns RUNNING; return SUCCESS or FAILURE at once, or use the plugin as an `<Action>`"
                )
                related = [Related(statement.element.name_span, "the plugin returns RUNNING here")]
                yield RULE.at(_handler(context, statement), message, *_fixes(statement), related=related)


def _handler(context: MachineContext, statement: Statement) -> Span:
    """The handler that contains a statement, or the statement itself in `<onentry>` and `<onexit>`."""
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if any(statement in statements(target.body) for target in handler.targets):
                    return handler.element.name_span
    return statement.element.name_span


def _fixes(statement: ReturnStatus) -> Iterator[Fix]:
    if statement.status is not None and statement.status.value == "RUNNING":
        for status in ("FAILURE", "SUCCESS"):
            yield Fix(f"Return `{status}`", (TextEdit(statement.status.span, status),), preferred=False)


RULE = Rule("running-condition", Severity.WARNING, "A condition returns RUNNING.", machine=check, whole=True)
