# SPDX-License-Identifier: Apache-2.0
"""A plugin that waits within its tick, written so that it answers RUNNING and its status at a later tick."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Fix
from roaml.model.machine import Handler, ReturnStatus, statements
from roaml.model.typing import STATUSES
from roaml.rules.layout import after, first_in, last_in
from roaml.rules.rule import MachineContext, unused
from roaml.text import TextEdit

RUNNING = '<bt_return_status status="RUNNING" />'


def rewritten(context: MachineContext, tick: Handler) -> Iterator[Fix]:
    """The change, where it is mechanical: the tick only starts something, all that ends it stands in one state, and
    leads from there to one other."""
    chart, document = context.machine.chart, context.document
    states = {state.id.value: state for state in chart.states if state.id}
    target = tick.targets[0].state if len(tick.targets) == 1 else None
    waiting = states.get(target.value) if target else None
    if tick.trigger != "bt-tick" or waiting is None or waiting.id is None or waiting.entry or waiting.exit:
        return
    if any(isinstance(s, ReturnStatus) for s in statements(tick.targets[0].body)) or not tick.element.complete:
        return
    handlers = [h for h in waiting.handlers if h.effective]
    goals = {t.state.value for h in handlers for t in h.targets if t.state and _answers(h)}
    tidy = all(_is_tidy(h) for h in handlers) and waiting.element.complete
    if len(goals) != 1 or not tidy or any(h.trigger in ("bt-tick", "bt-halt") for h in handlers):
        return
    (goal,) = goals
    if states.get(goal) is None or states[goal].entry is not None:
        return
    variable = _fresh("answer", {d.id.value for d in chart.data if d.id})
    done = _fresh(f"{waiting.id.value}_done", set(states))
    edits = [last_in(document, tick.element, RUNNING), _declared(context, variable)]
    for handler in handlers:
        if _answers(handler):
            edits += _stored(handler, variable, done)
    edits.append(last_in(document, waiting.element, *_asked(waiting.id.value, RUNNING)))
    answered = _asked(goal, f'<bt_return_status status="{variable}" />')
    edits.append(
        after(document, waiting.element, f'<state id="{done}">', *(f"    {line}" for line in answered), "</state>")
    )
    yield Fix("Answer RUNNING, and the status at a later tick", tuple(edits))


def _fresh(name: str, names: set[str]) -> str:
    return unused(name, names) if name in names else name


def _asked(state: str, answer: str) -> tuple[str, ...]:
    """What a state does on a tick, and on a halt."""
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
    """Whether it answers at its very end or nowhere, and its target is an attribute."""
    return len(handler.targets) == 1 and handler.element.get("target") is not None and handler.element.complete


def _declared(context: MachineContext, variable: str) -> TextEdit:
    data = f'<data id="{variable}" type="int8" expr="{STATUSES["RUNNING"]}" />'
    root = context.machine.element
    model = root.find("datamodel")
    if model is not None and model.complete:
        return last_in(context.document, model, data)
    return first_in(context.document, root, "<datamodel>", f"    {data}", "</datamodel>")


def _stored(handler: Handler, variable: str, done: str) -> Iterator[TextEdit]:
    """Store the status in place of answering with it, and lead to the state that answers."""
    target = handler.element.get("target")
    assert target is not None
    yield TextEdit(target.value_span, done)
    for statement in statements(handler.targets[0].body):
        if isinstance(statement, ReturnStatus) and statement.status is not None:
            word = statement.status.value
            value = str(STATUSES[word]) if word in STATUSES else word
            yield TextEdit(statement.element.span, f'<assign location="{variable}" expr="{value}" />')
