# SPDX-License-Identifier: Apache-2.0
"""unused-tree: see unused_tree.md."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.forest.forest import Forest
from roaml.model.tree import nodes
from roaml.rules.rule import Rule, TreeContext, listing
from roaml.rules.support.forest import forest_of

MAX_TREES = 5
"""The maximum number of trees that a message lists."""


def check(context: TreeContext) -> Iterator[Finding]:
    forest = forest_of(context)
    if forest is None:
        return
    if sum(len(file.trees) for _, file in forest.files) > len(forest.trees):
        return  # a name is missing or not unique
    own = [tree.id for tree in context.file.trees if tree.id is not None]
    main = context.file.main
    if main is not None and main.value in forest.trees:
        used = _reached(forest, main.value)
        for name in own:
            if name.value not in used:
                message = f"the tree `{name.value}` is not part of `{main.value}`, which is executed"
                yield RULE.at(name.span, message)
    elif main is None and len(own) > 1:
        inner = {name for tree in own for name in _subtrees(forest, tree.value)}
        outer = [name.value for name in own if name.value not in inner]
        if len(outer) > 1:
            several = listing(outer[:MAX_TREES])
            message = (
                "`main_tree_to_execute` is missing, so the executed tree is ambiguous: "
                f"{several} are not part of another tree"
            )
            yield RULE.at(context.file.element.name_span, message)


def _subtrees(forest: Forest, name: str) -> Iterator[str]:
    known = forest.trees.get(name)
    for node in nodes(known[1]) if known else ():
        if node.plugin is not None and (node.is_subtree or forest.names_tree(node)):
            yield node.plugin.value


def _reached(forest: Forest, main: str) -> set[str]:
    reached, pending = {main}, [main]
    while pending:
        for name in _subtrees(forest, pending.pop()):
            if name not in reached:
                reached.add(name)
                pending.append(name)
    return reached


RULE = Rule("unused-tree", Severity.INFORMATION, "A tree is not part of the executed tree.", tree=check)
