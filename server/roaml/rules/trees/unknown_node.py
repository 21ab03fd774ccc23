# SPDX-License-Identifier: Apache-2.0
"""The rule `unknown-node`, which unknown_node.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Fix, Severity
from roaml.edit.elements import removal, rename_tag
from roaml.forest.forest import CPP, Forest
from roaml.libraries import Node
from roaml.model.syntax import Name
from roaml.model.tree import TreeNode
from roaml.record import replace
from roaml.rules.rule import Rule, TreeContext, close_names, replacements
from roaml.rules.support.forest import probably_meant, trees_of
from roaml.text import Span, TextEdit

_STRUCTURE = (
    *("root", "include", "BehaviorTree", "TreeNodesModel", "input_port", "output_port", "inout_port", "description"),
    "MetadataFields",
)
"""The elements of the format that are not nodes."""


def check(context: TreeContext) -> Iterator[Finding]:
    """Report the nodes that nothing declares. Without a system, the program may register them, so most findings are
    warnings."""
    trees = trees_of(context)
    if trees is None:
        return
    undescribed: set[str] = set()
    for node in (node for _, node in trees.own_nodes):
        if node.element.name == "SubTreePlus" and trees.system is None:
            yield _of_version_3(node.element.name_span, "SubTreePlus", "SubTree", rename_tag(node.element, "SubTree"))
        name = node.plugin
        if name is None or not trees.is_unknown(node):
            continue
        if name.value in trees.beside and name.value not in trees.trees:
            continue
        findings = _certain(context, trees, node, name)
        if not findings and name.value not in context.mock_patterns:
            findings = list(_undeclared(trees, node, name))
        for finding in findings:
            # Without a system, a node that no model describes is reported once for each name.
            if trees.system is not None or finding.fixes or name.value not in undescribed:
                yield finding
        undescribed.add(name.value)


def _certain(context: TreeContext, trees: Forest, node: TreeNode, name: Name) -> list[Finding]:
    """The finding about a name that is not that of a node; empty if the name may be one."""
    absent, old, foreign = CPP.absent.get(name.value), CPP.nodes.get(name.value), CPP.foreign.get(name.value)
    severity = _severity(trees)
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
    if name.value in trees.trees:
        message = f'`{name.value}` is a tree: write `<SubTree ID="{name.value}"/>`'
        return [RULE.at(name.span, message, *_subtree(node, name), severity=severity)]
    if end != name.value and (trees.node(end) is not None or end in trees.trees):
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


def _undeclared(trees: Forest, node: TreeNode, name: Name) -> Iterator[Finding]:
    """Report a name similar to that of a known node, and a name that nothing declares although the nodes of the program
    are known."""
    close, system = _meant(trees, node, name.value), trees.system
    message, severity = f"there is no node `{name.value}`", _severity(trees)
    if system is not None and name.value in [outline.name for _, outline in system.nodes]:
        message += "; its file is listed in `<node_models>`, but plugins must be listed in `<behavior_tree>`"
        close = ()
    elif system is not None and not system.plugins_known:
        return  # another rule reports the listed file that cannot be read and may contain the plugin
    elif close:
        message += f"; did you mean {'' if close[0] in trees.names else 'the tree '}`{close[0]}`?"
    elif system is not None:
        message += "; list the file of its plugin in `<behavior_tree>` of the system"
    elif trees.has_own_models or trees.libraries:
        severity = Severity.WARNING if trees.has_all_models else Severity.INFORMATION
        message = (
            f"no model describes the node `{name.value}`; describe it in a `<TreeNodesModel>` or in a file of the "
        )
        message += "setting `tree-models`"
    else:
        return
    yield RULE.at(name.span, message, *_renamings(node, name, close), severity=severity)


def _meant(trees: Forest, node: TreeNode, name: str) -> tuple[str, ...]:
    """The names that are probably intended. Without a system, the program may register nodes with similar names, so a
    leaf is not a misspelled node with children, nor the other way round."""
    if trees.system is not None:
        return close_names(name, trees.names)
    similar = [known for known in trees.names if _may_be(trees.node(known), node)]
    near = probably_meant(name, similar) or probably_meant(name, trees.trees, most=1)
    return () if near is None else (near,)


def _severity(trees: Forest) -> Severity | None:
    """The severity of a name that a program without a system could register."""
    return Severity.WARNING if trees.system is None else None


def _may_be(known: Node | None, node: TreeNode) -> bool:
    """Whether a node is a leaf like `known`, or has children like it, and sets no ports that `known` does not have
    unless it also sets one that it has. A leaf without ports is none that needs ports."""
    if known is None:
        return True
    if not (known.children[1] > 0 if node.children else known.children[0] == 0):
        return False
    if not node.ports:
        return bool(node.children) or not any(port.required for port in known.ports)
    return any(known.port(setting.key.value) is not None for setting in node.ports)


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
