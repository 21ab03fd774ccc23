# SPDX-License-Identifier: Apache-2.0
"""The location of the schemas: `roaml/schemas` in the wheel, `schemas/` at the top of a checkout."""

from __future__ import annotations

from pathlib import Path


def schema_path(name: str) -> Path:
    """The file `name` of `schemas/`."""
    import importlib.resources  # noqa: PLC0415 - models in JANI do not need it

    installed = importlib.resources.files("roaml") / "schemas" / name
    if isinstance(installed, Path) and installed.is_file():
        return installed
    return Path(__file__).parents[3] / "schemas" / name
