# SPDX-License-Identifier: Apache-2.0
"""The rule `cancel-never-sent`, which cancel_never_sent.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.edit.elements import remove
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import Handler
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared

_CANCELS = InterfaceAct(SymbolKind.ACTION_CLIENT, ProtocolPart.CANCEL)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report handlers of cancel requests that no client sends. An action without any client is reported by
    missing-client."""
    if context.system is None:
        return
    reported: set[Handler] = set()
    for declaration, _, action in declared(context, SymbolKind.ACTION_SERVER):
        if not action.users or any(ProtocolPart.CANCEL in client.use.sends for client in action.users):
            continue
        if context.system.may(_CANCELS, action.name):
            continue
        for chart in context.machine.charts:
            for state in chart.states:
                for handler in state.handlers:
                    if handler.trigger is not ProtocolPart.CANCEL or handler in reported:
                        continue
                    if find_handle(context.machine, handler) is declaration:
                        reported.add(handler)
                        message = (
                            f"this handler is never taken: no client of `{action.name}` has a "
                            "`<ros_action_cancel_goal>`; add one, or remove the handler"
                        )
                        drop = remove(context.document, handler.element)
                        yield RULE.at(handler.element.name_span, message, drop)


RULE = Rule(
    "cancel-never-sent",
    Severity.INFORMATION,
    "A handler waits for cancel requests that no client sends.",
    machine=check,
    whole=True,
)
