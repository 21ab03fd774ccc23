# SPDX-License-Identifier: Apache-2.0
"""The location of the schemas: `roaml/schemas` in the wheel, `schemas/` at the top of a checkout."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roaml.disk import path_of_resource

if TYPE_CHECKING:
    from pathlib import Path


def schema_path(name: str) -> Path:
    """The file `name` of `schemas/`."""
    from pathlib import Path  # noqa: PLC0415 - models in JANI do not need it

    package = Path(path_of_resource("roaml"))
    installed = package / "schemas" / name
    return installed if installed.is_file() else package.parents[1] / "schemas" / name
