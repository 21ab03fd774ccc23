# SPDX-License-Identifier: Apache-2.0
"""GitLab's Code Quality report."""

from __future__ import annotations

import json
from collections import Counter

from as2fm_lsp.cli.formats.report import CheckReport
from roaml.project.paths import slashed

_SEVERITIES = {"error": "major", "warning": "minor", "information": "info", "hint": "info"}


def render(report: CheckReport) -> str:
    seen: Counter[str] = Counter()
    rows = []
    for entry in report.entries:
        seen[entry.fingerprint] += 1
        rows.append(
            {
                "type": "issue",
                "check_name": entry.code,
                "description": entry.message,
                "severity": _SEVERITIES[entry.severity],
                # GitLab keeps only one entry for each fingerprint.
                "fingerprint": f"{entry.fingerprint}-{seen[entry.fingerprint]}",
                "location": {
                    "path": slashed(entry.file),
                    "lines": {"begin": entry.place.line, "end": entry.place.end_line},
                },
            }
        )
    return json.dumps(rows, ensure_ascii=False, indent=2) + "\n"
