# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-plugin`, which unknown_plugin.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import rename_tag
from roaml.model.system import library_plugins
from roaml.model.tree import TreeNode, nodes
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, replacements
from roaml.text import Span, TextEdit


def check(context: TreeContext) -> Iterator[Finding]:
    for tree in context.file.trees:
        for node in nodes(tree):
            if not node.is_subtree:
                yield from _check(context, node)


def _check(context: TreeContext, node: TreeNode) -> Iterator[Finding]:
    """Check that a node has a plugin. Nodes of a tree that no system lists are not checked: their plugins are
    unknown."""
    system = context.system
    if system is None or node.plugin is None or system.plugin(node.plugin.value)[1] is not None:
        return
    name = node.plugin.value
    if node.type is not None and not node.type.translated:
        reason = node.type.documentation.rpartition("It cannot be translated")[2].strip(" ;:.")
        why = f": {reason}" if reason else ""
        yield RULE.at(node.plugin.span, f"`{name}` of BehaviorTree.CPP cannot be translated{why}")
        return
    if name in [tree.id for file in context.files for tree in file.trees]:
        yield RULE.at(node.plugin.span, f'`{name}` is a tree: write `<SubTree ID="{name}"/>`', *_subtree(node, name))
        return
    misplaced = name in [outline.name for _, outline in system.nodes]
    if not misplaced and not system.plugins_known:
        return  # another rule reports the listed file that cannot be read and may contain the plugin
    close = close_names(name, [*(outline.name for _, outline in system.plugins), *library_plugins()])
    hint = did_you_mean(close) or "; list its file in `<behavior_tree>` of the system"
    if misplaced:
        hint = "; its file is listed in `<node_models>`, but plugins must be listed in `<behavior_tree>`"
        close = ()
    fixes = _compact_fixes(node, close) if node.compact else replacements(node.plugin.span, close)
    yield RULE.at(node.plugin.span, f"there is no plugin `{name}`{hint}", *fixes)


def _compact_fixes(node: TreeNode, names: tuple[str, ...]) -> Iterator[Fix]:
    for number, name in enumerate(names):
        yield rename_tag(node.element, name, preferred=number == 0)


def _subtree(node: TreeNode, name: str) -> Iterator[Fix]:
    if node.compact and not node.children:
        rename = rename_tag(node.element, "SubTree")
        at = node.element.name_span.end
        yield Fix(f'Change to `<SubTree ID="{name}">`', (*rename.edits, TextEdit(Span(at, at), f' ID="{name}"')))


RULE = Rule("unknown-plugin", Severity.ERROR, "No plugin has the name of a node of the tree.", tree=check)
