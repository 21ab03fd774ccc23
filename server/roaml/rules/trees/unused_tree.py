# SPDX-License-Identifier: Apache-2.0
"""The rule `unused-tree`, which unused_tree.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Severity
from roaml.rules.rule import Rule, TreeContext, listing
from roaml.rules.support.forest import trees_of

MAX_TREES = 5
"""The maximum number of trees that a message lists."""


def check(context: TreeContext) -> Iterator[Finding]:
    forest = trees_of(context)
    if forest is None or forest.is_included:
        return
    if sum(len(file.trees) for _, file in forest.files) > len(forest.trees):
        return  # other rules report a name that is missing or not unique
    if any(name not in forest.trees for names in forest.subtrees.values() for name in names):
        return  # another rule reports a subtree that does not exist; its name may be misspelled
    own = [tree.id for tree in context.file.trees if tree.id is not None]
    main = context.file.main
    if main is not None and main.value in forest.trees:
        used = forest.reached(main.value)
        for name in own:
            if name.value not in used:
                message = f"the tree `{name.value}` is not part of `{main.value}`, which is executed"
                yield RULE.at(name.span, message)
    elif main is None and len(own) > 1 and context.system is None:  # tree-structure reports it in a system
        inner = {name for tree in own for name in forest.subtrees[tree.value]}
        outer = [name.value for name in own if name.value not in inner]
        if len(outer) > 1:
            several = listing(outer[:MAX_TREES])
            message = (
                "`main_tree_to_execute` is missing, so the executed tree is ambiguous: "
                f"{several} are not part of another tree"
            )
            yield RULE.at(context.file.element.name_span, message)


RULE = Rule("unused-tree", Severity.INFORMATION, "A tree is not part of the executed tree.", tree=check)
