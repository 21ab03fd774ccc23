# SPDX-License-Identifier: Apache-2.0
"""The rule `sent-too-early`, which sent_too_early.md describes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.tree import Name, walk
from roaml.model.machine import Assign, Chart, Param, RosSend, Send, Statement, bodies
from roaml.model.syntax import Expression
from roaml.model.value_types import ValueUse
from roaml.model.values.evaluate import place_of
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.words import words_of

_RECEIVED = ("_req.", "_res.", "_goal.", "_feedback.", "_wrapped_result.")
"""Data of messages and events should never be read after a statement that sends: late-event-data reports it."""

_PREVIOUS = frozenset(("previous", "prev", "last", "old", "former"))
"""Words in the names of variables and fields that keep an earlier value intentionally."""

_ENDS = frozenset(("cancel", "clear", "release", "stop", "undo", "unlock"))
"""Words in the names of messages and events that end what an earlier value began, before the next one begins."""


def check(context: MachineContext) -> Iterator[Finding]:
    for chart in context.machine.charts:
        found = list(_early(chart))
        reads = _reads(context, chart) if found else Counter[str]()
        for param, name, assign in found:
            # A variable that is read elsewhere, too, keeps the value for that purpose.
            if reads[name] == 1 and assign.location is not None:
                message = (
                    f"this sends the value that `{name}` got from the previous event, because `{name}` is assigned "
                    "after it; assign it first"
                )
                related = [Related(assign.element.name_span, "assigned here")]
                assert param.value is not None
                yield RULE.at(param.value.span, message, related=related)


def _early(chart: Chart) -> Iterator[tuple[Param, str, Assign]]:
    """The fields that get a variable which a later statement of the same content assigns from what has arrived."""
    for _, handler, body in bodies(chart):
        if handler is None:
            continue
        sent: dict[str, Param] = {}
        own = handler.handle.value if handler.handle is not None else ""
        for statement in body:
            if isinstance(statement, RosSend) and statement.handle is not None and statement.handle.value == own:
                break  # then the next request or response may arrive, so late-event-data reports what is read
            for param in _fields(statement) if _ENDS.isdisjoint(_name_words(statement)) else ():
                tree = param.value.tree if isinstance(param.value, Expression) and not param.value.broken else None
                words = words_of(param.name.value) if param.name is not None else []
                if isinstance(tree, Name) and _PREVIOUS.isdisjoint((*words, *words_of(tree.name))):
                    sent.setdefault(tree.name, param)
            if not isinstance(statement, Assign) or statement.location is None:
                continue
            name = place_of(statement.location.tree)
            value = place_of(statement.value.tree) if isinstance(statement.value, Expression) else None
            early = sent.pop(name, None) if name is not None else None
            if early is not None and name is not None and value is not None and value.startswith(_RECEIVED):
                yield early, name, statement


def _name_words(statement: Statement) -> list[str]:
    """The words in the name of what a statement sends."""
    match statement:
        case Send(event=name) | RosSend(handle=name) if name is not None:
            return words_of(name.value)
    return []


def _fields(statement: Statement) -> tuple[Param, ...]:
    match statement:
        case Send(params=params) | RosSend(fields=params):
            return params
    return ()


def _reads(context: MachineContext, chart: Chart) -> Counter[str]:
    """Variable -> the number of places that read it."""
    return Counter(
        node.name
        for value in context.typed.values
        if value.place.chart is chart and isinstance(value.value, Expression) and value.use is not ValueUse.LOCATION
        for node in walk(value.value.tree)
        if isinstance(node, Name)
    )


RULE = Rule(
    "sent-too-early",
    Severity.WARNING,
    "A handler sends a variable before it assigns the received value to it.",
    machine=check,
    whole=True,
)
