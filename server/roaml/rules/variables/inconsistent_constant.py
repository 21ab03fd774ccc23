# SPDX-License-Identifier: Apache-2.0
"""The rule `inconsistent-constant`, which inconsistent_constant.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule, replacements
from roaml.rules.support.odd_constants import odd_constants


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        odd = odd_constants(context, chart)
        for data in chart.data if odd else ():
            if data.id is not None and data.id.value in odd and isinstance(data.value, Expression):
                number, meant = odd[data.id.value]
                message = (
                    f"`{data.id.value}` is {number} here and {meant} in all other machines of the system that have it; "
                    f"did you mean {meant}?"
                )
                yield RULE.at(data.value.span, message, *replacements(data.value.span, (str(meant),)))


RULE = Rule(
    "inconsistent-constant",
    Severity.WARNING,
    "A constant has another value than in the other machines of the system.",
    machine=check,
    whole=True,
)
