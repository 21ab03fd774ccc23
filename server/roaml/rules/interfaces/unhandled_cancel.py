# SPDX-License-Identifier: Apache-2.0
"""The rule `unhandled-cancel`, which unhandled_cancel.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.gaps import InterfaceAct
from roaml.model.machine import RosSend
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared

_HANDLES = InterfaceAct(SymbolKind.ACTION_SERVER, ProtocolPart.CANCEL)


def check(context: MachineContext) -> Iterator[Finding]:
    """Report cancel requests that the server handles in none of its states, so that it rejects all of them."""
    system = context.system
    if system is None:
        return
    reported: set[RosSend] = set()
    for declaration, _, action in declared(context, SymbolKind.ACTION_CLIENT):
        if not action.sources or any(ProtocolPart.CANCEL in server.use.receives for server in action.sources):
            continue
        if any(system.may(_HANDLES, action.name, server.automaton) for server in action.sources):
            continue
        for chart in context.machine.charts:
            for statement in chart.statements:
                if (
                    not isinstance(statement, RosSend)
                    or statement.part is not ProtocolPart.CANCEL
                    or statement in reported
                ):
                    continue
                if find_handle(context.machine, statement) is declaration:
                    reported.add(statement)
                    message = (
                        f"the server of `{action.name}` rejects every request to cancel a goal: "
                        "it has no `<ros_action_handle_cancel_goal>`; add one to the states in which a goal can be "
                        "canceled"
                    )
                    related = (Related(action.sources[0].symbol, "the server"),)
                    yield RULE.at(statement.element.name_span, message, related=related)


RULE = Rule(
    "unhandled-cancel",
    Severity.WARNING,
    "A client cancels a goal, but the server rejects the request.",
    machine=check,
    whole=True,
)
