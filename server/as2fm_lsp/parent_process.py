# SPDX-License-Identifier: Apache-2.0
"""Whether the process that has started the server is still running."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable

POLL_INTERVAL_S = 1.0
"""The interval between checks, in s, on systems that do not report the end of a process."""

EXIT_TIMEOUT_S = 10.0
"""The time, in s, after which a server that is still busy is ended."""

UNEXPECTED_END = 1


def watch(process_id: int, ended: Callable[[], None]) -> None:
    """Wait in a separate thread for the end of a process. A process that does not exist is treated as ended.

    Args:
        ended: called in that thread, once. The server then has `EXIT_TIMEOUT_S` seconds to end by itself.
    """

    def wait() -> None:
        wait_for_end(process_id)
        ended()
        time.sleep(EXIT_TIMEOUT_S)
        os._exit(UNEXPECTED_END)

    threading.Thread(target=wait, name="parent", daemon=True).start()


def wait_for_end(process_id: int) -> None:
    """Return when a process has ended, even if its exit status has not been read yet."""
    if sys.platform == "win32":
        _wait_on_windows(process_id)
    elif hasattr(os, "pidfd_open"):
        _wait_on_linux(process_id)
    else:
        _poll(process_id)


def _wait_on_linux(process_id: int) -> None:
    import select  # noqa: PLC0415 - not on every system

    try:
        descriptor = os.pidfd_open(process_id)
    except ProcessLookupError:
        return
    except (OSError, OverflowError):  # old kernels do not support this, others may forbid it
        _poll(process_id)
        return
    try:
        select.select([descriptor], [], [])
    finally:
        os.close(descriptor)


def _poll(process_id: int) -> None:
    while _is_alive(process_id):
        time.sleep(POLL_INTERVAL_S)


def _is_alive(process_id: int) -> bool:
    try:
        os.kill(process_id, 0)
    except PermissionError:  # the process runs as another user
        return True
    except (OSError, OverflowError):
        return False
    return True


def _wait_on_windows(process_id: int) -> None:
    import ctypes  # noqa: PLC0415 - takes a while, and is needed here only

    synchronize, infinite = 0x00100000, 0xFFFFFFFF
    kernel = ctypes.windll.kernel32  # type: ignore[attr-defined,unused-ignore]
    handle = kernel.OpenProcess(synchronize, False, process_id)
    if handle:
        kernel.WaitForSingleObject(handle, infinite)
        kernel.CloseHandle(handle)
