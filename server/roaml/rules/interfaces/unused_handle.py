# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-handle`, which unused_handle.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity, Tag
from roaml.edit.elements import remove
from roaml.model.machine import Handler, RosSend
from roaml.model.value_types import find_handle
from roaml.model.vocabulary import DECLARING_ELEMENTS
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    machine = context.machine
    users: list[Handler | RosSend] = []
    for chart in machine.charts:
        users += [h for state in chart.states for h in state.handlers]
        users += [s for s in chart.statements if isinstance(s, RosSend)]
    used = [find_handle(machine, user) for user in users if "name" in user.type.attributes]
    with_threads = [thread.server.value for thread in machine.threads if thread.server]
    for declaration in machine.declarations:
        if declaration.handle is not None and not any(u is declaration for u in used):
            if declaration.kind is SymbolKind.ACTION_SERVER and declaration.handle.value in with_threads:
                continue
            is_timer = declaration.kind is SymbolKind.TIMER
            kind_name = "timer" if is_timer else f"`<{DECLARING_ELEMENTS[declaration.kind]}>`"
            message = f"the {kind_name} `{declaration.handle.value}` is never used"
            drop = remove(context.document, declaration.element, "Remove the declaration", preferred=True)
            yield RULE.at(declaration.handle.span, message, drop, tags=(Tag.UNNECESSARY,))


RULE = Rule(
    "unused-handle", Severity.HINT, "A ROS interface or timer is declared and never used.", machine=check, whole=True
)
