# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-node`, which unknown_node.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal, rename_tag
from roaml.forest.forest import CPP, Forest
from roaml.libraries import Node
from roaml.model.tree import TreeNode
from roaml.record import replace
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of, probably_meant
from roaml.text import Span, TextEdit

_STRUCTURE = (
    *("root", "include", "BehaviorTree", "TreeNodesModel", "input_port", "output_port", "inout_port", "description"),
    "MetadataFields",
)
"""The elements of the format that are not nodes."""


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    undescribed: set[str] = set()
    for _, node in forest.own_nodes:
        if node.element.name == "SubTreePlus":
            yield _renamed(node.element.name_span, rename_tag(node.element, "SubTree"), "SubTreePlus", "SubTree")
        if node.plugin is not None and not node.is_subtree and not forest.names_tree(node):
            for finding in _check(context, forest, node):
                # A node that no model describes is reported once for each name.
                if finding.fixes or node.plugin.value not in undescribed:
                    yield finding
            undescribed.add(node.plugin.value)


def _renamed(span: Span, fix: Fix, name: str, now: str) -> Finding:
    return RULE.at(span, f"`{name}` is the name in version 3; write `{now}`", fix, severity=Severity.ERROR)


def _check(context: TreeContext, forest: Forest, node: TreeNode) -> Iterator[Finding]:
    assert node.plugin is not None
    name, span = node.plugin.value, node.plugin.span
    if forest.node(name) is not None or name in forest.beside:
        return
    renamed, absent, old = CPP.renamed.get(name), forest.absent(name), CPP.nodes.get(name)
    if renamed is not None:
        yield _renamed(span, _renaming(node, renamed.now), name, renamed.now)
    elif absent is not None:
        fixes = (_renaming(node, absent.instead),) if absent.instead else ()
        yield RULE.at(span, f"`{name}` cannot be a node of a tree: it is {absent.reason}", *fixes)
    elif old is not None and old.until:
        message = f"`{name}` is a node of version 3; version 4 has `Precondition` with a script"
        yield RULE.at(span, message, severity=Severity.ERROR)
    elif old is not None:
        yield RULE.at(
            span,
            f"`{name}` exists since version {old.since} of BehaviorTree.CPP, but the setting `behaviortree-cpp` names "
            "an older version",
            severity=Severity.ERROR,
        )
    elif node.compact and name in _STRUCTURE:
        drop = Fix(f"Remove `<{name}>`", (removal(context.source.text, node.element.span),), preferred=False)
        yield RULE.at(span, f"`<{name}>` is not a node, so it cannot be part of a tree", drop, severity=Severity.ERROR)
    else:
        yield from _unknown(context, forest, node, name)


def _unknown(context: TreeContext, forest: Forest, node: TreeNode, name: str) -> Iterator[Finding]:
    """Report a node that no model describes. The program may register it, so this is an error only if the end tag has
    another name; a name similar to that of a known node is always reported."""
    assert node.plugin is not None
    trees = tuple(forest.trees)
    close = node.element.close_name_span
    end = context.source.text[close.start : close.end] if close else ""
    if node.compact and end and end != name and (forest.node(end) is not None or end in trees):
        message = f"there is no node `{name}`; its end tag is `</{end}>`"
        yield RULE.at(node.plugin.span, message, rename_tag(node.element, end), severity=Severity.ERROR)
        return
    foreign = CPP.foreign.get(name)
    if foreign is not None and _has_children_of(node, CPP.nodes[foreign]):
        message = f"BehaviorTree.CPP has no node `{name}`; the node that other libraries call `{name}` is `{foreign}`"
        # With another name, the node may lack ports, so the user decides.
        yield RULE.at(node.plugin.span, message, replace(_renaming(node, foreign), preferred=False))
        return
    near = probably_meant(name, forest.names) or probably_meant(name, trees, most=1)
    if near is not None:
        kind_name = "tree" if near in trees and near not in forest.names else "node"
        known = forest.node(near)
        library = f" of {known.library}" if known is not None and known.library else ""
        message = f"there is no node `{name}`; did you mean the {kind_name} `{near}`{library}?"
        yield RULE.at(node.plugin.span, message, _renaming(node, near))
    elif forest.has_own_models or forest.libraries:
        severity = Severity.WARNING if forest.has_all_models else Severity.INFORMATION
        message = (
            f"no model describes the node `{name}`; describe it in a `<TreeNodesModel>` or in a file of the setting "
            "`tree-models`"
        )
        yield RULE.at(node.plugin.span, message, severity=severity)


def _has_children_of(node: TreeNode, known: Node) -> bool:
    """Whether the number of children of a node is that of `known`."""
    least, most = known.children
    return least <= len(node.children) <= most


def _renaming(node: TreeNode, name: str) -> Fix:
    assert node.plugin is not None
    if node.compact:
        return rename_tag(node.element, name)
    return Fix(f"Change to `{name}`", (TextEdit(node.plugin.span, name),), preferred=True)


RULE = Rule("unknown-node", Severity.WARNING, "A tree uses an unknown node.", tree=check)
