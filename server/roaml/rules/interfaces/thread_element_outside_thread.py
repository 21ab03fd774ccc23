# SPDX-License-Identifier: Apache-2.0
"""The rule `thread-element-outside-thread`, which thread_element_outside_thread.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.machine import RosSend
from roaml.model.vocabulary import INSIDE_THREADS, OUTSIDE_THREADS, UNUSUAL_IN_THREADS
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        elements = [h.element for state in chart.states for h in state.handlers]
        elements += [s.element for s in chart.statements if isinstance(s, RosSend)]
        for element in elements:
            if not chart.scope and element.name in INSIDE_THREADS:
                yield RULE.at(element.name_span, f"`<{element.name}>` is only allowed in a `<ros_action_thread>`")
            elif chart.scope and element.name in OUTSIDE_THREADS:
                yield RULE.at(
                    element.name_span, f"`<{element.name}>` is only allowed in the server, not in its threads"
                )
            elif chart.scope and element.name in UNUSUAL_IN_THREADS:
                message = (
                    f"`<{element.name}>` in a thread: every goal waits until the server and all threads handle it; "
                    "handle goals in the server"
                )
                yield RULE.at(element.name_span, message, severity=Severity.WARNING)


RULE = Rule(
    "thread-element-outside-thread",
    Severity.ERROR,
    "An element is not allowed inside, or outside of, an action thread.",
    machine=check,
)
