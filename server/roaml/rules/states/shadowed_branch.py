# SPDX-License-Identifier: Apache-2.0
"""The rule `shadowed-branch`, which shadowed_branch.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.explore import condition_facts
from roaml.model.machine import If
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.conditions import covered, exhausting_order


def check(context: MachineContext) -> Iterator[Finding]:
    """Report branches that are never executed: only the first branch whose condition holds is executed
    (docs/spec/machines.md#if)."""
    for chart in context.machine.charts:
        for statement in chart.statements:
            if not isinstance(statement, If) or len(statement.branches) < 2:
                continue
            branches = statement.branches
            for cover in covered(condition_facts(chart), [branch.cond for branch in branches]):
                earlier = [branches[n] for n in cover.by or range(cover.number)]
                if cover.same:
                    why = "an earlier branch has the same condition"
                elif cover.by:
                    why = "whenever its condition holds, the condition of an earlier branch holds as well"
                else:
                    why = "whenever its condition holds, the condition of one of the earlier branches holds as well"
                message = f"this branch is never executed: {why}; change one of the conditions"
                related = [Related(branch.element.name_span, "tested first") for branch in earlier]
                yield RULE.at(branches[cover.number].element.name_span, message, related=related)
            otherwise = statement.otherwise
            if otherwise is None or not otherwise.body:
                continue
            last = exhausting_order(condition_facts(chart), [branch.cond for branch in branches])
            if last is not None:
                message = (
                    "this condition always holds where the earlier ones do not, so the branch of `<else/>` is never "
                    "executed; change the condition, or remove the branch"
                )
                related = [Related(otherwise.element.name_span, "never executed")]
                yield RULE.at(last.span, message, related=related)


RULE = Rule(
    "shadowed-branch",
    Severity.WARNING,
    "A branch of an `<if>` can never be executed because of earlier branches.",
    machine=check,
)
