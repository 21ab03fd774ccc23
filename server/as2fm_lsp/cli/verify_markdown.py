# SPDX-License-Identifier: Apache-2.0
"""The results of a verification in Markdown: a table of the properties, then what is wrong."""

from __future__ import annotations

from collections.abc import Sequence

from as2fm_lsp.cli.formats import CheckReport, Format, render
from as2fm_lsp.cli.formats.markdown import cell
from as2fm_lsp.verification.findings import value_text
from as2fm_lsp.verification.report import conditional_texts, remarks_on_expectations
from roaml.record import replace
from roaml.verification.results import Result


def as_markdown(results: Sequence[Result], report: CheckReport, assumptions: str) -> str:
    """The report.

    Args:
        report: the findings about the results, and the errors in the model.
        assumptions: how the values were computed.
    """
    lines = ["| property | value | expected | verdict |", "| --- | --- | --- | --- |"]
    for result in results:
        expected = ", ".join(verdict.expectation.text for verdict in result.verdicts) or "–"
        verdict = ", ".join(verdict.explained(result.epsilon) for verdict in result.verdicts) or "–"
        value = "; ".join((value_text(result), *conditional_texts(result)))
        lines.append(f"| `{result.name}` | {cell(value)} | {cell(expected)} | {cell(verdict)} |")
    text = "".join(f"{line}\n" for line in lines)
    text += "".join(f"\n{line}\n" for line in remarks_on_expectations(results))
    if report.entries:
        text += f"\n{render(replace(report, has_summary=False), Format.MARKDOWN)}"
    return f"{text}\n" + "".join(f"{line}  \n" for line in assumptions.splitlines())
