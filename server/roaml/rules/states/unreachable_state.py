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
        sources = _sources(chart)
        severity = None if context.system is not None and _is_whole(chart) else Severity.INFORMATION
        for state in chart.states:
            if state.id is not None and state.id.value not in reached:
                message = (
                    f"no path of transitions leads from the initial state to `{state.id.value}`, so it is never entered"
                )
                # Where the machine is complete, a transition probably has the wrong target.
                fixes = _remove(context, state, sources.get(state.id.value, [])) if severity is not None else ()
                yield RULE.at(state.id.span, message, *fixes, severity=severity, tags=(Tag.UNNECESSARY,))


def _is_whole(chart: Chart) -> bool:
    """Whether all transitions lead to states that exist."""
    names = {state.id.value for state in chart.states if state.id}
    targets = [target.state for state in chart.states for handler in state.handlers for target in handler.targets]
    return all(target is not None and target.value in names for target in targets)


def _remove(context: MachineContext, state: State, sources: list[State]) -> Iterator[Fix]:
    """A fix that removes a state. No fix is offered if a transition of another unreachable state leads to the state."""
    if state.id is not None and all(source is state for source in sources):
        yield remove(context.document, state.element, f"Remove the state `{state.id.value}`")


def _sources(chart: Chart) -> dict[str, list[State]]:
    """Name of a state -> the states with a transition to it."""
    sources: dict[str, list[State]] = {}
    for state in chart.states:
        for name in dict.fromkeys(t.state.value for handler in state.handlers for t in handler.targets if t.state):
            sources.setdefault(name, []).append(state)
    return sources


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


RULE = Rule("unreachable-state", Severity.WARNING, "A state is never entered.", machine=check, whole=True)
