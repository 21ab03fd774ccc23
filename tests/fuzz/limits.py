# SPDX-License-Identifier: Apache-2.0
"""The time and the memory that one case may take, in the process that runs it.

- Time is the processor's, so a busy machine makes no failures. When it is over, `OutOfTime` is raised wherever the case
  is; code that never returns to Python is ended by `fuzz.runner`, from outside.
- Memory is what the process allocates beyond what it had. Python raises `MemoryError` when it is over.
"""

from __future__ import annotations

import contextlib
import resource
import signal
from collections.abc import Iterator
from typing import Any

SECONDS = 2.0
"""Of processor time."""

MEMORY = 500 * 1024 * 1024
"""Bytes."""

_MARGIN = 0.5
"""Seconds of processor time until `OutOfTime` is raised once more, if somebody has caught the first."""


class OutOfTime(BaseException):
    """The time of a case is over. No `Exception`, so that nothing takes it for a failure of a part."""


@contextlib.contextmanager
def limited(seconds: float = SECONDS, memory: int = MEMORY) -> Iterator[None]:
    """Limits what is done inside. To be used in the main thread, and not nested.

    Raises:
        OutOfTime: it took longer.
        MemoryError: it allocated more.
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
    """Gives the running case its whole time again: what comes is another command."""
    if signal.getitimer(signal.ITIMER_PROF)[0]:
        _start(seconds)


def _start(seconds: float) -> None:
    signal.setitimer(signal.ITIMER_PROF, seconds, _MARGIN)


def _allocated() -> int:
    """Bytes of data of this process, as Linux counts them for RLIMIT_DATA."""
    with open("/proc/self/status", encoding="ascii") as status:
        return next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmData"))
