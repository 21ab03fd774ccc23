# SPDX-License-Identifier: Apache-2.0
"""A status line on a terminal, for the duration of some work."""

from __future__ import annotations

import sys
import threading
import time
from types import TracebackType

SHOW_DELAY_S = 0.7
"""The delay before the line appears, in s."""
REFRESH_INTERVAL_S = 0.1

_CLEAR = "\r\033[K"


class StatusLine:
    """A line on standard error, in a `with` statement. Nothing is written if standard error is not a terminal."""

    def __init__(self) -> None:
        self.shown = threading.Event()
        self._is_terminal = sys.stderr.isatty()
        self._next = time.monotonic() + SHOW_DELAY_S
        self._text = ""
        self._lock = threading.Lock()
        self._timer = threading.Timer(SHOW_DELAY_S, self._appear)
        self._timer.daemon = True

    def __enter__(self) -> StatusLine:
        if self._is_terminal:
            self._timer.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._timer.cancel()
        with self._lock:
            if self.shown.is_set():
                self._write("")

    @property
    def is_due(self) -> bool:
        """Whether the line must be written now: for the first time after the delay, or because the last update is too
        old."""
        return self._is_terminal and time.monotonic() >= self._next

    def stage(self, text: str) -> None:
        """Set the text that describes the current stage of the work. It is shown when the line appears, or at once if
        the line is shown already."""
        with self._lock:
            self._text = f"{text} …"
            if self.shown.is_set():
                self._write(self._text)

    def show(self, text: str) -> None:
        """Show a text now. Only for calls while `is_due` is true."""
        with self._lock:
            self._next = time.monotonic() + REFRESH_INTERVAL_S
            self._text = text
            self.shown.set()
            self._write(text)

    def _appear(self) -> None:
        with self._lock:
            if not self.shown.is_set():
                self._write(self._text)
                self.shown.set()

    @staticmethod
    def _write(text: str) -> None:
        import shutil  # noqa: PLC0415 - only terminals need it

        width = shutil.get_terminal_size().columns - 1
        sys.stderr.write(_CLEAR + text[:width])
        sys.stderr.flush()
