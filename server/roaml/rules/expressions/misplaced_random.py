# SPDX-License-Identifier: Apache-2.0
"""misplaced-random: see misplaced_random.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.infer import RandomUsed
from roaml.model.value_types import Use
from roaml.rules.rule import MachineContext, Rule

WHERE = {
    Use.CONDITION: "in a condition",
    Use.BRANCH: "in a condition",
    Use.LOCATION: "in a location",
    Use.INITIAL: "in an initial value",
    Use.BOUND: "in a bound",
    Use.ARGUMENT: "in an id",
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


RULE = Rule("misplaced-random", Severity.ERROR, "A random number is drawn where that is not possible.", machine=check)
