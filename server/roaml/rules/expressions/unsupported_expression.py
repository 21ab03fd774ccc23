# SPDX-License-Identifier: Apache-2.0
"""The rule `unsupported-expression`, which unsupported_expression.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import ElementComputed, ObjectUsed
from roaml.expr.parse import UNSUPPORTED
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        if isinstance(value.value, Expression):
            yield from (finding for finding in value.value.findings if finding.code == UNSUPPORTED)
        for problem in value.problems:
            match problem:
                case ObjectUsed():
                    yield RULE.at(
                        problem.span,
                        "an object in braces is only allowed as the initial value of a struct; assign the members "
                        "one by one, "
                        "or another struct",
                    )
                case ElementComputed():
                    yield RULE.at(
                        problem.span,
                        (
                            "an array in brackets may contain only literals; assign this element with a separate "
                            "`<assign>`"
                        ),
                    )


RULE = Rule(
    "unsupported-expression",
    Severity.ERROR,
    "An expression is valid ECMAScript, but not supported in models.",
    machine=check,
)
