# SPDX-License-Identifier: Apache-2.0
"""unanswered-tick: see unanswered_tick.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.language import HL_SCXML
from roaml.rules import misspelled, removed_bt_event
from roaml.rules.layout import last_in
from roaml.rules.rule import MachineContext, Rule

ANSWER = '<bt_return_status status="SUCCESS" />'


def check(context: MachineContext) -> Iterator[Finding]:
    """A plugin that is used in the tree but cannot take or answer a tick stops the whole tree."""
    automaton = next((automaton for automaton in context.automata if automaton.instance is not None), None)
    if automaton is None or removed_bt_event.is_used(context.machine):
        return
    plugin, name, root = automaton.outline.plugin, context.machine.name, context.machine.element
    missing = "bt_tick" if not plugin.ticked else "bt_return_status" if not plugin.answers_tick else ""
    if not missing or misspelled.among(root.walk(), missing, HL_SCXML):
        return
    what = "takes no ticks" if missing == "bt_tick" else "never answers a tick"
    message = f"the plugin {what}: it has no `<{missing}>`"
    yield RULE.at(name.span if name else root.name_span, message, *_fixes(context, missing))


def _fixes(context: MachineContext, missing: str) -> Iterator[Fix]:
    """Succeed at once: at the end of each `<bt_tick>`, or in one for the initial state."""
    document, chart = context.document, context.machine.chart
    ticks = [e for e in context.machine.element.walk() if e.name == "bt_tick" and e.complete]
    state = next((s for s in chart.states if s.id and chart.initial and s.id.value == chart.initial.value), None)
    if missing == "bt_return_status" and ticks and not any(tick.find("target") for tick in ticks):
        edits = tuple(last_in(document, tick, ANSWER) for tick in ticks)
        yield Fix("Answer each tick with `SUCCESS`", edits, preferred=False)
    elif missing == "bt_tick" and state is not None and state.id is not None and state.element.complete:
        lines = (f'<bt_tick target="{state.id.value}">', f"    {ANSWER}", "</bt_tick>")
        edit = last_in(document, state.element, *lines)
        yield Fix(f"Add `<bt_tick>` to the state `{state.id.value}`", (edit,), preferred=False)


RULE = Rule("unanswered-tick", Severity.ERROR, "A plugin cannot answer a tick.", machine=check)
