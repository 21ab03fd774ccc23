# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-port`, which unused_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity, Tag
from roaml.edit.elements import remove
from roaml.model.system import CHILDREN_COUNT
from roaml.model.system_file import SystemSection
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.ports import reads, writes


def check(context: MachineContext) -> Iterator[Finding]:
    if context.listed_as == {SystemSection.NODE_MODELS}:
        return  # tree-element-in-node reports that a node has no ports
    used = {key.value for key in (*reads(context.machine, context.typed), *writes(context.machine))}
    for port in context.machine.ports:
        if port.key is not None and port.key.value not in used and port.key.value != CHILDREN_COUNT:
            # roaml.ide.code_actions.quick_fixes removes a port that the tree sets, because it must change the tree as
            # well.
            is_set = any(automaton.port(port.key.value) is not None for automaton in context.automata)
            fixes = [] if is_set else [remove(context.document, port.element, "Remove the port", preferred=True)]
            message = f"the port `{port.key.value}` is never used"
            yield RULE.at(port.key.span, message, *fixes, tags=(Tag.UNNECESSARY,))


RULE = Rule("unused-port", Severity.HINT, "A port is declared and never used.", machine=check, whole=True)
