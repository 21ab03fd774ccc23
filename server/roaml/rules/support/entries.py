# SPDX-License-Identifier: Apache-2.0
"""The blackboard entries of trees that belong to no system, computed once for all rules."""

from __future__ import annotations

import functools
from collections import defaultdict
from collections.abc import Mapping

from roaml.forest.entries import BoundUse, Entries, find_entries
from roaml.forest.forest import Forest


@functools.lru_cache(maxsize=1)
def entries_of(forest: Forest) -> Entries:
    """The entries of a forest. The result for the last forest is cached, because several rules need it; a forest is
    immutable and compared by identity."""
    return find_entries(forest)


def is_of_subtree(forest: Forest, bound: BoundUse) -> bool:
    """Whether a tree is executed only as a part of the main tree, so that programs neither set nor read its own
    entries."""
    is_main = bound.frame.outer is None or bound.use.tree == forest.main
    return forest.main is not None and forest.complete and not is_main and not bound.use.name.startswith("@")


def names_of(forest: Forest, tree: str) -> frozenset[str]:
    """The names of the entries that the ports and scripts of a tree may create."""
    return _names_by_tree(forest).get(tree, frozenset())


@functools.lru_cache(maxsize=1)
def _names_by_tree(forest: Forest) -> Mapping[str, frozenset[str]]:
    names: dict[str, set[str]] = defaultdict(set)
    for use in entries_of(forest).uses:
        if use.creates:
            names[use.tree].add(use.name)
    return {tree: frozenset(of_tree) for tree, of_tree in names.items()}
