# SPDX-License-Identifier: Apache-2.0
"""Markdown, for comments and for the summaries of jobs in CI."""

from __future__ import annotations

from as2fm_lsp.cli.formats.report import CheckReport
from as2fm_lsp.cli.formats.text import summary
from roaml.project.paths import slashed


def render(report: CheckReport) -> str:
    lines = [f"{summary(report)}\n"] if report.has_summary else []
    if report.entries:
        lines += ["| place | severity | finding |", "| --- | --- | --- |"]
    for entry in report.entries:
        place = f"`{slashed(entry.file)}:{entry.place.line}`"
        lines.append(f"| {cell(place)} | {entry.severity} | {cell(entry.message)} `{entry.code}` |")
    return "".join(f"{line}\n" for line in lines)


def cell(text: str) -> str:
    """A text in one cell of a table. Backquoted parts stay code; elsewhere, nothing is markup."""
    parts = " ".join(text.split()).replace("|", "\\|").split("`")
    outside = [part.replace("<", "&lt;").replace("*", "\\*").replace("_", "\\_") for part in parts[::2]]
    parts[::2] = outside
    return "`".join(parts)
