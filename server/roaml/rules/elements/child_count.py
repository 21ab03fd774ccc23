# SPDX-License-Identifier: Apache-2.0
"""The rule `child-count`, which child_count.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal
from roaml.forest.forest import Forest
from roaml.language import BEHAVIOR_TREE
from roaml.model.gaps import GapAct
from roaml.model.outline import MachineOutline
from roaml.model.tree import TreeNode, nodes
from roaml.roles import UNBOUNDED, NodeKind
from roaml.rules.parser_rules import NESTING_TOO_DEEP
from roaml.rules.rule import Rule, TreeContext
from roaml.text import Span


def check(context: TreeContext) -> Iterator[Finding]:
    omitted = [f.span for f in context.document.findings if f.code == NESTING_TOO_DEEP.code]
    for tree in context.file.trees:
        for node in nodes(tree):
            if not node.element.complete or _lacks_content(node, omitted):
                continue  # its end or its content is not known
            if node.is_subtree:
                yield from _subtree(context, node)
            elif node.plugin is None:
                continue
            elif context.forest is not None:
                yield from _known(context, node, context.forest)
            elif node.plugin.value in BEHAVIOR_TREE.elements:
                yield from _builtin(context, node)
            elif context.system is not None:
                _, plugin = context.system.plugin(node.plugin.value)
                if plugin is not None:
                    yield from _own(context, node, plugin)


def _lacks_content(node: TreeNode, omitted: Sequence[Span]) -> bool:
    """Whether a node without children contains elements that are nested too deeply to be analysed."""
    whole = node.element.span
    return not node.children and any(whole.start <= span.start < whole.end for span in omitted)


def _subtree(context: TreeContext, node: TreeNode) -> Iterator[Finding]:
    if node.children:
        where = f"; its nodes are in the tree `{node.plugin.value}`" if node.plugin else ""
        message = f"`{node.element.name}` allows no children{where}"
        yield RULE.at(node.children[0].element.name_span, message, _without(context, node, 0))


def _builtin(context: TreeContext, node: TreeNode) -> Iterator[Finding]:
    """Check a node of BehaviorTree.CPP, whose number of children the schema defines."""
    if node.type is not None:
        allowed = node.type.any_child
        yield from _counted(context, node, *((allowed.least, allowed.most) if allowed else (0, 0)))


def _known(context: TreeContext, node: TreeNode, forest: Forest) -> Iterator[Finding]:
    """Check a node of a tree without a system: the number of children comes from libraries and models or, if these do
    not define the node, from its kind."""
    known = forest.known_node(node)
    if known is not None:
        yield from _counted(context, node, *known.children)
    elif not node.compact and not forest.is_version_3:
        yield from _counted(context, node, *NodeKind(node.element.name.lower()).children)


def _counted(context: TreeContext, node: TreeNode, least: int, most: int) -> Iterator[Finding]:
    if node.plugin is None:
        return
    count, name = len(node.children), node.plugin.value
    if most == 0:
        if count:
            yield RULE.at(
                node.children[0].element.name_span, f"`{name}` allows no children", _without(context, node, 0)
            )
    elif count > most:
        message = f"`{name}` allows only {_children(most)}"
        yield RULE.at(node.children[most].element.name_span, message, _without(context, node, most))
    elif count < least:
        yield _too_few(node, least, most)


def _own(context: TreeContext, node: TreeNode, plugin: MachineOutline) -> Iterator[Finding]:
    """Check a node with a plugin. The machine of the plugin ticks its children by their index, or by a variable, which
    may have any value."""
    count, calls = len(node.children), plugin.plugin
    least = max(calls.children, 1 if calls.any_child else 0)
    if count < least:
        yield _too_few(node, least, UNBOUNDED if calls.any_child else least)
    if calls.ticked_children is None or any(gap.act in (GapAct.TREE, GapAct.ANYTHING) for gap in plugin.gaps):
        return
    for index, child in enumerate(node.children):
        span = child.element.name_span
        if index >= calls.children and not calls.any_child:
            if calls.children == 0:
                message = f"`{plugin.name}` allows no children: its machine never ticks a child"
            else:
                message = f"`{plugin.name}` ticks only {_children(calls.children)}, so this child is never ticked"
            yield RULE.at(span, message, _without(context, node, index))
            return
        if index not in calls.ticked_children:
            message = f'this child is never ticked: `{plugin.name}` has no `<bt_tick_child id="{index}">`'
            yield RULE.at(span, message)


def _without(context: TreeContext, node: TreeNode, most: int) -> Fix:
    """A fix that removes the children of a node after the first `most`."""
    extra = node.children[most:]
    edits = tuple(removal(context.source.text, child.element.span) for child in extra)
    surplus = "this child" if len(extra) == 1 else "the surplus children"
    return Fix(f"Remove {surplus}", edits, preferred=False)


def _too_few(node: TreeNode, least: int, most: int) -> Finding:
    assert node.plugin is not None
    if most >= UNBOUNDED:
        needed = f"at least {_children(least)}"
    else:
        needed = _children(least) if least == most else f"{least} to {_children(most)}"
    return RULE.at(node.plugin.span, f"`{node.plugin.value}` needs {needed} and has {len(node.children) or 'none'}")


def _children(count: int) -> str:
    return "one child" if count == 1 else f"{count} children"


RULE = Rule("child-count", Severity.ERROR, "A node has too few or too many children.", tree=check)
