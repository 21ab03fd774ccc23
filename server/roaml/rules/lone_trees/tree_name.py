# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-name`, which tree_name.md describes."""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import remove
from roaml.forest.forest import CPP, Forest
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS
from roaml.libraries.version import NAMES_CHECKED_SINCE
from roaml.model.syntax import Name
from roaml.model.tree import Tree, nodes
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of

_FORBIDDEN = re.compile(r"[\x00-\x20\x7f<>&\"'/\\:*?|.]")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_RESERVED_PORTS = ("name", "ID", "_autoremap", *CONDITIONS, *AFTERWARDS)


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    is_checked = forest.settings.version >= NAMES_CHECKED_SINCE
    for tree in context.file.trees:
        if tree.id is not None:
            yield from _id(tree.id, "tree", is_checked)
            yield from _like_a_node(forest, tree.id)
        if is_checked:
            yield from _instances(tree)
    yield from _models(context, is_checked)


def _id(name: Name, kind_name: str, is_checked: bool) -> Iterator[Finding]:
    """Report a name of a tree or node that the library refuses. `is_checked`: whether its version checks the characters
    of names."""
    text = name.value
    if not text:
        yield RULE.at(name.span, f"the name of a {kind_name} must not be empty")
    elif not is_checked:
        return
    elif text in ("Root", "root"):
        yield RULE.at(name.span, f"BehaviorTree.CPP refuses `{text}` as the name of a {kind_name}; choose another name")
    elif match := _FORBIDDEN.search(text):
        shown = "white space" if match[0].isspace() else f"`{match[0]}`"
        yield RULE.at(name.span, f"BehaviorTree.CPP refuses {shown} in the name of a {kind_name}")


def _like_a_node(forest: Forest, name: Name) -> Iterator[Finding]:
    known = CPP.nodes.get(name.value)
    if (known is not None and not known.until) or name.value in forest.models:
        yield RULE.at(name.span, f"there is a node `{name.value}`; a tree needs another name")
        return
    for library in forest.libraries:
        if name.value in library.nodes:
            title = library.nodes[name.value].library
            message = f"{title} has a node `{name.value}`; a tree needs another name"
            severity = Severity.ERROR if library.name in forest.settings.libraries else Severity.WARNING
            yield RULE.at(name.span, message, severity=severity)


def _instances(tree: Tree) -> Iterator[Finding]:
    first: dict[str, Name] = {}
    for node in nodes(tree):
        if node.name is None:
            continue
        if _CONTROL.search(node.name.value):
            yield RULE.at(node.name.span, "BehaviorTree.CPP refuses control characters in the name of a node")
        if node.is_subtree:
            earlier = first.setdefault(node.name.value, node.name)
            if earlier is not node.name:
                message = (
                    f"two `<SubTree>` nodes of a tree must not have the same name `{node.name.value}`; rename one of "
                    "them"
                )
                yield RULE.at(
                    node.name.span, message, related=[Related(earlier.span, "the first `SubTree` with this name")]
                )


def _models(context: TreeContext, is_checked: bool) -> Iterator[Finding]:
    lists = [child for child in context.file.element.elements if child.name == "TreeNodesModel"]
    for extra in lists[1:]:
        message = (
            "BehaviorTree.CPP reads only the first `<TreeNodesModel>` of a file; move these models to the first one"
        )
        related = [Related(lists[0].name_span, "the first `<TreeNodesModel>`")]
        yield RULE.at(extra.name_span, message, related=related, severity=Severity.WARNING)
    first: dict[str, Name] = {}
    for model in context.file.models:
        if model.id is None:
            continue
        yield from _id(model.id, "node", is_checked)
        earlier = first.setdefault(model.id.value, model.id)
        if earlier is not model.id:
            drop = remove(context.document, model.element)
            message = f"`{model.id.value}` is described twice; remove one description"
            related = [Related(earlier.span, "the first description")]
            yield RULE.at(model.id.span, message, drop, related=related, severity=Severity.WARNING)
        ports: dict[str, Name] = {}
        for port in model.ports:
            if port.name is None:
                continue
            if ports.setdefault(port.name.value, port.name) is not port.name:
                message = (
                    f"the port `{port.name.value}` of `{model.id.value}` is described twice; remove one description"
                )
                related = [Related(ports[port.name.value].span, "the first description")]
                yield RULE.at(port.name.span, message, related=related, severity=Severity.WARNING)
            if is_checked:
                yield from _port(port.name)


def _port(name: Name) -> Iterator[Finding]:
    text = name.value
    if text in _RESERVED_PORTS:
        yield RULE.at(name.span, f"BehaviorTree.CPP refuses `{text}` as the name of a port: it has a special meaning")
    elif not text[:1].isalpha() or not text[:1].isascii():
        yield RULE.at(name.span, "the name of a port must begin with a letter")
    elif match := _FORBIDDEN.search(text):
        shown = "white space" if match[0].isspace() else f"`{match[0]}`"
        yield RULE.at(name.span, f"BehaviorTree.CPP refuses {shown} in the name of a port")


RULE = Rule("tree-name", Severity.ERROR, "BehaviorTree.CPP refuses a name, or the name is not unique.", tree=check)
