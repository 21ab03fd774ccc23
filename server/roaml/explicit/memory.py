# SPDX-License-Identifier: Apache-2.0
"""Flat memory for numbers. It is initially zero, and only the pages that are written occupy memory."""

from __future__ import annotations

import mmap
import os
from struct import calcsize
from typing import Any

MAX_HEAP_BYTES = 1 << 16
"""The number of bytes up to which memory is allocated on the heap of Python."""


def flat(typecode: str, count: int, old: Any = None) -> Any:
    """A writable array of `count` numbers.

    Args:
        old: an array of the same type whose numbers are copied to the beginning.
    """
    size = count * calcsize(typecode)
    if size <= MAX_HEAP_BYTES:
        made = memoryview(bytearray(size))
    else:
        # A private mapping, where the system has one: pages that were never written then occupy no memory.
        flags = {"flags": mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS} if os.name == "posix" else {}
        pages = mmap.mmap(-1, size, **flags)
        if hasattr(mmap, "MADV_HUGEPAGE"):
            pages.madvise(mmap.MADV_HUGEPAGE)
        made = memoryview(pages)
    if old is not None:
        made[: old.nbytes] = memoryview(old).cast("B")
    return made.cast("B").cast(typecode)  # type: ignore[call-overload]


def available() -> int:
    """The number of bytes of memory that are free for programs. If the system does not report it, the size of the
    physical memory; 4 GiB if that is unknown, too."""
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            for line in file:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except (OSError, ValueError):
        pass
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):
        return 4 << 30
