# SPDX-License-Identifier: Apache-2.0
"""Helpers that import the library, imported when the first test runs.

The tests in this folder are collected without the library, so that those of one rule (`pytest tests/rules -k RULE`)
start at once. Test modules here import no part of `roaml` but `roaml.model.kinds`, which `fixture` needs.
"""

from __future__ import annotations

from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def checked() -> ModuleType:
    import checked  # noqa: PLC0415

    return checked


@pytest.fixture(scope="session")
def mending() -> ModuleType:
    import mending  # noqa: PLC0415

    return mending
