# SPDX-License-Identifier: Apache-2.0
"""Workflow commands of GitHub Actions, which become annotations in the changed files."""

from __future__ import annotations

from as2fm_lsp.cli.formats.report import CheckReport
from roaml.project.paths import slashed

_KINDS = {"error": "error", "warning": "warning", "information": "notice", "hint": "notice"}


def render(report: CheckReport) -> str:
    lines = []
    for entry in report.entries:
        place = entry.place
        file = slashed(entry.file)
        where = f"file={_property(file)},line={place.line},endLine={place.end_line}"
        if place.line == place.end_line:
            where += f",col={place.column},endColumn={place.end_column}"
        lines.append(f"::{_KINDS[entry.severity]} {where},title={_property(entry.code)}::{_data(entry.message)}\n")
    return "".join(lines)


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
