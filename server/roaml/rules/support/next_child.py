# SPDX-License-Identifier: Apache-2.0
"""The status of a child after which a control node ticks its next child."""

from __future__ import annotations

SUCCEEDS, FAILS = "SUCCESS", "FAILURE"
_NEEDED = {
    "Sequence": SUCCEEDS,
    "AsyncSequence": SUCCEEDS,
    "ReactiveSequence": SUCCEEDS,
    "SequenceWithMemory": SUCCEEDS,
    "Fallback": FAILS,
    "AsyncFallback": FAILS,
    "ReactiveFallback": FAILS,
}


def needed(plugin: str) -> str | None:
    """The status of a child after which a node ticks the next one; `None` if this depends on more than the status."""
    return _NEEDED.get(plugin)
