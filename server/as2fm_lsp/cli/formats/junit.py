# SPDX-License-Identifier: Apache-2.0
"""JUnit XML: each diagnostic is a test of its file, which fails if the diagnostic makes the check fail."""

from __future__ import annotations

from as2fm_lsp import junit
from as2fm_lsp.cli.formats.report import CheckReport, Entry
from as2fm_lsp.junit import Case, CaseOutcome


def render(report: CheckReport) -> str:
    cases = [_case(entry, entry.diagnostic.severity >= report.limit) for entry in report.entries]
    return junit.render("check", cases or [Case("as2fm-lsp", f"{report.checked} files checked")])


def _case(entry: Entry, fails: bool) -> Case:
    place = f"{entry.file}:{entry.place.line}:{entry.place.column}"
    name, text = f"{entry.code} {place}", f"{place}: {entry.severity}: {entry.message}"
    if fails:
        return Case(entry.file, name, CaseOutcome.FAILED, text, entry.message, entry.severity)
    return Case(entry.file, name, text=text)
