# SPDX-License-Identifier: Apache-2.0
"""The conformance cases, which may be in a folder beside the project.

Only the files `test_*conformance*.py` need them. Without the cases, these files are not collected.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2] / "shared" / "conformance"
PRESENT = (ROOT / "cases.toml").is_file()
INTERFACES = ROOT / "interfaces"
INTERFACE_FILES = sorted(file for kind in ("msg", "srv", "action") for file in INTERFACES.glob(f"*/{kind}/*.{kind}"))

REFERENCES = sorted((ROOT / "reference").glob("*.jani.gz"))
"""Whole models in JANI, compressed."""
WHOLE_MODELS = sorted((ROOT / "models" / "battery_example").glob("*.jani"))
PROPERTY_FILES = sorted(set((ROOT / "models").glob("*/**/*.jani")) - set(WHOLE_MODELS))


@dataclass(frozen=True)
class Mistake:
    """A system with an error on purpose: its folder, and the system file of the same system without the error."""

    id: str
    folder: Path
    base: Path
    severity: str
    at: tuple[str, ...]

    @property
    def main(self) -> Path:
        return self.folder / "main.xml"


def _table(name: str) -> list[dict[str, Any]]:
    if not PRESENT:
        return []
    return list(tomllib.loads((ROOT / name).read_text(encoding="utf-8"))["case"])


@cache
def systems() -> tuple[Path, ...]:
    """The system files of all models that must be clean."""
    return tuple(dict.fromkeys(ROOT / case["model"] for case in _table("cases.toml")))


@cache
def verified() -> tuple[dict[str, Any], ...]:
    """The cases with a probability: `model`, `property`, `probability`, `tolerance`, `max_steps`."""
    return tuple(case for case in _table("cases.toml") if case["verify"])


@cache
def mistakes() -> tuple[Mistake, ...]:
    return tuple(
        Mistake(case["id"], ROOT / "bad" / case["id"], ROOT / case["base"], case["severity"], tuple(case["at"]))
        for case in _table("bad.toml")
    )


def label(path: Path) -> str:
    """A short name for a file of the conformance cases."""
    return path.relative_to(ROOT).as_posix()
