# SPDX-License-Identifier: Apache-2.0
"""Children of tree nodes."""

from __future__ import annotations

from roaml.language.grammar import ElementType


def has_counted_children(type_: ElementType) -> bool:
    """Whether elements of the type `type_` are nodes of a tree, whose children child-count checks, so that other rules
    do not report them."""
    return bool(type_.node)
