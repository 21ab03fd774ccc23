# SPDX-License-Identifier: Apache-2.0
"""Why a tree cannot be executed without its program."""

from __future__ import annotations

from roaml.text import Location

INVALID_SCRIPT = "the script is not valid"
"""The reason for a script with a syntax error, which other checks report."""


class TreeRefusal(Exception):  # noqa: N818 - the tree may be correct
    """A tree cannot be translated; `origin` is the place of the reason."""

    def __init__(self, origin: Location, reason: str) -> None:
        super().__init__(reason)
        self.origin = origin
        self.reason = reason
