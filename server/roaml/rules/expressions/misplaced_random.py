# SPDX-License-Identifier: Apache-2.0
"""The rule `misplaced-random`, which misplaced_random.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import RandomUsed
from roaml.model.value_types import ValueUse
from roaml.rules.rule import MachineContext, Rule

WHERE = {
    ValueUse.CONDITION: "in a condition",
    ValueUse.BRANCH: "in a condition",
    ValueUse.LOCATION: "in a location",
    ValueUse.INITIAL: "in an initial value",
    ValueUse.BOUND: "in a bound",
    ValueUse.ARGUMENT: "in the id of a goal or thread",
}


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        if value.use in WHERE:
            for problem in value.problems:
                if isinstance(problem, RandomUsed):
                    yield RULE.at(
                        problem.span,
                        f"`Math.random()` is not allowed {WHERE[value.use]}; assign it to a variable first",
                    )


RULE = Rule("misplaced-random", Severity.ERROR, "`Math.random()` is used where it is not allowed.", machine=check)
