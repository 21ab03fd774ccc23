# SPDX-License-Identifier: Apache-2.0
"""The rule `event-beside-eventless`, which event_beside_eventless.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.rules.rule import MachineContext, Rule, listing
from roaml.rules.support.triggers import awaited


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the unconditional transition, which usually lacks its event or condition."""
    for chart in context.machine.charts:
        for state in chart.states:
            handlers = [handler for handler in state.handlers if handler.effective]
            always = next((h for h in handlers if h.trigger is None and h.cond is None), None)
            waiting = [handler for handler in handlers if handler.trigger is not None]
            if always is not None and waiting:
                names = listing(awaited(state))
                yield RULE.at(
                    always.element.name_span,
                    f"without an event or condition, this transition is taken at once, so the state never waits for "
                    f"{names}; add an `event` or a `cond` to this transition",
                    related=(Related(handler.element.name_span, "never taken") for handler in waiting),
                )


RULE = Rule(
    "event-beside-eventless",
    Severity.ERROR,
    "A state that is left at once has a transition that waits for an event.",
    machine=check,
)
