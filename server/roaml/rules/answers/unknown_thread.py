# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-thread`, which unknown_thread.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.explore import Fault, FaultKind
from roaml.model.machine import RosSend, Statement
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import behaviors


def check(context: MachineContext) -> Iterator[Finding]:
    """Report starts of threads with a number that no thread has; threads are numbered from 0."""
    for behavior in behaviors(context):
        reported: set[Statement] = set()
        for step in behavior.steps:
            for fault in step.faults:
                if (
                    fault.kind is FaultKind.THREAD
                    and fault.statement not in reported
                    and isinstance(fault.statement, RosSend)
                ):
                    reported.add(fault.statement)
                    yield _finding(context, fault, fault.statement)


def _finding(context: MachineContext, fault: Fault, statement: RosSend) -> Finding:
    thread = next(t for t in context.machine.threads if t.server and t.server.value == fault.duty.handle)
    assert statement.thread_id is not None
    numbers = "the only number is 0" if thread.count == 1 else f"the numbers are 0 to {(thread.count or 1) - 1}"
    message = (
        f"`{fault.duty.handle}` has no thread with the number `{statement.thread_id.text.strip()}`: {numbers}, "
        "so no thread receives this start; use the number of an existing thread, or raise `n_threads`"
    )
    count = thread.element.get("n_threads")
    related = [Related(count.value_span, "the number of threads")] if count else []
    return RULE.at(statement.thread_id.span, message, related=related)


RULE = Rule(
    "unknown-thread", Severity.WARNING, "A machine starts a thread that does not exist.", machine=check, whole=True
)
