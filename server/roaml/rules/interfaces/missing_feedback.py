# SPDX-License-Identifier: Apache-2.0
"""The rule `missing-feedback`, which missing_feedback.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import remove
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import Declaration, Handler
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared

_SENDS_FEEDBACK = InterfaceAct(SymbolKind.ACTION_SERVER, ProtocolPart.FEEDBACK)


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    for declaration, _, action in declared(context, SymbolKind.ACTION_CLIENT):
        if not action.sources or any(ProtocolPart.FEEDBACK in server.use.sends for server in action.sources):
            continue
        if any(system.may(_SENDS_FEEDBACK, action.name, server.automaton) for server in action.sources):
            continue
        for handler in _handlers(context, declaration):
            message = (
                f"this handler is never taken: the server of `{action.name}` never sends feedback; remove the handler"
            )
            related = (Related(action.sources[0].symbol, "the server"),)
            drop = remove(context.document, handler.element)
            yield RULE.at(handler.element.name_span, message, drop, related=related)


def _handlers(context: MachineContext, declaration: Declaration) -> Iterator[Handler]:
    for chart in context.machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.trigger is ProtocolPart.FEEDBACK and find_handle(context.machine, handler) is declaration:
                    yield handler


RULE = Rule(
    "missing-feedback",
    Severity.INFORMATION,
    "A handler waits for feedback that is never sent.",
    machine=check,
    whole=True,
)
