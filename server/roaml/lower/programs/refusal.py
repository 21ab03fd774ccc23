# SPDX-License-Identifier: Apache-2.0
"""The reason why a tree cannot be translated."""

from __future__ import annotations

from roaml.text import Location

INVALID_SCRIPT = "the script is not valid"
"""The reason for a script with a syntax error."""


class TreeRefusal(Exception):  # noqa: N818 - the tree may be correct
    """Raised if a tree cannot be translated.

    Attributes:
        origin: the position of the cause.
        is_reported: whether the rules for nodes, ports and scripts also report the reason.
        unset: the name of the entry that a script, or a port of a tree without a system, reads and nothing sets, if
            this is the reason; otherwise "".
    """

    def __init__(self, origin: Location, reason: str, *, is_reported: bool = False, unset: str = "") -> None:
        super().__init__(reason)
        self.origin = origin
        self.reason = reason
        self.is_reported = is_reported
        self.unset = unset
