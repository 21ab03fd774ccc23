# SPDX-License-Identifier: Apache-2.0
"""Children of tree nodes."""

from __future__ import annotations

from roaml.language.grammar import ElementType


def has_counted_children(type_: ElementType) -> bool:
    """Whether the rule child-count reports errors in the children of an element, so that other rules do not."""
    return bool(type_.node)
