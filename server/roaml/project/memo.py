# SPDX-License-Identifier: Apache-2.0
"""A cache for results that are computed from content.

- A slot holds the last result of one computation for one subject (a path, or a path in a system) with its key; for
  another key the result is recomputed and replaced. So memory grows with the files, not with the edits.
- Keys are compared by value. A key that is compared by identity, such as a linked system, is kept alive.
- Work may be abandoned between two computations (`Interrupted`); earlier results are kept.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

T = TypeVar("T")


class Interrupted(BaseException):
    """Raised to abandon work whose result is not needed. Like `KeyboardInterrupt` it is not an `Exception`, so that
    nothing handles it as a failure."""


def go_on() -> None:
    """The checkpoint of work that is never abandoned."""


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
        """A copy of the cache, so that new results are added only to the copy."""
        other = Memo()
        other._slots = dict(self._slots)
        return other

    def clear(self) -> None:
        self._slots.clear()
