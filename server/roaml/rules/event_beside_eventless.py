# SPDX-License-Identifier: Apache-2.0
"""event-beside-eventless: see event_beside_eventless.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for state in chart.states:
            always = next((h for h in state.handlers if h.trigger == "" and h.cond is None and h.effective), None)
            if always is None:
                continue
            for handler in state.handlers:
                if handler.trigger != "" and handler.effective:
                    yield RULE.at(
                        handler.element.name_span,
                        "this state is left at once by a transition without event and condition: it never waits for "
                        "an event",
                        related=(Related(always.element.name_span, "always taken"),),
                    )


RULE = Rule(
    "event-beside-eventless",
    Severity.ERROR,
    "A state that is left at once has a transition that waits for an event.",
    machine=check,
)
