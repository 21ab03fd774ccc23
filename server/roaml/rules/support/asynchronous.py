# SPDX-License-Identifier: Apache-2.0
"""A fix for plugins that wait for time to pass before they answer a tick: they return RUNNING instead, and the status
at a later tick."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.diagnostics import Fix
from roaml.edit.elements import after, first_in, last_in
from roaml.model.machine import Handler, ReturnStatus, State, statements
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, unused
from roaml.scxml.names import STATUSES
from roaml.text import Edit, TextEdit, computed

RUNNING = '<bt_return_status status="RUNNING" />'


def rewritten(context: MachineContext, tick: Handler) -> Iterator[Fix]:
    """The fix, if the rewrite is mechanical: the tick only starts an operation, and all handlers that end the operation
    answer the tick and lead to the same state."""
    chart = context.machine.chart
    states = {state.id.value: state for state in chart.states if state.id}
    if tick.trigger is not ProtocolPart.BT_TICK or _answers(tick) or not _is_tidy(tick):
        return
    region = _region(tick, states)
    if region is None:
        return
    answering = [h for state in region for h in state.handlers if h.effective and _answers(h)]
    goals = {t.state.value for h in answering for t in h.targets if t.state}
    if len(goals) != 1 or not all(map(_is_tidy, answering)):
        return
    (goal,) = goals
    if goal not in states or states[goal].entry is not None or states[goal] in region:
        return
    yield Fix(
        "Return RUNNING, and the status at a later tick",
        lambda: computed(_edits(context, tick, region, answering, goal)),
    )


def _edits(
    context: MachineContext, tick: Handler, region: list[State], answering: list[Handler], goal: str
) -> Iterable[Edit]:
    chart, document = context.machine.chart, context.document
    variable = _fresh("answer", {d.id.value for d in chart.data if d.id})
    last = region[-1]
    assert last.id is not None
    done = _fresh(f"{last.id.value}_done", {state.id.value for state in chart.states if state.id})
    edits: list[Edit] = [last_in(document, tick.element, RUNNING), _declared(context, variable)]
    edits += (edit for handler in answering for edit in _stored(handler, variable, done))
    for state in region:
        at_once = any(h.effective and h.trigger is None and h.cond is None for h in state.handlers)
        if state.id is not None and not at_once:
            edits.append(last_in(document, state.element, *_asked(state.id.value, RUNNING)))
    answered = _asked(goal, f'<bt_return_status status="{variable}" />')
    lines = (f'<state id="{done}">', *(f"    {line}" for line in answered), "</state>")
    return [*edits, after(document, last.element, *lines)]


def _region(tick: Handler, states: Mapping[str, State]) -> list[State] | None:
    """The states in which the plugin waits after `tick` before it answers. `None` if one of them is undefined or
    incomplete, has an `<onentry>` or `<onexit>`, or handles ticks or halts."""
    region: list[State] = []
    waiting = [target.state for target in tick.targets]
    while waiting:
        name = waiting.pop(0)
        state = states.get(name.value) if name else None
        if state is None or state.entry or state.exit or not state.element.complete:
            return None
        if state in region:
            continue
        region.append(state)
        for handler in state.handlers:
            if handler.trigger in (ProtocolPart.BT_TICK, ProtocolPart.BT_HALT):
                return None
            if handler.effective and not _answers(handler):
                waiting += [target.state for target in handler.targets]
    return region


def _fresh(name: str, names: set[str]) -> str:
    return unused(name, names) if name in names else name


def _asked(state: str, answer: str) -> tuple[str, ...]:
    """The lines of a handler of ticks, which sends `answer`, and of a handler of halts; both stay in the state
    `state`."""
    return (
        f'<bt_tick target="{state}">',
        f"    {answer}",
        "</bt_tick>",
        f'<bt_halt target="{state}">',
        "    <bt_return_halted />",
        "</bt_halt>",
    )


def _answers(handler: Handler) -> bool:
    return any(isinstance(s, ReturnStatus) for t in handler.targets for s in statements(t.body))


def _is_tidy(handler: Handler) -> bool:
    """Whether the handler is complete and has one target, given as an attribute."""
    return len(handler.targets) == 1 and handler.element.get("target") is not None and handler.element.complete


def _declared(context: MachineContext, variable: str) -> Edit:
    data = f'<data id="{variable}" type="int8" expr="{STATUSES["RUNNING"]}" />'
    root = context.machine.element
    model = root.find("datamodel")
    if model is not None and model.complete:
        return last_in(context.document, model, data)
    return first_in(context.document, root, "<datamodel>", f"    {data}", "</datamodel>")


def _stored(handler: Handler, variable: str, done: str) -> Iterator[TextEdit]:
    """The edits that make a handler store the status instead of returning it, and lead to the state that returns it."""
    target = handler.element.get("target")
    assert target is not None
    yield TextEdit(target.value_span, done)
    for statement in statements(handler.targets[0].body):
        if isinstance(statement, ReturnStatus) and statement.status is not None:
            word = statement.status.value
            value = str(STATUSES[word]) if word in STATUSES else word
            yield TextEdit(statement.element.span, f'<assign location="{variable}" expr="{value}" />')
