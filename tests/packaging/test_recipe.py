# SPDX-License-Identifier: Apache-2.0
"""The conda recipe requires what the Python package requires."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from packaging.requirements import Requirement

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
RECIPE = (ROOT / "docs/packaging/conda/recipe.yaml").read_text(encoding="utf-8")


def section(name: str) -> list[str]:
    """The requirements of a section of the recipe, without those of Python and of compilers."""
    lines = RECIPE.partition(f"\n  {name}:\n")[2].splitlines()
    end = next((i for i, line in enumerate(lines) if not line.startswith("    ")), len(lines))
    found = [re.sub(r"^ *(- |then: )", "", line) for line in lines[:end] if "if:" not in line]
    return sorted(text.replace(" ", "").lower() for text in found if text not in ("python", "pip"))


def written(requirements: list[str]) -> list[str]:
    """The requirements as the recipe writes them."""
    texts = []
    for requirement in map(Requirement, requirements):
        bounds = sorted(map(str, requirement.specifier), key=lambda bound: bound.startswith("<"))
        texts.append(f"{requirement.name}{','.join(bounds)}".lower())
    return sorted(texts)


def test_the_same_packages_are_required() -> None:
    assert section("run") == written(PROJECT["project"]["dependencies"])
    assert section("host") == written(PROJECT["build-system"]["requires"])
