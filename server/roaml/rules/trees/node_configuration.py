# SPDX-License-Identifier: Apache-2.0
"""The rule `node-configuration`, which node_configuration.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.model.expand import Reference
from roaml.model.tree import PortSetting, TreeNode, nodes
from roaml.rules.rule import Rule, TreeContext, replacements
from roaml.rules.support.instances import instances
from roaml.rules.support.settings import constant_settings, integer_of


def check(context: TreeContext) -> Iterator[Finding]:
    """Report settings with which a node of BehaviorTree.CPP never returns a status (docs/spec/nodes.md#as2fm), ports
    that are set under two names, and blackboard variables for ports that need a constant."""
    yield from _set_twice(context)
    is_as2fm = context.system is not None and context.system.is_as2fm
    for node, key, text in constant_settings(context):
        if not is_as2fm and key in ("num_cycles", "num_attempts"):
            continue  # BehaviorTree.CPP accepts any number; `port-range` reports those without use
        number = integer_of(text) if key in _COUNTS else None
        problem = _problem(node, key, number) if number is not None else None
        if problem is not None:
            yield _finding(node, key, *problem)
    for node, automaton in instances(context):
        for attribute in node.type.ports if node.type else ():
            value = automaton.port(attribute.name)
            if attribute.port and attribute.port.constant and isinstance(value, Reference):
                reason = (
                    f"`{attribute.name}` is read once, at the start; it must be a constant, not a blackboard variable"
                )
                yield _finding(node, attribute.name, reason)


_COUNTS = ("success_count", "failure_count", "max_failures", "num_cycles", "num_attempts", "return_on_mismatch")
"""The ports that `_problem` checks."""


def _finding(node: TreeNode, key: str, reason: str, instead: int | None = None) -> Finding:
    """The finding for a setting; `instead` is the nearest valid value."""
    setting = next((port.value for port in node.ports if port.key.value == key), None)
    assert node.plugin is not None
    if setting is None:
        return RULE.at(node.plugin.span, reason)
    fixes = [] if instead is None or integer_of(setting.value) is None else replacements(setting.span, [str(instead)])
    return RULE.at(setting.span, reason, *fixes)


def _set_twice(context: TreeContext) -> Iterator[Finding]:
    """Report ports that are set under two names."""
    for tree in context.file.trees:
        for node in nodes(tree):
            settings: dict[str, PortSetting] = {}
            for setting in node.ports:
                first = settings.setdefault(setting.key.value, setting)
                written, other = setting.attribute.name, first.attribute.name
                if written != other:
                    message = f"`{written}` and `{other}` are two names of one port; remove one of them"
                    drop = Fix(f"Remove `{written}`", (removal(context.source.text, setting.attribute.span),))
                    yield RULE.at(setting.key.span, message, drop)


def _problem(node: TreeNode, key: str, number: int) -> tuple[str, int | None] | None:
    """The error in a setting, and the nearest valid value; `None` if the setting is valid."""
    count = len(node.children)
    match node.plugin.value if node.plugin and node.type is not None else "", key:
        case ("Parallel", "success_count" | "failure_count") if number > count > 0:
            return f"`{key}` must be at most the number of children, which is {count}, not {number}", count
        case ("Repeat", "num_cycles") | ("RetryUntilSuccessful" | "RetryUntilSuccesful", "num_attempts") if number < -1:
            return f"`{key}` must be -1 (for ever), 0 or greater, not {number}", -1
        case ("BlackboardCheckInt", "return_on_mismatch") if number not in (1, 2, 3):
            return f"the status must be 1 (SUCCESS), 2 (FAILURE) or 3 (RUNNING), not {number}", None
        case ("ParallelAll", "max_failures") if number > count > 0:
            return f"`max_failures` must be at most the number of children, which is {count}, not {number}", count
    return None


RULE = Rule("node-configuration", Severity.ERROR, "A node never returns a status because of its settings.", tree=check)
