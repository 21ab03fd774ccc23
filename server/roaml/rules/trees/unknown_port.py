# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-port`, which unknown_port.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.edit.elements import removal
from roaml.libraries.node import EVENT_ATTRIBUTE
from roaml.libraries.programs.assembly import reads_world
from roaml.model.outline import MachineOutline
from roaml.model.system import CHILDREN_COUNT
from roaml.model.tree import TreeNode, nodes
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, listing, replacements


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is None:
        return
    for tree in context.file.trees:
        for node in nodes(tree):
            if not node.is_subtree and node.plugin is not None:
                path, plugin = context.system.plugin(node.plugin.value)
                if plugin is not None:
                    yield from _check(context, node, plugin, path)


def _check(context: TreeContext, node: TreeNode, plugin: MachineOutline, path: str) -> Iterator[Finding]:
    keys = [port.key for port in plugin.ports]
    related = [Related(Symbol(path, SymbolKind.MACHINE, plugin.name), "the plugin")] if path else []
    for setting in node.ports:
        key = setting.key
        edit = removal(context.source.text, setting.attribute.span)
        if key.value == EVENT_ATTRIBUTE and reads_world(plugin.name) and not path:
            continue
        if key.value == CHILDREN_COUNT:
            if CHILDREN_COUNT not in keys and path:
                continue  # no effect: a user's plugin that does not declare the port cannot read it
            message = f"`{CHILDREN_COUNT}` is set automatically and cannot be set here; remove it"
            yield RULE.at(key.span, message, Fix(f"Remove `{key.value}`", (edit,)), related=related)
        elif key.value not in keys and plugin.all_ports:
            given = {other.key.value for other in node.ports}
            free = [k for k in keys if k not in given]
            close = close_names(key.value, free)
            # A misspelled port would also be reported as missing.
            drop = [] if close else [Fix(f"Remove `{key.value}`", (edit,), preferred=False)]
            known = f"; it has {listing(keys)}" if keys else "; it has no ports"
            hint = did_you_mean(close) or known
            message = f"`{plugin.name}` has no port `{key.value}`{hint}"
            yield RULE.at(key.span, message, *replacements(key.span, close), *drop, related=related)


RULE = Rule("unknown-port", Severity.ERROR, "A node sets a port that its plugin does not have.", tree=check)
