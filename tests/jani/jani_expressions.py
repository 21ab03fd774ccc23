# SPDX-License-Identifier: Apache-2.0
"""Short ways to write expressions in tests."""

from __future__ import annotations

from typing import Any

from roaml.jani.expressions import Expression
from roaml.jani.notes import Notes
from roaml.jani.read_formulas import FormulaReader
from roaml.json_syntax import parse


def expression(text: str) -> Expression:
    """The expression for `text`, which is JSON with `'` for `"` and must have no errors."""
    value, findings = parse(text.replace("'", '"'))
    notes = Notes()
    result = FormulaReader("test.jani", notes).expression(value)
    assert (findings, notes.findings) == ((), ())
    return result


def op(symbol: str, *operands: Any) -> str:
    """JSON, with `'` for `"`, of an operator with one or two operands."""
    keys = ("exp",) if len(operands) == 1 else ("left", "right")
    parts = "".join(f", '{key}': {operand}" for key, operand in zip(keys, operands, strict=True))
    return f"{{'op': '{symbol}'{parts}}}"
