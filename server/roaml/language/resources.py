# SPDX-License-Identifier: Apache-2.0
"""Where the schemas are: in the wheel as `roaml/schemas`, in a checkout as `schemas/` at the top."""

from __future__ import annotations

import importlib.resources
from pathlib import Path


def schema_path(name: str) -> Path:
    """The file `name` of `schemas/`."""
    installed = importlib.resources.files("roaml") / "schemas" / name
    if isinstance(installed, Path) and installed.is_file():
        return installed
    return Path(__file__).parents[3] / "schemas" / name
