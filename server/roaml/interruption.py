# SPDX-License-Identifier: Apache-2.0
"""Checkpoints of long computations, at which work whose result is not needed is abandoned.

- A function whose time grows with its input calls `checkpoint` again and again: in each element, state or
  configuration. It leaves nothing half-done when the call raises: it stores a result only when it is complete.
- Who needs the result decides: `run` executes a computation whose checkpoints call a function.
- The function belongs to the current thread (or task), so work in another thread is not affected.
"""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from typing import TypeVar

T = TypeVar("T")


class Interrupted(BaseException):
    """Raised to abandon work whose result is not needed. Like `KeyboardInterrupt`, it is not an `Exception`, so
    handlers of failures do not catch it."""


def go_on() -> None:
    """A checkpoint that never abandons the work."""


_current: ContextVar[Callable[[], None]] = ContextVar("checkpoint", default=go_on)


def checkpoint() -> None:
    """Abandon the current computation if its result is not needed.

    Raises:
        Interrupted: the result is not needed.
    """
    _current.get()()


def run(compute: Callable[[], T], check: Callable[[], None]) -> T:
    """The result of `compute`, whose checkpoints call `check`.

    Raises:
        Interrupted: `check` has raised it.
    """
    before = _current.set(check)
    try:
        return compute()
    finally:
        _current.reset(before)
