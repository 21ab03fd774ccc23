# SPDX-License-Identifier: Apache-2.0
"""shadowed-transition: see shadowed_transition.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.knowledge import Facts
from roaml.model.machine import Chart, Handler, Machine, State
from roaml.model.syntax import Name
from roaml.model.system import sanitise
from roaml.model.typing import find_handle
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.conditions import covered
from roaml.rules.support.elements import removal
from roaml.rules.support.layout import indent_of, remove
from roaml.text import Span, TextEdit

TOPIC = "message"


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for state in chart.states:
            yield from _check(context, chart, state)


def _check(context: MachineContext, chart: Chart, state: State) -> Iterator[Finding]:
    machine = context.machine
    certain: dict[tuple[str, str, int], Handler] = {}
    for handler in state.handlers:
        key = trigger(machine, handler)
        if key is None or not handler.effective:
            continue
        before = certain.get(key)
        if before is not None:
            what = "without an event" if handler.trigger == "" else "on the same event"
            yield RULE.at(
                handler.element.name_span,
                f"this is never taken: an earlier transition {what} has no condition",
                *_fixes(context, handler, before),
                related=(Related(before.element.name_span, "always taken first"),),
            )
        elif handler.cond is None and not chooses(handler):
            certain[key] = handler
    if len(state.handlers) > 1:
        yield from _same_condition(context, chart, state)


def _same_condition(context: MachineContext, chart: Chart, state: State) -> Iterator[Finding]:
    """Transitions whose conditions never hold where those of the earlier ones do not."""
    for handlers in _conditional(context.machine, state):
        yield from _in_order(context, condition_facts(chart), handlers)


def _conditional(machine: Machine, state: State) -> Iterator[list[Handler]]:
    """The handlers of a state with conditions, in groups with the same trigger."""
    groups: dict[tuple[str, str, int], list[Handler]] = {}
    for handler in state.handlers:
        key = trigger(machine, handler)
        if key is not None and handler.effective and handler.cond is not None and not chooses(handler):
            groups.setdefault(key, []).append(handler)
    return (handlers for handlers in groups.values() if len(handlers) > 1)


def has_shadowed(machine: Machine, chart: Chart, handler: Handler) -> bool:
    """Whether a handler for the same trigger as `handler`, in its state, has a condition that never decides."""
    state = next((state for state in chart.states if handler in state.handlers), None)
    groups = _conditional(machine, state) if state is not None else ()
    return any(
        any(covered(condition_facts(chart), [each.cond for each in handlers]))
        for handlers in groups
        if handler in handlers
    )


def _in_order(context: MachineContext, facts: Facts, handlers: list[Handler]) -> Iterator[Finding]:
    for found in covered(facts, [handler.cond for handler in handlers]):
        handler = handlers[found.number]
        earlier = [handlers[n] for n in found.by or range(found.number)]
        what = "without an event" if handler.trigger == "" else "on the same event"
        if found.same:
            why = f"an earlier transition {what} has the same condition"
        elif found.by:
            why = f"whenever its condition holds, that of an earlier transition {what} holds, too"
        else:
            why = f"whenever its condition holds, one of the earlier transitions {what} is taken"
        drop = remove(context.document, handler.element, "Remove this transition")
        message = f"this is never taken: {why}; change one of the conditions"
        related = [Related(each.element.name_span, "taken first") for each in earlier]
        yield RULE.at(handler.element.name_span, message, drop, severity=Severity.WARNING, related=related)


def _fixes(context: MachineContext, handler: Handler, earlier: Handler) -> Iterator[Fix]:
    """With a condition of its own the transition may come first; without one it is of no use."""
    document, element = context.document, handler.element
    if handler.cond is not None:
        text = document.text[slice(*element.span)]
        at, indent = earlier.element.span.start, indent_of(document.text, earlier.element)
        edits = (TextEdit(Span(at, at), f"{text}\n{indent}"), removal(document.text, element.span))
        yield Fix("Move it before the transition without a condition", edits)
    yield remove(document, element, "Remove this transition")


def trigger(machine: Machine, handler: Handler) -> tuple[str, str, int] | None:
    """What a handler waits for, comparable within its state; None if that is not written out.

    Two handles of one topic wait for the same message, results of different codes are different triggers.
    """
    attributes, code = handler.type.attributes, handler.type.code
    if "name" in attributes:
        declaration = find_handle(machine, handler)
        if handler.trigger == TOPIC and declaration is not None and isinstance(declaration.interface, Name):
            return (handler.trigger, sanitise(declaration.interface.value), code)
        return (handler.trigger, handler.handle.value, code) if handler.handle else None
    if handler.trigger == "event":
        return (handler.trigger, handler.event.value, code) if handler.event else None
    if "id" in attributes:
        return (handler.trigger, handler.child.value, code) if handler.child else None
    return (handler.trigger, "", code)


def chooses(handler: Handler) -> bool:
    """Whether the trigger itself selects: a child index in a variable stands for one condition per child."""
    return handler.child is not None and not handler.child.value.isdigit()


RULE = Rule(
    "shadowed-transition",
    Severity.ERROR,
    "A transition can never be taken because an earlier one always is.",
    machine=check,
)
