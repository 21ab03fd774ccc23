# SPDX-License-Identifier: Apache-2.0
"""The rule `event-data-unavailable`, which event_data_unavailable.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.expr.infer import UnknownName
from roaml.model.syntax import Expression
from roaml.model.value_types import TypedValue, ValuePlace, ValueUse
from roaml.model.vocabulary import EVENT_VARIABLES
from roaml.roles import ValuePart
from roaml.rules.rule import MachineContext, Rule, close_names, did_you_mean, listing, replacements
from roaml.rules.support.event_data import known_here
from roaml.text import Span, TextEdit

SCXML_VARIABLES = ("_name", "_sessionid", "_ioprocessors", "_x")
DATA = {"_event": "_event.data", "_wrapped_result": "_wrapped_result.result"}
"""The event variables whose fields are in a member, with the path of this member."""


def check(context: MachineContext) -> Iterator[Finding]:
    for value in context.typed.values:
        for problem in value.problems:
            if isinstance(problem, UnknownName) and problem.name.startswith("_") and not _is_target(value, problem):
                yield _finding(context, value, problem)


def _is_target(value: TypedValue, problem: UnknownName) -> bool:
    """Whether the event variable is the target of an assignment; invalid-location reports this with more detail."""
    return (
        value.use is ValueUse.LOCATION
        and problem.name in EVENT_VARIABLES
        and isinstance(value.value, Expression)
        and problem.span.start == value.value.tree.span.start
    )


def _finding(context: MachineContext, value: TypedValue, problem: UnknownName) -> Finding:
    known = known_here(value.place)
    name, place = problem.name, value.place
    tag = place_tag(place)
    if place.part is ValuePart.DATA:
        subject = "a bound" if value.use is ValueUse.BOUND else "an initial value"
        return RULE.at(problem.span, f"{subject} must be constant; it cannot use `{name}`")
    if name in SCXML_VARIABLES:
        return RULE.at(problem.span, f"`{name}` is a variable of SCXML that HL-SCXML does not support")
    if name not in EVENT_VARIABLES:
        variables = context.typed.variables.get(place.chart.scope, {})
        close = close_names(name, [*known, *variables])
        here = f"; `<{tag}>` provides {listing(known)}" if known and not close else ""
        message = f"there is no variable `{name}`{did_you_mean(close)}{here}"
        return RULE.at(problem.span, message, *replacements(problem.span, close))
    if place.part in (ValuePart.ENTRY, ValuePart.EXIT):
        if name == "_event" and context.machine.plain:
            # Machines without any ROS or tree element are not rewritten (docs/spec/machines.md#plain-machines).
            message = (
                f"`_event` in `<{place.part}>` is the event of the transition that is taken, which may be any event; "
                "store it in a variable in the body of the transition"
            )
            return RULE.at(problem.span, message, severity=Severity.WARNING)
        message = f"`{name}` is not available in `<{place.part}>`; store it in a variable in the body of the transition"
        return RULE.at(problem.span, message)
    if known:
        message = f"`{name}` is not available here; `<{tag}>` provides {listing(known)}"
        return RULE.at(problem.span, message, *_fixes(context, problem, known))
    if place.handler is not None and place.handler.trigger is None:
        message = (
            f"`{name}` is not available here, because this transition has no event; add the `event` whose data it uses"
        )
        return RULE.at(problem.span, message)
    return RULE.at(problem.span, f"`{name}` is not available here: `<{tag}>` has no data")


def _fixes(context: MachineContext, problem: UnknownName, known: list[str]) -> Iterator[Fix]:
    """Fixes that change the name to an event variable in `known`, for example `_event.data.x` to `_msg.x`."""
    old = DATA.get(problem.name, problem.name)
    names = [name for name in known if name != "_action"]
    start = problem.span.start
    if len(names) == 1 and problem.name != "_action" and context.source.text.startswith(f"{old}.", start):
        new = DATA.get(names[0], names[0])
        yield Fix(f"Change to `{new}`", (TextEdit(Span(start, start + len(old)), new),))


def place_tag(place: ValuePlace) -> str:
    return place.handler.element.name if place.handler else place.part.value


RULE = Rule(
    "event-data-unavailable",
    Severity.ERROR,
    "An event variable is used where its event is not available.",
    machine=check,
)
