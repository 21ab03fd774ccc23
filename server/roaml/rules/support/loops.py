# SPDX-License-Identifier: Apache-2.0
"""The loops of trees that repeat something, and not only because it has failed."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.forest.entries import BoundUse
from roaml.forest.forest import Forest
from roaml.model.expand import Frame, node_at
from roaml.model.tree import TreeNode

LOOPS = frozenset(("Repeat", "KeepRunningUntilFailure", "LoopInt", "LoopBool", "LoopDouble", "LoopString"))


def nodes_above(forest: Forest, bound: BoundUse) -> Iterator[tuple[Frame, TreeNode]]:
    """The nodes that contain a node, in all trees around it, the innermost first, each with the use of its tree."""
    files, node = dict(forest.files), bound.use.node
    frame: Frame | None = bound.frame
    while frame is not None:
        above = {
            child: outer for outer in files[frame.tree.path].nodes_by_tree[frame.tree.id] for child in outer.children
        }
        while node in above:
            node = above[node]
            yield frame, node
        called = None if frame.use is None else node_at(files[frame.use.path], frame.use)
        if called is None or frame.outer is None:
            return
        node, frame = called, frame.outer
        yield frame, node


def repeats(node: TreeNode) -> bool:
    """Whether a node may tick its child again after it has succeeded."""
    cycles = node.element.get("num_cycles")
    is_once = cycles is not None and cycles.value.strip() in ("0", "1")
    return node.type_name in LOOPS and not is_once
