# SPDX-License-Identifier: Apache-2.0
"""The rule `tree-name`, which tree_name.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.edit.elements import remove
from roaml.forest.forest import CPP, Forest
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS
from roaml.libraries.version import NAMES_CHECKED_SINCE, NEWEST_VERSION, Version
from roaml.model.syntax import Name
from roaml.model.tree import Tree, nodes
from roaml.regex import regex
from roaml.rules.rule import Rule, TreeContext
from roaml.rules.support.forest import forest_of

_FORBIDDEN = regex(r"[\x00-\x20\x7f<>&\"'/\\:*?|.]")
_CONTROL = regex(r"[\x00-\x1f\x7f]")
_RESERVED_PORTS = ("name", "ID", "_autoremap", *CONDITIONS, *AFTERWARDS)


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    for tree in context.file.trees:
        if tree.id is not None:
            if not tree.id.value:
                yield _empty(tree.id, "tree")
            yield from _like_a_node(forest, tree.id)
    yield from _models(context)
    yield from _refused(context, forest.settings.version)


def _refused(context: TreeContext, version: Version) -> Iterator[Finding]:
    """Report what versions refuse that check names. Without a setting, the version is not known, so this is a
    warning."""
    if version < NAMES_CHECKED_SINCE:
        return
    severity = Severity.WARNING if version == NEWEST_VERSION else Severity.ERROR
    for name, what in _checked_names(context):
        yield RULE.at(name.span, f"{_CHECKING} {what}", severity=severity)
    for tree in context.file.trees:
        for later, earlier in _equal_subtrees(tree):
            message = f"{_CHECKING} two `<SubTree>` of a tree with the same name `{later.value}`; rename one of them"
            related = [Related(earlier.span, "the first `SubTree` with this name")]
            yield RULE.at(later.span, message, related=related, severity=severity)


_CHECKING = "BehaviorTree.CPP refuses, from version 4.8.4 on,"


def _checked_names(context: TreeContext) -> Iterator[tuple[Name, str]]:
    """The names that the library refuses, each with what it refuses."""
    for tree in context.file.trees:
        yield from _wrong(tree.id, "tree")
        for node in nodes(tree):
            if node.name is not None and _CONTROL.search(node.name.value):
                yield node.name, "control characters in the name of a node"
    for model in context.file.models:
        yield from _wrong(model.id, "node")
        for port in model.ports if model.id is not None else ():
            yield from _wrong_port(port.name)


def _wrong(name: Name | None, kind_name: str) -> Iterator[tuple[Name, str]]:
    if name is None:
        return
    if name.value in ("Root", "root"):
        yield name, f"`{name.value}` as the name of a {kind_name}; choose another name"
    elif match := _FORBIDDEN.search(name.value):
        yield name, f"{_shown(match[0])} in the name of a {kind_name}"


def _wrong_port(name: Name | None) -> Iterator[tuple[Name, str]]:
    if name is None:
        return
    if name.value in _RESERVED_PORTS:
        yield name, f"`{name.value}` as the name of a port, because it has a special meaning"
    elif not name.value[:1].isalpha() or not name.value[:1].isascii():
        yield name, "the name of a port that does not begin with a letter"
    elif match := _FORBIDDEN.search(name.value):
        yield name, f"{_shown(match[0])} in the name of a port"


def _shown(character: str) -> str:
    return "white space" if character.isspace() else f"`{character}`"


def _empty(name: Name, kind_name: str) -> Finding:
    return RULE.at(name.span, f"the name of a {kind_name} must not be empty")


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


def _equal_subtrees(tree: Tree) -> Iterator[tuple[Name, Name]]:
    """The names of `<SubTree>` nodes that an earlier one of the tree has, each with the first name."""
    first: dict[str, Name] = {}
    for node in nodes(tree):
        if node.is_subtree and node.name is not None:
            earlier = first.setdefault(node.name.value, node.name)
            if earlier is not node.name:
                yield node.name, earlier


def _models(context: TreeContext) -> Iterator[Finding]:
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
        if not model.id.value:
            yield _empty(model.id, "node")
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


RULE = Rule("tree-name", Severity.ERROR, "BehaviorTree.CPP refuses a name, or the name is not unique.", tree=check)
