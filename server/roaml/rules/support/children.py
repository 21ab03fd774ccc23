# SPDX-License-Identifier: Apache-2.0
"""Children of tree nodes."""

from __future__ import annotations

from roaml.language.grammar import ElementType


def has_counted_children(type_: ElementType) -> bool:
    """Whether child-count says what is wrong with the children of an element, so that others keep quiet."""
    return bool(type_.node)
