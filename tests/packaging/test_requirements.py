# SPDX-License-Identifier: Apache-2.0
"""The packages that the VS Code extension installs in addition to the server: its dependencies, each pinned with its
hashes."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
TEXT = (ROOT / "vscode-extension" / "requirements.txt").read_text(encoding="utf-8")


def pinned() -> dict[str, tuple[Requirement, list[str]]]:
    """Each requirement with its hashes, by its name."""
    requirements = {}
    for line in TEXT.replace("\\\n", " ").split("\n"):
        if line and not line.startswith("#"):
            written, *hashes = line.split("--hash=")
            requirement = Requirement(written.strip())
            requirements[canonicalize_name(requirement.name)] = (requirement, [digest.strip() for digest in hashes])
    return requirements


def test_all_are_pinned_with_hashes() -> None:
    assert pinned()
    for name, (requirement, hashes) in pinned().items():
        assert re.fullmatch(r"==[\w.]+", str(requirement.specifier)), name
        assert hashes, name
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", digest) for digest in hashes), name


def test_they_are_those_of_the_server() -> None:
    """If this test fails, `npm run requirements` renews the file."""
    pinned_requirements = pinned()
    for written in PROJECT["project"]["dependencies"]:
        dependency = Requirement(written)
        requirement, _ = pinned_requirements[canonicalize_name(dependency.name)]
        (version,) = requirement.specifier
        assert dependency.specifier.contains(version.version), written


def test_no_index_is_named() -> None:
    assert "://" not in TEXT
    assert not re.search(r"^\s*-", TEXT.replace("    --hash", ""), re.MULTILINE)
