# SPDX-License-Identifier: Apache-2.0
"""The nodes of a tree file, with their automata in the executed tree."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.system import SystemAutomaton
from roaml.model.tree import TreeNode, nodes
from roaml.rules.rule import TreeContext


def instances(context: TreeContext) -> Iterator[tuple[TreeNode, SystemAutomaton]]:
    """Every node of the file with each automaton that it becomes: none if it is not executed, several in a repeated
    subtree."""
    if context.system is None:
        return
    at: dict[tuple[str, int], TreeNode] = {}
    for tree in context.file.trees:
        for position, node in enumerate(nodes(tree)):
            at.setdefault((tree.id.value if tree.id else "", position), node)
    for automaton in context.system.automata:
        if automaton.instance is not None and automaton.instance.source.path == context.source.path:
            source = automaton.instance.source
            source_node = at.get((source.tree, source.position))
            if source_node is not None:
                yield source_node, automaton
