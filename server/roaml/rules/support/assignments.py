# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about assignments."""

from __future__ import annotations

from roaml.expr.format import format_expr
from roaml.model.machine import Assign
from roaml.model.syntax import Expression


def is_unchanged(statement: Assign) -> bool:
    """Whether a statement assigns a variable to itself."""
    location, value = statement.location, statement.value
    if location is None or not isinstance(value, Expression) or location.broken or value.broken:
        return False
    return format_expr(location.tree) == format_expr(value.tree)
