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


def test_one_version(release_version: ModuleType) -> None:
    assert release_version.problems(None) == []
    assert release_version.problems(f"v{__version__}") == []


def test_a_tag_is_the_version_and_has_a_section(release_version: ModuleType) -> None:
    problems = release_version.problems("v99.0.0")
    assert problems == [
        f"the tag is v99.0.0, the version is {__version__}: tag v{__version__}, or run this program with --set v99.0.0"
    ]


def test_the_version_of_a_tag_is_written_everywhere(release_version: ModuleType, tmp_path: Path) -> None:
    for path in {path for path, _ in release_version.PLACES} | {release_version.CHANGELOG}:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tmp_path / path)
    release_version.set_version("v99.1.0", datetime.date(2027, 1, 2), tmp_path)
    assert {version for _, version in release_version.stated(tmp_path)} == {"99.1.0"}
    assert release_version.problems("v99.1.0", tmp_path) == []
    changelog = (tmp_path / release_version.CHANGELOG).read_text(encoding="utf-8")
    assert "## [Unreleased]\n\n## [99.1.0] - 2027-01-02\n" in changelog
    release_version.set_version("v99.1.0", datetime.date(2027, 1, 3), tmp_path)
    assert changelog == (tmp_path / release_version.CHANGELOG).read_text(encoding="utf-8")
    (tmp_path / "CITATION.cff").write_text("version: 1.2.3\n")
    assert release_version.problems(None, tmp_path) == ["CITATION.cff has version 1.2.3, pyproject.toml has 99.1.0"]
