# SPDX-License-Identifier: Apache-2.0
"""The rule `unhandled-canceled-result`, which unhandled_canceled_result.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.edit.elements import after
from roaml.language import HL_SCXML
from roaml.model.machine import Declaration, Handler, RosSend, State
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support import misspelled

_CANCELED = 5
"""The code of the result of a canceled goal (`STATUS_CANCELED` of `action_msgs/GoalStatus`)."""
_HANDLER = "ros_action_handle_canceled_result"


def check(context: MachineContext) -> Iterator[Finding]:
    """Report clients that cancel goals and handle results, but do not handle the result of a canceled goal."""
    machine = context.machine
    requests = [
        statement
        for chart in machine.charts
        for statement in chart.statements
        if isinstance(statement, RosSend) and statement.part is ProtocolPart.CANCEL
    ]
    if not requests or misspelled.among(machine.element.walk(), _HANDLER, HL_SCXML):
        return
    handlers = [
        handler
        for chart in machine.charts
        for state in chart.states
        for handler in state.handlers
        if handler.trigger is ProtocolPart.RESULT
    ]
    first_of: dict[Declaration, RosSend] = {}
    for statement in requests:
        declaration = find_handle(machine, statement)
        if declaration is not None:
            first_of.setdefault(declaration, statement)
    for declaration, statement in first_of.items():
        own = [handler for handler in handlers if find_handle(machine, handler) is declaration]
        if own and not any(handler.type.code in (_CANCELED, 0) for handler in own):
            message = (
                f"the result of a canceled goal is dropped, so this client waits for ever: there is no `<{_HANDLER}>`; "
                "add one beside the handlers of the other results"
            )
            related = [Related(own[0].element.name_span, "another result is handled here")]
            yield RULE.at(statement.element.name_span, message, *_fixes(context, own), related=related)


def _fixes(context: MachineContext, handlers: list[Handler]) -> Iterator[Fix]:
    """A fix that adds a handler with the same target to each state that handles a result."""
    last_of: dict[State, Handler] = {}
    for chart in context.machine.charts:
        for state in chart.states:
            last_of.update((state, handler) for handler in handlers if handler in state.handlers)
    lines = [
        (handler, f'<{_HANDLER} name="{handler.handle.value}" target="{handler.targets[0].state.value}" />')
        for handler in last_of.values()
        if handler.handle and handler.targets and handler.targets[0].state
    ]
    if lines:
        edits = tuple(after(context.document, handler.element, line) for handler, line in lines)
        yield Fix(f"Add `<{_HANDLER}>` to each state that handles a result", edits, preferred=False)


RULE = Rule(
    "unhandled-canceled-result",
    Severity.WARNING,
    "A client cancels goals, but drops the result of a canceled goal.",
    machine=check,
    whole=True,
)
