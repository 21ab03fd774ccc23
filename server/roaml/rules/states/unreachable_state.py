# SPDX-License-Identifier: Apache-2.0
"""The rule `unreachable-state`, which unreachable_state.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity, Tag
from roaml.edit.elements import remove
from roaml.model.machine import Chart, State
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        reached = _reached(chart)
        if reached is None:
            continue
        for state in chart.states:
            if state.id is not None and state.id.value not in reached:
                message = f"no transition leads to the state `{state.id.value}`, so it is never entered"
                yield RULE.at(state.id.span, message, *_remove(context, chart, state), tags=(Tag.UNNECESSARY,))


def _remove(context: MachineContext, chart: Chart, state: State) -> Iterator[Fix]:
    """A fix that removes a state. There is none if a transition of another unreachable state leads to the state."""
    others = [handler for other in chart.states if other is not state for handler in other.handlers]
    targets = [target.state.value for handler in others for target in handler.targets if target.state]
    if state.id is not None and state.id.value not in targets:
        yield remove(context.document, state.element, f"Remove the state `{state.id.value}`")


def _reached(chart: Chart) -> set[str] | None:
    """The states that can be entered; `None` if the initial state is unknown, because nothing can be concluded then."""
    targets: dict[str, set[str]] = {}
    for state in chart.states:
        if state.id is not None:
            known = targets.setdefault(state.id.value, set())
            known.update(t.state.value for handler in state.handlers for t in handler.targets if t.state)
    if chart.initial is None or chart.initial.value not in targets:
        return None
    reached = {chart.initial.value}
    waiting = [chart.initial.value]
    while waiting:
        new = targets.get(waiting.pop(), set()) - reached
        reached |= new
        waiting += new
    return reached


RULE = Rule("unreachable-state", Severity.INFORMATION, "A state is never entered.", machine=check)
