# SPDX-License-Identifier: Apache-2.0
"""Children of tree nodes."""

from __future__ import annotations

from roaml.language.grammar import ElementType
from roaml.model.system import builtin_plugins
from roaml.model.tree import SUBTREES


def has_counted_children(type_: ElementType) -> bool:
    """Whether child-count reports the children of an element, so that other rules do not."""
    return bool(type_.node) and (type_.name in builtin_plugins() or type_.name in SUBTREES)
