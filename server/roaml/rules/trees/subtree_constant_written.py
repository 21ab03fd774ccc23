# SPDX-License-Identifier: Apache-2.0
"""The rule `subtree-constant-written`, which subtree_constant_written.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.forest.entries import Use
from roaml.forest.forest import Forest
from roaml.forest.names import bound_entry
from roaml.forest.ports import ports_of
from roaml.model.expand import PortConstant
from roaml.roles import Direction
from roaml.rules.rule import Rule, TreeContext, replacements
from roaml.rules.support.entries import entries_of
from roaml.rules.support.forest import trees_of
from roaml.rules.support.instances import instances


def check(context: TreeContext) -> Iterator[Finding]:
    """Report a subtree that writes a variable for which its `<SubTree>` passes a constant
    (docs/spec/trees.md#subtrees)."""
    forest = trees_of(context)
    if forest is not None and (context.system is None or not context.system.is_as2fm):
        yield from _lost_changes(forest)
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


def _lost_changes(forest: Forest) -> Iterator[Finding]:
    """Report a constant for an entry that scripts of the subtree change, if its model declares an output, or if nothing
    reads the entry with this name of the tree around it."""
    for tree, node in forest.own_nodes:
        name = node.plugin.value if node.plugin else ""
        model = forest.subtree_models.get(name)
        for setting in ports_of(node) if forest.calls_tree(node) else ():
            key = setting.attribute.name
            inside = _uses(forest, name, key)
            if bound_entry(forest, node, setting) is not None or not any(use.script and use.writes for use in inside):
                continue
            port = model.port(key) if model is not None else None
            around = _uses(forest, tree.id.value if tree.id else "", key)
            is_unread = bool(around) and all(use.writes and use.reads is False for use in around)
            if is_unread or (port is not None and port.direction.writes):
                message = (
                    f"the subtree changes `{key}`, but it is {setting.value.value} again each time the subtree begins, "
                    "so the change is lost; pass an entry"
                )
                fixes = replacements(setting.value.span, [f"{{{key}}}"] if around else [])
                yield RULE.at(setting.value.span, message, *fixes, severity=Severity.WARNING)


def _uses(forest: Forest, tree: str, name: str) -> list[Use]:
    """The places that refer to the entries that have a name in a tree."""
    entries = entries_of(forest)
    return [bound.use for key in entries.entries(tree, name) for bound in entries.by_entry.get(key, ())]


RULE = Rule(
    "subtree-constant-written",
    Severity.ERROR,
    "A subtree writes a variable for which a constant is passed.",
    tree=check,
)
