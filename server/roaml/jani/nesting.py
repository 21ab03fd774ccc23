# SPDX-License-Identifier: Apache-2.0
"""Whether path formulas are nested (docs/spec/properties.md#nested)."""

from __future__ import annotations

from roaml.jani.properties import BinaryPath, Formula, Predicate, ProperFormula, UnaryFormula, UnaryPath


def is_nested(formula: Formula) -> bool:
    """Whether a path operator is applied to a path formula."""
    if not isinstance(formula, (UnaryPath, BinaryPath)):
        return False
    operands = (formula.operand,) if isinstance(formula, UnaryPath) else (formula.left, formula.right)
    return any(is_about_paths(operand) for operand in operands)


def is_about_paths(formula: Formula) -> bool:
    """Whether a formula, without the negations around it, is neither an expression nor a predicate on states."""
    while isinstance(formula, UnaryFormula):
        formula = formula.operand
    return isinstance(formula, ProperFormula) and not isinstance(formula, Predicate)
