# SPDX-License-Identifier: Apache-2.0
"""The rule `node-configuration`, which node_configuration.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.libraries import Port
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
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
        known = context.trees.known_node(node) if context.trees is not None else None
        port = known.port(key) if known is not None and known.behaviour else None
        number = integer_of(text) if port is not None else None
        problem = _problem(node, port, number, is_as2fm=is_as2fm) if port and number is not None else None
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


def _problem(node: TreeNode, port: Port, number: int, *, is_as2fm: bool) -> tuple[str, int | None] | None:
    """The error in a setting, and the nearest valid value; `None` if the setting is valid."""
    count, limits = len(node.children), port.limits
    if limits is not None and limits.counts_children and number > count > 0:
        return f"`{port.name}` must be at most the number of children, which is {count}, not {number}", count
    # BehaviorTree.CPP accepts any number; `port-range` reports those without use.
    if limits is not None and is_as2fm and -1 in limits.special and number < -1:
        return f"`{port.name}` must be -1 (for ever), 0 or greater, not {number}", -1
    if port.system_constant and port.type == "NodeStatus" and number not in (SUCCESS, FAILURE, RUNNING):
        return f"the status must be 1 (SUCCESS), 2 (FAILURE) or 3 (RUNNING), not {number}", None
    return None


RULE = Rule("node-configuration", Severity.ERROR, "A node never returns a status because of its settings.", tree=check)
