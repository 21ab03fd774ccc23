# SPDX-License-Identifier: Apache-2.0
"""The rule `unenforced-bounds`, which unenforced_bounds.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.syntax import Expression
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for data in chart.data:
            for value in (data.lower, data.upper):
                if value is not None and not (isinstance(value, Expression) and value.broken):
                    yield RULE.at(
                        value.span,
                        "the bound is not enforced: in the model the variable may have any value of its type",
                    )


RULE = Rule("unenforced-bounds", Severity.INFORMATION, "A bound of a variable is not enforced.", machine=check)
