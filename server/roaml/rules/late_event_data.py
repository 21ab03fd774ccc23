# SPDX-License-Identifier: Apache-2.0
"""late-event-data: see late_event_data.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.expr.tree import Expr, Name, walk
from roaml.model.syntax import Expression
from roaml.model.typing import TypedValue, Use
from roaml.rules.event_data_unavailable import known_here
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    """Event data are shared variables, read when the step that reads them is executed (spec/01 §12.2)."""
    for value in context.typed.values:
        if not value.place.late or not isinstance(value.value, Expression):
            continue
        known = known_here(value.place)
        name = next((n for n in _names(value.value.tree) if n.name in known), None) if known else None
        if name is not None:
            yield RULE.at(name.span, _message(value, name.name), severity=_severity(value))


def _names(tree: Expr) -> Iterator[Name]:
    return (node for node in walk(tree) if isinstance(node, Name))


def _message(value: TypedValue, name: str) -> str:
    advice = f"store what you need of `{name}` in a variable first thing in the body"
    match value.use:
        case Use.BRANCH:
            return f"this condition is evaluated in a later step, when `{name}` may already be newer; {advice}"
        case Use.ASSIGNED | Use.LOCATION:
            return f"here `{name}` may already be newer: something was sent or tested before; {advice}"
    return f"what is sent is read in a later step, when `{name}` may already be newer; {advice}"


def _severity(value: TypedValue) -> Severity | None:
    """Data of the tree protocol cannot be overtaken: a node answers once per tick. What is sent at once seldom is."""
    handler = value.place.handler
    if handler is not None and handler.trigger in ("child-status", "child-halted", "bt-tick", "bt-halt"):
        return Severity.HINT
    return Severity.HINT if value.use in (Use.PARAMETER, Use.FIELD, Use.ARGUMENT, Use.OUTPUT) else None


RULE = Rule(
    "late-event-data",
    Severity.WARNING,
    "Event data are read in a step in which they may belong to a newer event.",
    machine=check,
)
