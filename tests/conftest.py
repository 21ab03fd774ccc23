# SPDX-License-Identifier: Apache-2.0
"""What all tests share."""

from __future__ import annotations

import conformance


def pytest_report_header() -> str:
    return conformance.NOTICE


def pytest_terminal_summary(terminalreporter) -> None:  # type: ignore[no-untyped-def]
    """Said at the end, too, where a quiet run still shows it."""
    if not conformance.PRESENT:
        terminalreporter.write_line(conformance.NOTICE)
