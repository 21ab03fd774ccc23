# SPDX-License-Identifier: Apache-2.0
"""Hover texts for nodes of a tree: their names in the translation of each system that executes the tree."""

from __future__ import annotations

from roaml.ide.describe import system as describe_system
from roaml.ide.hover.place import Place
from roaml.model.tree import TreeNode, nodes
from roaml.text import Span


def tree_node(place: Place) -> tuple[Span, str] | None:
    """The names in the translation of the node whose name or plugin is at a place; `None` if there is none."""
    analysis, path, offset = place.analysis, place.path, place.offset
    file = analysis.tree(path)
    for tree in file.trees if file else ():
        if not tree.element.span.contains(offset):
            continue
        for position, node in enumerate(nodes(tree)):
            span = name_at(node, offset)
            if span is not None:
                return span, describe_system.becomes(analysis, path, tree.id.value if tree.id else "", position)
    return None


def name_at(node: TreeNode, offset: int) -> Span | None:
    """The span of the tag, plugin or name of a node if it contains an offset; otherwise `None`."""
    spans = [node.element.name_span, *(name.span for name in (node.plugin, node.name) if name)]
    return next((span for span in spans if span.contains(offset)), None)
