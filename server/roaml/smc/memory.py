# SPDX-License-Identifier: Apache-2.0
"""Flat memory for numbers. It is initially zero, and only the pages that are written occupy memory."""

from __future__ import annotations

import mmap
import os
from struct import calcsize
from typing import Any

MAX_HEAP_BYTES = 1 << 16
"""The number of bytes up to which memory is allocated on the heap of Python."""
RESERVED_FACTOR = 16
"""The address space that is reserved for an array that may grow, as a multiple of the array. Most of the growth of a
search then needs no copy, which would write the memory a second time."""


def flat(typecode: str, count: int) -> Any:
    """A writable array of `count` numbers, all 0."""
    return _array(typecode, count, count)


def grown(old: Any, count: int) -> Any:
    """A writable array of `count` numbers that begins with those of `old` and is 0 elsewhere.

    The numbers are copied unless the memory of `old` has enough reserved space. In either case, `old` must not be used
    any more.
    """
    view = memoryview(getattr(old, "base", old))  # Cython wraps the array that it was given, its `base`.
    typecode, size = view.format, count * view.itemsize
    assert typecode is not None
    reserved = memoryview(view.obj)
    if isinstance(view.obj, mmap.mmap) and size <= reserved.nbytes:
        return _numbers(reserved[:size], typecode)
    try:
        new = _array(typecode, count, RESERVED_FACTOR * count)
    except (OSError, OverflowError):  # more than the system lets one process reserve
        new = _array(typecode, count, count)
    memoryview(new).cast("B")[: view.nbytes] = view.cast("B")
    return new


def _array(typecode: str, count: int, reserved: int) -> Any:
    size = count * calcsize(typecode)
    if size <= MAX_HEAP_BYTES:
        return _numbers(memoryview(bytearray(size)), typecode)
    # A private mapping, where the system has one: pages that were never written then occupy no memory.
    if os.name == "posix":
        pages = mmap.mmap(-1, reserved * calcsize(typecode), flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    else:
        pages = mmap.mmap(-1, size)
    if hasattr(mmap, "MADV_HUGEPAGE"):
        pages.madvise(mmap.MADV_HUGEPAGE)
    return _numbers(memoryview(pages)[:size], typecode)


def _numbers(memory: memoryview, typecode: str) -> Any:
    return memory.cast("B").cast(typecode)  # type: ignore[call-overload]


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
