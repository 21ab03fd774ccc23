# SPDX-License-Identifier: Apache-2.0
"""The blackboard entries of trees that belong to no system, computed once for all rules."""

from __future__ import annotations

import functools

from roaml.forest.entries import Entries, find_entries
from roaml.forest.forest import Forest


@functools.lru_cache(maxsize=8)
def entries_of(forest: Forest) -> Entries:
    """The entries of a forest, which is immutable and compared by identity."""
    return find_entries(forest)
