# SPDX-License-Identifier: Apache-2.0
"""The rule `division-by-zero`, which division_by_zero.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import DivisionByZero
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.divisors import possible_zeros


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, DivisionByZero):
                yield RULE.at(problem.span, "division by zero: the result is undefined")
        for divisor, values in possible_zeros(context, value):
            text = context.source.text[slice(*divisor.span)]
            verb = "is always" if values.value is not None else "can be"
            message = f"division by zero: `{text}` {verb} 0 here, and the result is undefined; test it first"
            yield RULE.at(divisor.span, message)


RULE = Rule(
    "division-by-zero", Severity.WARNING, "The divisor of a division is or can be zero.", machine=check, whole=True
)
