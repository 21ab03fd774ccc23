# SPDX-License-Identifier: Apache-2.0
"""The rule `shadowed-transition`, which shadowed_transition.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import indent_of, removal, remove
from roaml.model.behavior.explore import condition_facts
from roaml.model.behavior.knowledge import ConditionFacts
from roaml.model.machine import Chart, Handler, State
from roaml.model.triggers import Trigger, chooses, trigger
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.conditions import covered
from roaml.rules.support.triggers import conditional
from roaml.text import Span, TextEdit


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        for state in chart.states:
            yield from _check(context, chart, state)


def _check(context: MachineContext, chart: Chart, state: State) -> Iterator[Finding]:
    machine = context.machine
    certain: dict[Trigger, Handler] = {}
    for handler in state.handlers:
        key = trigger(machine, handler)
        if key is None or not handler.effective:
            continue
        before = certain.get(key)
        if before is not None:
            when = "without an event" if handler.trigger is None else "on the same event"
            yield RULE.at(
                handler.element.name_span,
                (
                    f"this transition is never taken: an earlier transition {when} has no condition; add a condition "
                    "to the earlier one, or move this transition before it"
                ),
                *_fixes(context, handler, before),
                related=(Related(before.element.name_span, "always taken first"),),
            )
        elif handler.cond is None and not chooses(handler):
            certain[key] = handler
    if len(state.handlers) > 1:
        yield from _same_condition(context, chart, state)


def _same_condition(context: MachineContext, chart: Chart, state: State) -> Iterator[Finding]:
    """Report transitions whose conditions hold only where the condition of an earlier transition holds."""
    for handlers in conditional(context.machine, state):
        yield from _in_order(context, condition_facts(chart), handlers)


def _in_order(context: MachineContext, facts: ConditionFacts, handlers: list[Handler]) -> Iterator[Finding]:
    for cover in covered(facts, [handler.cond for handler in handlers]):
        handler = handlers[cover.number]
        earlier = [handlers[n] for n in cover.by or range(cover.number)]
        when = "without an event" if handler.trigger is None else "on the same event"
        if cover.same:
            why = f"an earlier transition {when} has the same condition"
        elif cover.by:
            why = f"whenever its condition holds, the condition of an earlier transition {when} holds as well"
        else:
            why = f"whenever its condition holds, one of the earlier transitions {when} is taken"
        drop = remove(context.document, handler.element, "Remove this transition")
        message = f"this transition is never taken: {why}; change one of the conditions"
        related = [Related(earlier_handler.element.name_span, "taken first") for earlier_handler in earlier]
        yield RULE.at(handler.element.name_span, message, drop, severity=Severity.WARNING, related=related)


def _fixes(context: MachineContext, handler: Handler, earlier: Handler) -> Iterator[Fix]:
    """Fixes for a transition that is never taken: move it before the earlier transition if it has a condition,
    otherwise remove it."""
    document, element = context.document, handler.element
    if handler.cond is not None:
        text = document.text[slice(*element.span)]
        at, indent = earlier.element.span.start, indent_of(document.text, earlier.element)
        edits = (TextEdit(Span(at, at), f"{text}\n{indent}"), removal(document.text, element.span))
        yield Fix("Move this transition before the one without a condition", edits)
    yield remove(document, element, "Remove this transition")


RULE = Rule(
    "shadowed-transition",
    Severity.ERROR,
    "A transition can never be taken because of earlier transitions.",
    machine=check,
)
