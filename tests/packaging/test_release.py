# SPDX-License-Identifier: Apache-2.0
"""What is released has one version."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def release_version() -> ModuleType:
    spec = importlib.util.spec_from_file_location("release_version", ROOT / "docs/packaging/release_version.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_one_version(release_version: ModuleType) -> None:
    assert release_version.problems(None) == []


def test_a_tag_is_the_version_and_has_a_section(release_version: ModuleType) -> None:
    problems = release_version.problems("v99.0.0")
    assert problems[0].startswith("the tag is v99.0.0, the version is ")
    assert any("CHANGELOG.md has no section" in line for line in problems)
