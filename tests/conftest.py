# SPDX-License-Identifier: Apache-2.0
"""What all tests share."""

from __future__ import annotations

import os
import sys
from functools import cache
from pathlib import Path

import pytest

import conformance
from examples import TIMES, examples

# Where containers forbid it, each of the processes that tests start would compile all modules anew, for a second.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Tests of the conformance cases, where there are none; `pytest_terminal_summary` says so."""
    return True if not conformance.PRESENT and collection_path.match("test_*conformance*.py") else None


def pytest_terminal_summary(terminalreporter) -> None:  # type: ignore[no-untyped-def]
    if not conformance.PRESENT:
        terminalreporter.write_line("conformance cases: not present, so none of them is collected")


def pytest_collectstart(collector: pytest.Collector) -> None:
    """Set hypothesis up before the first module that may use it is imported. That takes longer than the tests of a
    rule, which do not use it."""
    if isinstance(collector, pytest.Module) and collector.path.parent.name != "rules":
        _load_profile()


@cache
def _load_profile() -> None:
    from hypothesis import settings  # noqa: PLC0415

    # How long an example takes says more about what else the machine does than about the code.
    settings.register_profile("suite", deadline=None, derandomize=not TIMES, max_examples=examples(100))
    settings.load_profile("suite")
