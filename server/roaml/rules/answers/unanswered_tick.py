# SPDX-License-Identifier: Apache-2.0
"""The rule `unanswered-tick`, which unanswered_tick.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import after, last_in
from roaml.language import HL_SCXML
from roaml.model.behavior.explore import Behavior
from roaml.model.behavior.phases import TICK, Phase
from roaml.model.machine import Chart
from roaml.model.system import SystemAutomaton
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled
from roaml.rules.support.answers import (
    OpenPath,
    answered,
    behaviors,
    is_spelled,
    missed,
    plugins,
    running_without,
    unhandled_states,
)

ANSWER = '<bt_return_status status="SUCCESS" />'


def check(context: MachineContext) -> Iterator[Finding]:
    """Report plugins in the tree that do not handle a tick or return no status: they stop the whole tree."""
    automata = plugins(context)
    if not automata:
        return
    plugin, name, root = automata[0].outline.plugin, context.machine.name, context.machine.element
    if not plugin.ticked:
        if root.complete and not misspelled.is_hidden(root, "bt_tick", HL_SCXML):
            message = "the plugin does not handle ticks: it has no `<bt_tick>`; add one to its states"
            yield RULE.at(name.span if name else root.name_span, message, *_add_handler(context))
        return
    if not is_spelled(context, TICK):
        return
    for behavior in behaviors(context):
        if behavior.chart is context.machine.chart:
            yield from _missed(context, behavior)
            yield from _not_taken(context, behavior, automata)


def _missed(context: MachineContext, behavior: Behavior) -> Iterator[Finding]:
    for path in missed(context, behavior, TICK):
        fixes = _fixes(context, behavior, path)
        yield RULE.at(path.span, _message(path), *fixes, severity=path.severity, related=path.related)


def _message(path: OpenPath) -> str:
    if path.step.ignored:
        tag = f"<{path.step.handler.element.name}>"
        reason = "a tick that arrives while this condition does not hold is dropped and no status is returned,"
        if not path.receives:
            reason = f"{path.dropped}, so no status is returned for the tick,"
        return f"{reason} and the tree waits for ever; add a `{tag}` without `cond` after it"
    tick = (
        "a tick that is handled here" if path.receives else f"the tick that arrived in the state `{path.received_in}`"
    )
    how = "does not return a status on every path" if path.choice or not path.certain else "never returns a status"
    when = f" {path.order}" if path.order else ""
    return f"{tick} {how}{when}, so the tree waits for ever; send one `<bt_return_status>` on every path"


def _not_taken(context: MachineContext, behavior: Behavior, automata: list[SystemAutomaton]) -> Iterator[Finding]:
    """Report the states without `<bt_tick>` in which the plugin waits."""
    reported: set[str] = set()
    for waiting in unhandled_states(context, behavior, automata, TICK):
        reported.add(waiting.name)
        if waiting.needs_time:
            message = (
                f"a tick that arrives in the state `{waiting.name}` is not handled before time has passed, but the "
            )
            message += "clock waits until a status is returned; add a `<bt_tick>` that returns RUNNING"
        else:
            message = (
                f"a tick that arrives in the state `{waiting.name}` is never handled, so the tree waits for ever; "
            )
            message += "add a `<bt_tick>`"
        is_open = waiting.needs_time or waiting.tree_status is Phase.ENDED
        is_open = is_open or waiting.name not in _without_conditions(behavior.chart)
        severity = Severity.WARNING if is_open else None
        fixes = _take(context, waiting.state.element)
        yield RULE.at(waiting.span, message, *fixes, severity=severity)
    for state in running_without(behavior, ProtocolPart.BT_TICK):
        if state.id is not None and state.id.value not in reported:
            message = (
                f"the plugin is running in the state `{state.id.value}`, which does not handle a tick, unlike its "
                "other states; a tick that arrives there waits; add a `<bt_tick>` that returns RUNNING"
            )
            yield RULE.at(state.id.span, message, *_take(context, state.element), severity=Severity.WARNING)


def _without_conditions(chart: Chart) -> set[str]:
    """The states that a machine can enter without a condition. A condition decides about a handler, and about later
    handlers of the same event. It may never hold, as one that tests the number of children."""
    states = {state.id.value: state for state in chart.states if state.id is not None}
    entered = {chart.initial.value} if chart.initial is not None else set(states)
    waiting = [states[name] for name in entered & states.keys()]
    while waiting:
        conditional: set[object] = set()
        for handler in waiting.pop().handlers:
            event = handler.trigger, handler.event.value if handler.event is not None else ""
            if handler.cond is not None:
                conditional.add(event)
            elif event not in conditional:
                names = {to.state.value for to in handler.targets if to.state is not None} - entered
                entered |= names
                waiting += [states[name] for name in names & states.keys()]
    return entered


def _take(context: MachineContext, state: object) -> Iterator[Fix]:
    """A fix that adds a handler to a state that does not handle ticks; the handler returns RUNNING."""
    for candidate in context.machine.chart.states:
        if candidate.element is state and candidate.id is not None and candidate.element.complete:
            lines = (
                f'<bt_tick target="{candidate.id.value}">',
                '    <bt_return_status status="RUNNING" />',
                "</bt_tick>",
            )
            edit = last_in(context.document, candidate.element, *lines)
            yield Fix(f"Return `RUNNING` from ticks in the state `{candidate.id.value}`", (edit,), preferred=False)


def _fixes(context: MachineContext, behavior: Behavior, path: OpenPath) -> Iterator[Fix]:
    """A fix that returns SUCCESS on the path. If the step ignores the tick, because the condition of the handler does
    not hold, the fix adds a handler that returns RUNNING."""
    step, element = path.step, path.step.handler.element
    if step.ignored and path.receives and element.complete:
        state = next((s for s in context.machine.chart.states if step.handler in s.handlers), None)
        if state is not None and state.id is not None:
            lines = (f'<bt_tick target="{state.id.value}">', '    <bt_return_status status="RUNNING" />', "</bt_tick>")
            yield Fix(
                "Return `RUNNING` if no condition holds",
                (after(context.document, element, *lines),),
                preferred=False,
            )
    title = "Return `SUCCESS` from the tick"
    yield from answered(context, path, behavior, title, (ANSWER,), preferred=False)


def _add_handler(context: MachineContext) -> Iterator[Fix]:
    """A fix that adds a `<bt_tick>` to the initial state; it returns SUCCESS at once."""
    document, chart = context.document, context.machine.chart
    state = next((s for s in chart.states if s.id and chart.initial and s.id.value == chart.initial.value), None)
    if state is not None and state.id is not None and state.element.complete:
        lines = (f'<bt_tick target="{state.id.value}">', f"    {ANSWER}", "</bt_tick>")
        edit = last_in(document, state.element, *lines)
        yield Fix(f"Add `<bt_tick>` to the state `{state.id.value}`", (edit,), preferred=False)


RULE = Rule(
    "unanswered-tick",
    Severity.ERROR,
    "A tick is not handled, or does not return a status, on some path.",
    machine=check,
    whole=True,
)
