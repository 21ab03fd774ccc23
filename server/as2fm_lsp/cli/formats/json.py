# SPDX-License-Identifier: Apache-2.0
"""A JSON list with an object for each diagnostic."""

from __future__ import annotations

import json

from as2fm_lsp.cli.formats.report import CheckReport


def render(report: CheckReport) -> str:
    rows = [
        {
            "file": entry.file,
            "line": entry.place.line,
            "column": entry.place.column,
            "end_line": entry.place.end_line,
            "end_column": entry.place.end_column,
            "severity": entry.severity,
            "code": entry.code,
            "message": entry.message,
        }
        for entry in report.entries
    ]
    return json.dumps(rows, ensure_ascii=False, indent=2) + "\n"
