# SPDX-License-Identifier: Apache-2.0
"""Memory for results that are computed from content.

- A slot holds the last result of one computation for one subject (a path, or a path in a system) with the key it was
  computed from; a different key computes anew and replaces it. So memory grows with the files, not with the edits.
- Keys compare by value. What compares by identity, as a linked system does, stays alive as part of the key.
- Work may be given up between two computations (`Interrupted`); what was computed before stays known.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

T = TypeVar("T")


class Interrupted(BaseException):
    """Nobody waits for the result any more. No error, as `KeyboardInterrupt` is none: nothing must take it for a
    failure."""


def go_on() -> None:
    """The checkpoint of work that is never given up."""


class Memo:
    """`checkpoint` is called before each computation and may raise `Interrupted`."""

    def __init__(self, checkpoint: Callable[[], None] = go_on) -> None:
        self.checkpoint = checkpoint
        self._slots: dict[tuple[str, Hashable], tuple[Hashable, Any]] = {}

    def get(self, computation: str, subject: Hashable, key: Hashable, compute: Callable[[], T]) -> T:
        """The result of `computation` for `subject` at `key`."""
        slot = (computation, subject)
        known = self._slots.get(slot)
        if known is not None and known[0] == key:
            result: T = known[1]
            return result
        self.checkpoint()
        result = compute()
        self._slots[slot] = (key, result)
        return result

    def copy(self) -> Memo:
        """The same results, to which others are added here only."""
        other = Memo()
        other._slots = dict(self._slots)
        return other

    def clear(self) -> None:
        self._slots.clear()
