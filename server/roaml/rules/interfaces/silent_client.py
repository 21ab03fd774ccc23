# SPDX-License-Identifier: Apache-2.0
"""The rule `silent-client`, which silent_client.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import removal
from roaml.language import HL_SCXML
from roaml.model.machine import Declaration, RosSend
from roaml.model.value_types import find_handle
from roaml.model.vocabulary import DECLARING_ELEMENTS
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled

ANSWERS = {
    ProtocolPart.RESPONSE: (SymbolKind.SERVICE_CLIENT, "ros_service_send_request"),
    ProtocolPart.GOAL_RESPONSE: (SymbolKind.ACTION_CLIENT, "ros_action_send_goal"),
    ProtocolPart.FEEDBACK: (SymbolKind.ACTION_CLIENT, "ros_action_send_goal"),
    ProtocolPart.RESULT: (SymbolKind.ACTION_CLIENT, "ros_action_send_goal"),
    ProtocolPart.THREAD_FREE: (SymbolKind.ACTION_SERVER, "ros_action_thread_free"),
    ProtocolPart.THREAD_START: (SymbolKind.ACTION_SERVER, "ros_action_start_thread"),
}


def check(context: MachineContext) -> Iterator[Finding]:
    """Report handlers that wait for an answer to a request or goal that this machine never sends, once for each
    handle."""
    sent = set(_sent(context))
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.trigger not in ANSWERS or not handler.effective:
                    continue
                kind, element = ANSWERS[handler.trigger]
                declaration = find_handle(context.machine, handler)
                if declaration is None or declaration.kind != kind or declaration.handle is None:
                    continue
                if not {(declaration, element), (None, element)} & sent:
                    sent.add((declaration, element))
                    accepted = _accepted(context, declaration) if handler.trigger is ProtocolPart.THREAD_START else None
                    if accepted is not None:
                        message = (
                            "the goal that is accepted here is never given to a thread, so it is never executed; add "
                            f"`<{element}>`, or remove the thread"
                        )
                        related = (Related(handler.element.name_span, "this thread waits for the goal"),)
                        yield RULE.at(accepted.element.name_span, message, related=related)
                        continue
                    message = (
                        f"this handler is never taken: there is no `<{element}>` for the "
                        f"`<{DECLARING_ELEMENTS[kind]}>` "
                    )
                    message += f"`{declaration.handle.value}`; add one, or remove the handler"
                    yield RULE.at(handler.element.name_span, message, _without(context, declaration, element))


def _accepted(context: MachineContext, declaration: Declaration) -> RosSend | None:
    """The first statement that accepts a goal of the action."""
    sent = (s for chart in context.machine.charts for s in chart.statements if isinstance(s, RosSend))
    accepting = (statement for statement in sent if statement.part is ProtocolPart.GOAL_ACCEPTED)
    return next((s for s in accepting if find_handle(context.machine, s) is declaration), None)


def _without(context: MachineContext, declaration: Declaration, sender: str) -> Fix:
    """A fix that removes all handlers that wait for an answer to the element `sender`."""
    waiting = [
        handler.element
        for chart in context.machine.charts
        for state in chart.states
        for handler in state.handlers
        if handler.trigger in ANSWERS and ANSWERS[handler.trigger][1] == sender
        if find_handle(context.machine, handler) is declaration
    ]
    edits = tuple(removal(context.source.text, element.span) for element in waiting)
    return Fix("Remove the handlers that wait for the answer", edits, preferred=False)


def _sent(context: MachineContext) -> Iterator[tuple[Declaration | None, str]]:
    """The names of the sending elements of the machine, each after the declaration that it uses; `None` if the
    declaration or the element itself cannot be read."""
    for chart in context.machine.charts:
        for statement in chart.statements:
            if isinstance(statement, RosSend):
                yield find_handle(context.machine, statement), statement.element.name
    read = {statement.element for chart in context.machine.charts for statement in chart.statements}
    unread = [element for element in context.machine.element.walk() if element not in read]
    unknown = [element for element in unread if element.name not in HL_SCXML.elements]
    for name in dict.fromkeys(name for _, name in ANSWERS.values()):
        if any(element.name == name for element in unread) or misspelled.among(unknown, name, HL_SCXML):
            yield None, name


RULE = Rule(
    "silent-client",
    Severity.ERROR,
    "A handler waits for an answer to a request or goal that is never sent.",
    machine=check,
    whole=True,
)
