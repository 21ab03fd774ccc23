# SPDX-License-Identifier: Apache-2.0
"""The rule `division-by-zero`, which division_by_zero.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import DivisionByZero
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, DivisionByZero):
                yield RULE.at(problem.span, "division by zero: the result is undefined")


RULE = Rule("division-by-zero", Severity.WARNING, "A division has the constant divisor zero.", machine=check)
