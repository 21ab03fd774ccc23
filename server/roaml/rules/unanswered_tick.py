# SPDX-License-Identifier: Apache-2.0
"""unanswered-tick: see unanswered_tick.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.language import HL_SCXML
from roaml.rules import misspelled, removed_bt_event
from roaml.rules.rule import MachineContext, Rule


def check(context: MachineContext) -> Iterator[Finding]:
    """A plugin that is used in the tree but cannot take or answer a tick stops the whole tree."""
    automaton = next((automaton for automaton in context.automata if automaton.instance is not None), None)
    if automaton is None or removed_bt_event.is_used(context.machine):
        return
    plugin, name, root = automaton.outline.plugin, context.machine.name, context.machine.element
    missing = "bt_tick" if not plugin.ticked else "bt_return_status" if not plugin.answers_tick else ""
    if not missing or misspelled.among(root.walk(), missing, HL_SCXML):
        return
    what = "takes no ticks" if missing == "bt_tick" else "never answers a tick"
    yield RULE.at(name.span if name else root.name_span, f"the plugin {what}: it has no `<{missing}>`")


RULE = Rule("unanswered-tick", Severity.ERROR, "A plugin cannot answer a tick.", machine=check)
