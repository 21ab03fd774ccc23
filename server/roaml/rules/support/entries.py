# SPDX-License-Identifier: Apache-2.0
"""The blackboard entries of trees that belong to no system, computed once for all rules."""

from __future__ import annotations

import functools

from roaml.forest.entries import Entries, find_entries
from roaml.forest.forest import Forest


@functools.lru_cache(maxsize=8)
def entries_of(forest: Forest) -> Entries:
    """The entries of a forest. The result is cached: a forest is immutable and compared by identity."""
    return find_entries(forest)


@functools.lru_cache(maxsize=64)
def names_of(entries: Entries, tree: str) -> frozenset[str]:
    """The names of the entries that the ports and scripts of a tree may create."""
    return frozenset(use.name for use in entries.uses if use.tree == tree and use.creates)
