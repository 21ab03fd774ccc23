# SPDX-License-Identifier: Apache-2.0
"""What is released has one version, that of the tag."""

from __future__ import annotations

import datetime
import importlib.util
import shutil
from pathlib import Path
from types import ModuleType

import pytest

from roaml import __version__

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def release_version() -> ModuleType:
    spec = importlib.util.spec_from_file_location("release_version", ROOT / "docs/packaging/release_version.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def copied(release_version: ModuleType, tmp_path: Path) -> Path:
    """A folder with the files that state the version, and a changelog."""
    for path in {path for path, _ in release_version.PLACES}:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    (tmp_path / release_version.CHANGELOG).write_text(CHANGES.replace("VERSION", __version__), encoding="utf-8")
    return tmp_path


CHANGES = """# Changelog

## [Unreleased]

### Added

- A new command.

### Fixed

- A mistake of
  two lines.

## [VERSION] - 2026-01-01

### Added

#### Checking

- A rule.

### Fixed

- An older mistake.

## [0.1.0] - 2025-01-01

- The first one.
"""
RELEASED = """# Changelog

## [Unreleased]

## [VERSION] - 2027-01-02

### Added

- A new command.

#### Checking

- A rule.

### Fixed

- A mistake of
  two lines.
- An older mistake.

## [0.1.0] - 2025-01-01

- The first one.
"""


def test_one_version(release_version: ModuleType) -> None:
    assert release_version.problems(None) == []


def test_a_tag_is_the_version(release_version: ModuleType, copied: Path) -> None:
    release_version.set_version(f"v{__version__}", datetime.date(2027, 1, 2), copied)
    problems = release_version.problems("v99.0.0", copied)
    assert problems == [
        f"the tag is v99.0.0, the version is {__version__}: tag v{__version__}, or run this program with --set v99.0.0"
    ]


def test_a_tag_has_a_section_with_all_changes(release_version: ModuleType, copied: Path) -> None:
    tag = f"v{__version__}"
    changelog = copied / release_version.CHANGELOG
    assert release_version.problems(tag, copied) == [
        f"CHANGELOG.md has unreleased changes: run this program with --set {tag}"
    ]
    release_version.set_version(tag, datetime.date(2027, 1, 2), copied)
    assert changelog.read_text(encoding="utf-8") == RELEASED.replace("VERSION", __version__)
    assert release_version.problems(tag, copied) == []
    changelog.write_text(CHANGES.replace("VERSION", "0.0.1"), encoding="utf-8")
    assert release_version.problems(tag, copied) == [
        f"CHANGELOG.md has no section [{__version__}] after [Unreleased]",
        f"CHANGELOG.md has unreleased changes: run this program with --set {tag}",
    ]


def test_no_change_of_the_real_changelog_is_lost(release_version: ModuleType, copied: Path) -> None:
    shutil.copy(ROOT / release_version.CHANGELOG, copied)
    before = (copied / release_version.CHANGELOG).read_text(encoding="utf-8")
    release_version.set_version(f"v{__version__}", datetime.date(2027, 1, 2), copied)
    after = (copied / release_version.CHANGELOG).read_text(encoding="utf-8")
    assert sorted(_entries(before)) == sorted(_entries(after))
    assert release_version.problems(f"v{__version__}", copied) == []


def _entries(changelog: str) -> list[str]:
    return [line for line in changelog.splitlines() if line and not line.startswith(("## ", "### "))]


def test_the_version_of_a_tag_is_written_everywhere(release_version: ModuleType, copied: Path) -> None:
    release_version.set_version("v99.1.0", datetime.date(2027, 1, 2), copied)
    assert {version for _, version in release_version.stated(copied)} == {"99.1.0"}
    assert release_version.problems("v99.1.0", copied) == []
    changelog = (copied / release_version.CHANGELOG).read_text(encoding="utf-8")
    assert "## [Unreleased]\n\n## [99.1.0] - 2027-01-02\n" in changelog
    release_version.set_version("v99.1.0", datetime.date(2027, 1, 3), copied)
    assert changelog == (copied / release_version.CHANGELOG).read_text(encoding="utf-8")
    (copied / "CITATION.cff").write_text("version: 1.2.3\n")
    assert release_version.problems(None, copied) == ["CITATION.cff has version 1.2.3, pyproject.toml has 99.1.0"]
