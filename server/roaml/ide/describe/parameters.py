# SPDX-License-Identifier: Apache-2.0
"""Descriptions of parameters (docs/spec/parameters.md)."""

from __future__ import annotations

from roaml.diagnostics import Symbol
from roaml.expansion.declarations import Declared, declarations
from roaml.expansion.problems import Problems
from roaml.ide.describe.comment import remark
from roaml.ide.describe.markdown import code, paragraphs, prose
from roaml.project.analysis import Analysis


def declared_in(analysis: Analysis, path: str) -> tuple[Declared, ...]:
    """The parameters that a file declares."""
    document = analysis.document(path)
    return declarations(document, Problems()) if document is not None else ()


def parameter(analysis: Analysis, symbol: Symbol) -> str:
    """The description of a parameter: its type, value and range."""
    declared = next((p for p in declared_in(analysis, symbol.path) if p.name.value == symbol.name), None)
    document = analysis.document(symbol.path)
    if declared is None or document is None:
        return ""
    value = declared.value.value if declared.value else ""
    expanded = analysis.expanded(symbol.path) if symbol.path in analysis.system_paths else None
    constant = expanded.expansion.parameters.get(symbol.name) if expanded is not None else None
    result = f"is {constant.text}" if constant is not None and constant.text != value else ""
    least = f"at least {declared.least.value}" if declared.least else ""
    most = f"at most {declared.most.value}" if declared.most else ""
    facts = " · ".join(part for part in (result, least, most) if part)
    where = f"Parameter. Set it with `--set {symbol.name}=VALUE`." if expanded else "Parameter of this file."
    return paragraphs(
        code(f"{symbol.name} : {declared.type} = {value}"), prose(remark(document, declared.element)), facts, where
    )
