# SPDX-License-Identifier: Apache-2.0
"""Says when the conformance set is absent, so that a run without it is not taken for a complete one."""

from __future__ import annotations

import pytest
from jani_conformance import REFERENCES, SET


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if not REFERENCES:
        terminalreporter.write_line(f"tests/jani: {SET} is absent; its models were not tested")
