# SPDX-License-Identifier: Apache-2.0
"""The result of a call of the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias


class Done(NamedTuple):
    """The output of a command and its exit status."""

    status: int
    out: str
    err: str

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The diagnostics in JSON."""
        rows = json.loads(self.out)
        assert isinstance(rows, list)
        return rows

    @property
    def found(self) -> list[tuple[str, int, str]]:
        """File, line and code of each diagnostic in JSON."""
        return [(row["file"], row["line"], row["code"]) for row in self.rows]

    @property
    def codes(self) -> list[str]:
        return [row["code"] for row in self.rows]


Command: TypeAlias = Callable[..., Done]
