# SPDX-License-Identifier: Apache-2.0
"""wrong-goal-id: see wrong_goal_id.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.behavior.explore import Fault, Step
from roaml.model.machine import Communicate
from roaml.rules.answers import behaviors, place
from roaml.rules.layout import first_in
from roaml.rules.rule import MachineContext, Rule

_WHY = {
    "unstored": "no goal id has been stored in `{id}` before; store `_action.goal_id` in it where the goal is taken",
    "other": "`{id}` holds the id of a goal of another action; name the goal by the id that it came with",
    "rejected": "the goal whose id `{id}` holds was rejected; keep the id of the accepted goal in another variable",
    "undecided": "the goal whose id `{id}` holds has not been accepted; accept it first",
}


def check(context: MachineContext) -> Iterator[Finding]:
    """A goal is known by the id that it came with; what is sent with another one reaches another client, or nobody."""
    for behavior in behaviors(context):
        told: set[str] = set()
        for step in behavior.steps:
            for fault in step.faults:
                statement = fault.statement
                if fault.kind not in _WHY or not isinstance(statement, Communicate) or statement.goal_id is None:
                    continue
                if behavior.approximate and not fault.certain:
                    continue
                variable = statement.goal_id.text.strip()
                if f"{variable} {fault.kind}" not in told:
                    told.add(f"{variable} {fault.kind}")
                    yield _finding(context, step, fault, statement, variable)


def _finding(context: MachineContext, step: Step, fault: Fault, statement: Communicate, variable: str) -> Finding:
    message = f"`<{statement.element.name}>` names the wrong goal: {_WHY[fault.kind].format(id=variable)}"
    related = [Related(statement.element.name_span, "it is used here")]
    fixes = _store(context, step, variable) if fault.kind == "unstored" else ()
    return RULE.at(place(step.handler, statement), message, *fixes, related=related)


def _store(context: MachineContext, step: Step, variable: str) -> Iterator[Fix]:
    element = step.handler.targets[step.choice].element or step.handler.element
    if step.event is not None and step.event.part in ("goal", "thread-start") and element.complete:
        edit = first_in(context.document, element, f'<assign location="{variable}" expr="_action.goal_id" />')
        yield Fix(f"Store the goal id in `{variable}`", (edit,))


RULE = Rule("wrong-goal-id", Severity.WARNING, "A goal is named by an id that is not its own.", machine=check)
