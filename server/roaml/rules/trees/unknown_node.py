# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-node`, which unknown_node.md describes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal, rename_tag
from roaml.forest.forest import CPP, Forest
from roaml.libraries import Node
from roaml.model.syntax import Name
from roaml.model.system import System, library_plugins
from roaml.model.tree import TreeNode, nodes
from roaml.record import replace
from roaml.rules.rule import Rule, TreeContext, close_names, did_you_mean, replacements
from roaml.rules.support.forest import forest_of, probably_meant
from roaml.text import Span, TextEdit

_STRUCTURE = (
    *("root", "include", "BehaviorTree", "TreeNodesModel", "input_port", "output_port", "inout_port", "description"),
    "MetadataFields",
)
"""The elements of the format that are not nodes."""


def check(context: TreeContext) -> Iterator[Finding]:
    if context.system is not None:
        yield from _of_system(context, context.system)
    elif (forest := forest_of(context)) is not None:
        yield from _alone(context, forest)


def _of_system(context: TreeContext, system: System) -> Iterator[Finding]:
    """Report the nodes for which a system has neither a plugin nor a node of a library."""

    def is_known(name: str) -> bool:
        return system.plugin(name)[1] is not None

    trees = [tree.id for file in context.files for tree in file.trees]
    for tree in context.file.trees:
        for node in nodes(tree):
            if not node.is_subtree and node.plugin is not None and not is_known(node.plugin.value):
                yield from _certain(context, node, node.plugin, is_known, trees) or _no_plugin(
                    system, node, node.plugin
                )


def _no_plugin(system: System, node: TreeNode, name: Name) -> Iterator[Finding]:
    current = (known for known in library_plugins() if known not in CPP.renamed)
    close = close_names(name.value, [*(outline.name for _, outline in system.plugins), *current])
    hint = did_you_mean(close) or "; list the file of its plugin in `<behavior_tree>` of the system"
    if name.value in [outline.name for _, outline in system.nodes]:
        hint = "; its file is listed in `<node_models>`, but plugins must be listed in `<behavior_tree>`"
        close = ()
    elif not system.plugins_known:
        return  # another rule reports the listed file that cannot be read and may contain the plugin
    yield RULE.at(name.span, f"there is no node `{name.value}`{hint}", *_renamings(node, name, close))


def _alone(context: TreeContext, forest: Forest) -> Iterator[Finding]:
    """Report the nodes that no model and no library describes. The program may register them, so most findings are
    warnings."""

    def is_known(name: str) -> bool:
        return forest.node(name) is not None or name in forest.trees

    undescribed: set[str] = set()
    for _, node in forest.own_nodes:
        name = node.plugin
        if node.element.name == "SubTreePlus":
            yield _of_version_3(node.element.name_span, "SubTreePlus", "SubTree", rename_tag(node.element, "SubTree"))
        if name is None or node.is_subtree or forest.names_tree(node) or forest.node(name.value) is not None:
            continue
        own_trees = () if node.compact else forest.trees
        if name.value in forest.beside and name.value not in own_trees:
            continue
        for finding in _certain(context, node, name, is_known, own_trees) or _undescribed(forest, node, name):
            # A node that no model describes is reported once for each name.
            if finding.fixes or name.value not in undescribed:
                yield finding
        undescribed.add(name.value)


def _certain(
    context: TreeContext, node: TreeNode, name: Name, is_known: Callable[[str], bool], trees: Iterable[str]
) -> list[Finding]:
    """The finding about a name that is not that of a node; empty if the name may be one.

    Args:
        is_known: whether there is a node, or a tree in a file without a system, of this name.
        trees: the trees that only a `<SubTree>` can use.
    """
    absent, old, foreign = CPP.absent.get(name.value), CPP.nodes.get(name.value), CPP.foreign.get(name.value)
    severity = None if context.system is not None else Severity.WARNING
    close = node.element.close_name_span
    end = context.source.text[close.start : close.end] if close and node.compact else name.value
    if name.value in CPP.renamed:
        now = CPP.renamed[name.value].now
        return [_of_version_3(name.span, name.value, now, *_renamings(node, name, (now,)))]
    if absent is not None:
        instead = (absent.instead,) if absent.instead else ()
        message = f"`{name.value}` cannot be a node of a tree: it is {absent.reason}"
        return [RULE.at(name.span, message, *_renamings(node, name, instead), severity=severity)]
    if old is not None and old.until:
        return [
            RULE.at(name.span, f"`{name.value}` is a node of version 3; version 4 has `Precondition` with a script")
        ]
    if old is not None:
        message = f"`{name.value}` exists since version {old.since} of BehaviorTree.CPP, but the setting "
        return [RULE.at(name.span, f"{message}`behaviortree-cpp` names an older version")]
    if node.compact and name.value in _STRUCTURE:
        drop = Fix(f"Remove `<{name.value}>`", (removal(context.source.text, node.element.span),), preferred=False)
        return [RULE.at(name.span, f"`<{name.value}>` is not a node, so it cannot be part of a tree", drop)]
    if name.value in trees:
        message = f'`{name.value}` is a tree: write `<SubTree ID="{name.value}"/>`'
        return [RULE.at(name.span, message, *_subtree(node, name), severity=severity)]
    if end != name.value and is_known(end):
        return [
            RULE.at(
                name.span, f"there is no node `{name.value}`; its end tag is `</{end}>`", rename_tag(node.element, end)
            )
        ]
    if foreign is not None and _has_children_of(node, CPP.nodes[foreign]):
        message = f"BehaviorTree.CPP has no node `{name.value}`; the node that other libraries call `{name.value}` is "
        # With another name, the node may lack ports, so the user decides.
        fixes = (replace(fix, preferred=False) for fix in _renamings(node, name, (foreign,)))
        return [RULE.at(name.span, f"{message}`{foreign}`", *fixes, severity=severity)]
    return []


def _of_version_3(span: Span, name: str, now: str, *fixes: Fix) -> Finding:
    return RULE.at(span, f"`{name}` is the name in version 3; write `{now}`", *fixes)


def _undescribed(forest: Forest, node: TreeNode, name: Name) -> Iterator[Finding]:
    """Report a name similar to that of a known node, and a name that no model describes although there are models."""
    trees = tuple(forest.trees)
    near = probably_meant(name.value, forest.names) or probably_meant(name.value, trees, most=1)
    if near is not None:
        kind_name = "the tree " if near in trees and near not in forest.names else ""
        message = f"there is no node `{name.value}`; did you mean {kind_name}`{near}`?"
        yield RULE.at(name.span, message, *_renamings(node, name, (near,)), severity=Severity.WARNING)
    elif forest.has_own_models or forest.libraries:
        severity = Severity.WARNING if forest.has_all_models else Severity.INFORMATION
        message = (
            f"no model describes the node `{name.value}`; describe it in a `<TreeNodesModel>` or in a file of the "
            "setting `tree-models`"
        )
        yield RULE.at(name.span, message, severity=severity)


def _has_children_of(node: TreeNode, known: Node) -> bool:
    """Whether the number of children of a node is that of `known`."""
    least, most = known.children
    return least <= len(node.children) <= most


def _renamings(node: TreeNode, name: Name, names: Iterable[str]) -> Iterator[Fix]:
    """A fix for each of `names` that makes it the type of a node, the first one preferred."""
    if not node.compact:
        yield from replacements(name.span, names)
    else:
        yield from (rename_tag(node.element, new, preferred=number == 0) for number, new in enumerate(names))


def _subtree(node: TreeNode, name: Name) -> Iterator[Fix]:
    if node.compact and not node.children:
        rename = rename_tag(node.element, "SubTree")
        at = node.element.name_span.end
        edits = (*rename.edits, TextEdit(Span(at, at), f' ID="{name.value}"'))
        yield Fix(f'Change to `<SubTree ID="{name.value}">`', edits)
    elif not node.children:
        yield rename_tag(node.element, "SubTree")


RULE = Rule("unknown-node", Severity.ERROR, "A tree uses an unknown node.", tree=check)
