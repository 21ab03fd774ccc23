# SPDX-License-Identifier: Apache-2.0
"""A cache for results that are computed from content.

- A slot stores the last result of one computation for one subject (a path, or a path in a system), together with its
  key. A different key replaces the result. So the memory grows with the number of files, not with the number of edits.
- Keys are compared by value. The cache keeps a reference to a key that is compared by identity, such as a linked
  system.
- Work may be abandoned before a computation and at its checkpoints (`roaml.interruption`). Earlier results stay in the
  cache.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any, TypeVar

from roaml.interruption import go_on, run

T = TypeVar("T")


class Memo:
    """A cache of results. `checkpoint` is called before each computation and at its checkpoints; it may raise
    `Interrupted`."""

    def __init__(self, checkpoint: Callable[[], None] = go_on) -> None:
        self.checkpoint = checkpoint
        self._slots: dict[tuple[str, Hashable], tuple[Hashable, Any]] = {}
        self._inner: dict[str, Memo] = {}

    def get(self, computation: str, subject: Hashable, key: Hashable, compute: Callable[[], T]) -> T:
        """The result of `computation` for `subject`. If `key` differs from the key of the stored result, `compute` is
        called."""
        slot = (computation, subject)
        known = self._slots.get(slot)
        if known is not None and known[0] == key:
            result: T = known[1]
            return result
        self.checkpoint()
        result = run(compute, self.checkpoint)
        self._slots[slot] = (key, result)
        return result

    def holds(self, computation: str, subject: Hashable) -> bool:
        """Whether a result of `computation` for `subject` is stored, with any key."""
        return (computation, subject) in self._slots

    def known(self, computation: str, subject: Hashable, key: Hashable) -> Any:
        """The stored result of `computation` for `subject` if it has the key; otherwise `None`."""
        known = self._slots.get((computation, subject))
        return known[1] if known is not None and known[0] == key else None

    def last(self, computation: str, subject: Hashable) -> tuple[Any, Any] | None:
        """The key and the result of `computation` for `subject` that are stored; `None` if there are none."""
        return self._slots.get((computation, subject))

    def inner(self, name: str) -> Memo:
        """The cache named `name` inside of this cache, for the analysis of other texts under the same paths."""
        if name not in self._inner:
            self._inner[name] = Memo(self.checkpoint)
        return self._inner[name]

    def copy(self) -> Memo:
        """A copy of the cache, whose work is abandoned at the same checkpoints. New results of the copy are not added
        to this cache."""
        other = Memo(self.checkpoint)
        other._slots = dict(self._slots)
        other._inner = {name: inner.copy() for name, inner in self._inner.items()}
        return other

    def clear(self) -> None:
        self._slots.clear()
        self._inner.clear()
