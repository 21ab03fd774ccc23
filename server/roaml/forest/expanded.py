# SPDX-License-Identifier: Apache-2.0
"""The trees of a forest with all subtrees expanded: each use of a tree, with the meaning of the names in it
(docs/spec/lone-trees.md#entries)."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial

from roaml.forest.forest import Forest
from roaml.forest.names import bound_entry, is_autoremapped
from roaml.forest.ports import ports_of
from roaml.model.expand import AUTOREMAP, Frame, TreeFileOutline, TreeOutline, Written, expand, tree_file_outline
from roaml.model.tree import TreeNode
from roaml.record import Record


class ExpandedTree(Record, frozen=True, eq=False):
    """A tree with its subtrees.

    Attributes:
        frames: its uses of trees, each after the enclosing one; the tree itself is first.
        executed: whether the tree is executed, or could be because no tree uses it and the files do not name the tree
            that is.
    """

    frames: tuple[Frame, ...]
    executed: bool


def forest_outlines(forest: Forest) -> tuple[TreeFileOutline, ...]:
    """The outlines of the files of trees without a system. They contain the attributes of `<SubTree>`, as in version 4,
    and of no other node."""
    return tuple(tree_file_outline(path, file, partial(_read, forest)) for path, file in forest.files)


def _read(forest: Forest, node: TreeNode) -> Written:
    if not forest.calls_tree(node):
        return False, ()
    is_autoremap = is_autoremapped(node, version_3=forest.is_of_version_3(node))
    attributes = [(AUTOREMAP, "true")] if is_autoremap else []
    for setting in ports_of(node):
        bound = bound_entry(forest, node, setting)
        attributes.append((setting.attribute.name, setting.value.value if bound is None else f"{{{bound}}}"))
    return True, tuple(attributes)


def expanded_trees(forest: Forest) -> Iterator[ExpandedTree]:
    """All trees of a forest, those that are executed first. A tree that is too large is left out
    (`TreeExtent.is_expanded`)."""
    files = forest_outlines(forest)
    seen: set[tuple[str, str]] = set()
    if forest.system is not None:
        frames = tuple(use.frame for use in forest.system.tree_uses)
        seen |= {(frame.tree.path, frame.tree.id) for frame in frames}
        tops = [number for number, frame in enumerate(frames) if frame.outer is None]
        for start, end in itertools.pairwise((*tops, len(frames))):
            yield ExpandedTree(frames[start:end], True)
    for tree, is_top in _tops_first(forest, files):
        if (tree.path, tree.id) not in seen:
            seen.add((tree.path, tree.id))
            frames = expand(files, tree, takes_all=True).frames
            seen |= {(frame.tree.path, frame.tree.id) for frame in frames}
            if frames:
                yield ExpandedTree(frames, is_top and forest.system is None and tree.id in forest.executed)


def _tops_first(forest: Forest, files: tuple[TreeFileOutline, ...]) -> Iterator[tuple[TreeOutline, bool]]:
    """The trees: first the executed one if the files name it, then those that no tree uses, then the others, which use
    each other, or are parts of a tree that is too large. The latter are marked by false."""
    trees = [tree for file in files for tree in file.trees if tree.root is not None]
    yield from ((tree, True) for tree in trees if tree.id == forest.main)
    used = frozenset[str]().union(*forest.subtrees.values())
    yield from ((tree, True) for tree in trees if tree.id not in used)
    yield from ((tree, False) for tree in trees)
