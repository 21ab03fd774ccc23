# SPDX-License-Identifier: Apache-2.0
"""The statuses of nodes as numbers, and the values of ports that programs compute with."""

from __future__ import annotations

from typing import TypeAlias

IDLE, SUCCESS, FAILURE, RUNNING, SKIPPED, HELD = range(6)
"""The codes of statuses and answers. SKIPPED means that the node was skipped and is IDLE; HELD means that it was
skipped and has another status. The parent of the node treats these answers differently (docs/spec/mocks.md#skipped)."""
STATUS_CODES = {
    "IDLE": IDLE,
    "SUCCESS": SUCCESS,
    "FAILURE": FAILURE,
    "RUNNING": RUNNING,
    "SKIPPED": SKIPPED,
    "HELD": HELD,
}

Known: TypeAlias = "int | bool | float | str"
"""A value that is known before the tree is executed."""
