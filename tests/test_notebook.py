# SPDX-License-Identifier: Apache-2.0
"""The notebook among the examples runs, prints what is stored in it, and shows a picture."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
NOTEBOOK = EXAMPLES / "assembly_robot.ipynb"


def executed(source: str, names: dict[str, Any]) -> Any:
    """The value of the last statement of a cell, which a notebook shows; `None` if it is no expression."""
    tree = ast.parse(source)
    last = ast.Expression(tree.body.pop().value) if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, str(NOTEBOOK), "exec"), names)
    return None if last is None else eval(compile(last, str(NOTEBOOK), "eval"), names)


def test_cells_print_what_is_stored(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    monkeypatch.chdir(EXAMPLES)
    names: dict[str, Any] = {}
    pictures = 0
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        source = "".join(cell["source"])
        value = executed(source, names)
        if value is not None:
            assert value._repr_svg_().startswith("<svg")
            pictures += 1
        stored = "".join(line for output in cell["outputs"] for line in output["text"])
        assert capsys.readouterr().out == stored, source
    assert pictures == 1
