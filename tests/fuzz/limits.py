# SPDX-License-Identifier: Apache-2.0
"""The time and the memory that one case may use, in the process that runs it.

- The time is CPU time, so a busy machine causes no failures. At the limit, `OutOfTime` is raised wherever the case is.
  Code that never returns to Python is ended by `fuzz.runner`, from outside.
- The memory is the amount that the process allocates in addition. At the limit, Python raises `MemoryError`.
"""

from __future__ import annotations

import contextlib
import resource
import signal
from collections.abc import Iterator
from typing import Any

SECONDS = 2.0
"""The maximum CPU time in s."""

MEMORY = 500 * 1024 * 1024
"""The maximum memory in bytes."""

_MARGIN = 0.5
"""The CPU time in s after which `OutOfTime` is raised again, if the first one was caught."""


class OutOfTime(BaseException):
    """The time of a case is over. It is not an `Exception`, so that no code handles it as a failure of a part."""


@contextlib.contextmanager
def limited(seconds: float = SECONDS, memory: int = MEMORY) -> Iterator[None]:
    """Limits the code in a `with` statement. Use it in the main thread, and do not nest it.

    Raises:
        OutOfTime: the code took longer.
        MemoryError: the code allocated more.
    """

    def out_of_time(number: int, frame: Any) -> None:
        raise OutOfTime

    before = resource.getrlimit(resource.RLIMIT_DATA)
    handler = signal.signal(signal.SIGPROF, out_of_time)
    try:
        resource.setrlimit(resource.RLIMIT_DATA, (_allocated() + memory, before[1]))
        _start(seconds)
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, handler)
        resource.setrlimit(resource.RLIMIT_DATA, before)


def restart(seconds: float = SECONDS) -> None:
    """Gives the running case its whole time again, because it runs another command."""
    if signal.getitimer(signal.ITIMER_PROF)[0]:
        _start(seconds)


def _start(seconds: float) -> None:
    signal.setitimer(signal.ITIMER_PROF, seconds, _MARGIN)


def _allocated() -> int:
    """The bytes of data of this process, as Linux counts them for RLIMIT_DATA."""
    with open("/proc/self/status", encoding="ascii") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmData"))
