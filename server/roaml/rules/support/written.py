# SPDX-License-Identifier: Apache-2.0
"""Expressions as they are written."""

from __future__ import annotations

from roaml.expr.tree import Expr
from roaml.rules.rule import MachineContext


def written(context: MachineContext, expr: Expr) -> str:
    """The text of an expression without white space."""
    return "".join(context.source.text[expr.span.start : expr.span.end].split())
