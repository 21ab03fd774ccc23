# SPDX-License-Identifier: Apache-2.0
"""What all tests share."""

from __future__ import annotations

from pathlib import Path

from hypothesis import settings

import conformance

# How long an example takes says more about what else the machine does than about the code.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Tests of the conformance cases, where there are none; `pytest_terminal_summary` says so."""
    return True if not conformance.PRESENT and collection_path.match("test_*conformance*.py") else None


def pytest_terminal_summary(terminalreporter) -> None:  # type: ignore[no-untyped-def]
    if not conformance.PRESENT:
        terminalreporter.write_line("conformance cases: not present, so none of them is collected")
