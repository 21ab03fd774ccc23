# SPDX-License-Identifier: Apache-2.0
"""Configuration of all tests."""

from __future__ import annotations

import gc
import itertools
import os
import re
import sys
import threading
from functools import cache
from pathlib import Path

import pytest

import conformance
from as2fm_lsp.cli import status_line
from examples import TIMES, examples

# In containers that forbid writing the cache, each process that a test starts would compile all modules again, which
# takes a second.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# As in the program (as2fm_lsp.__main__): parsed files and models live long, so frequent collections find little.
gc.set_threshold(50_000)


# The progress of a command that waits for a busy machine is not part of its expected output.
status_line.LOG_DELAY_S = threading.TIMEOUT_MAX / 2


_numbers = itertools.count()


@pytest.fixture
def tmp_path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As the fixture of pytest, but without a link to the last folder with the same name: most of the time that the
    fixture takes goes into this link, which nobody uses."""
    name = re.sub(r"\W", "_", request.node.name)[:30]
    path = tmp_path_factory.getbasetemp() / f"{name}{next(_numbers)}"
    path.mkdir(mode=0o700)
    return path


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Do not collect tests of the conformance cases if there are none. `pytest_terminal_summary` reports this."""
    return True if not conformance.PRESENT and collection_path.match("test_*conformance*.py") else None


def pytest_collection_finish() -> None:
    """Exclude the tests themselves from garbage collection."""
    gc.collect()
    gc.freeze()


def pytest_terminal_summary(terminalreporter) -> None:  # type: ignore[no-untyped-def]
    if not conformance.PRESENT:
        terminalreporter.write_line("conformance cases: not present, so none of them is collected")


def pytest_collectstart(collector: pytest.Collector) -> None:
    """Set up hypothesis before the first module that may use it is imported. The tests of rules do not use it, and this
    takes longer than one of them."""
    if isinstance(collector, pytest.Module) and collector.path.parent.name != "rules":
        _load_profile()


@cache
def _load_profile() -> None:
    from hypothesis import settings  # noqa: PLC0415

    # The duration of an example depends more on other work on the machine than on the code.
    settings.register_profile("suite", deadline=None, derandomize=not TIMES, max_examples=examples(100))
    settings.load_profile("suite")
