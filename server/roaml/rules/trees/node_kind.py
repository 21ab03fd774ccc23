# SPDX-License-Identifier: Apache-2.0
"""The rule `node-kind`, which node_kind.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import rename_tag
from roaml.forest.forest import Forest
from roaml.libraries import Node
from roaml.libraries.version import TAGS_LOOKED_UP_SINCE
from roaml.model.tree import TreeNode
from roaml.roles import NodeKind
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import trees_of
from roaml.text import Span, TextEdit


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None:
        return
    for _, node in forest.own_nodes:
        known = forest.known_node(node)
        if known is None or forest.is_machine(known):
            continue
        if not node.compact and node.element.name != _tag(known):
            yield _finding(node, known)
        if known.name == "ReactiveSequence" and context.system is None:
            yield from _refused(context, forest, node)


def _tag(known: Node) -> str:
    return known.kind.value.capitalize()


def _finding(node: TreeNode, known: Node) -> Finding:
    tag = node.element.name
    # BehaviorTree.CPP uses the tag only to check the number of children.
    written = NodeKind(tag.lower())
    severity = Severity.INFORMATION if written.children == known.kind.children else None
    article = "an" if known.kind is NodeKind.ACTION else "a"
    message = f"`{known.name}` is {article} {known.kind.value}; write `<{_tag(known)}>` instead of `<{tag}>`"
    return RULE.at(node.element.name_span, message, rename_tag(node.element, _tag(known)), severity=severity)


def _refused(context: TreeContext, forest: Forest, node: TreeNode) -> Iterator[Finding]:
    """Report generic tags such as `<Action ID="X">` directly in a `ReactiveSequence`. A bug of BehaviorTree.CPP looks
    up these tags as names of nodes."""
    if forest.settings.version < TAGS_LOOKED_UP_SINCE:
        return
    for child in node.children:
        if child.compact or child.is_subtree or child.plugin is None:
            continue
        tag, name = child.element.name, child.plugin.value
        message = f'BehaviorTree.CPP refuses `<{tag} ID="{name}">` in a `ReactiveSequence`; write `<{name}>`'
        yield RULE.at(child.element.name_span, message, _compact(context, child))


def _compact(context: TreeContext, node: TreeNode) -> Fix:
    """A fix that writes the name of a node as its tag."""
    assert node.plugin is not None
    edits = list(rename_tag(node.element, node.plugin.value).edits)
    attribute = node.element.get("ID")
    if attribute is not None:
        start = attribute.span.start
        while context.source.text[start - 1].isspace():
            start -= 1
        edits.insert(1, TextEdit(Span(start, attribute.span.end), ""))
    return Fix(f"Change to `<{node.plugin.value}>`", tuple(edits), preferred=True)


RULE = Rule("node-kind", Severity.WARNING, "The tag of a node does not fit the node.", tree=check)
