# SPDX-License-Identifier: Apache-2.0
"""The rule `subtree-constant-written`, which subtree_constant_written.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.model.expand import PortConstant
from roaml.roles import Direction
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.instances import instances


def check(context: TreeContext) -> Iterator[Finding]:
    """Report a subtree that writes a variable for which its `<SubTree>` passes a constant
    (docs/spec/trees.md#subtrees)."""
    for node, automaton in instances(context):
        if context.system is not None and context.system.is_program(automaton):
            continue  # BehaviorTree.CPP creates a variable with this initial value
        for setting in node.ports:
            port = automaton.outline.port(setting.key.value)
            if port is None or port.direction is Direction.IN or setting.variable is None:
                continue
            value = automaton.port(port.key)
            if isinstance(value, PortConstant):
                message = (
                    f"`{setting.variable}` is the constant `{value.text}` in this subtree and cannot be written; "
                    "pass a variable"
                )
                yield RULE.at(setting.value.span, message)


RULE = Rule(
    "subtree-constant-written",
    Severity.ERROR,
    "A subtree writes a variable for which a constant is passed.",
    tree=check,
)
