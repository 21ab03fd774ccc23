# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from pathlib import Path

import pytest

CONFORMANCE = Path(__file__).resolve().parents[3] / "shared" / "conformance" / "interfaces"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if not CONFORMANCE.is_dir():
        terminalreporter.write_line(f"no conformance interfaces were read: there is no folder {CONFORMANCE}")
