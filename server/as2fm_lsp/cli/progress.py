# SPDX-License-Identifier: Apache-2.0
"""What is being done, told on a terminal once it takes longer than a second."""

from __future__ import annotations

import sys
import threading
from types import TracebackType

PATIENCE = 1.0
"""Seconds without a word."""

_CLEAR = "\r\033[K"


class Progress:
    """Within `with`, `stage` tells what is done next. The line is gone at the end."""

    def __init__(self) -> None:
        self.shown = threading.Event()
        self._stage = ""
        self._lock = threading.Lock()
        self._timer = threading.Timer(PATIENCE, self._show)
        self._timer.daemon = True

    def __enter__(self) -> Progress:
        if sys.stderr.isatty():
            self._timer.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._timer.cancel()
        with self._lock:
            if self.shown.is_set():
                self._write("")

    def stage(self, text: str) -> None:
        with self._lock:
            self._stage = f"{text} …"
            if self.shown.is_set():
                self._write(self._stage)

    def _show(self) -> None:
        with self._lock:
            self._write(self._stage)
            self.shown.set()

    def _write(self, text: str) -> None:
        sys.stderr.write(f"{_CLEAR}{text}")
        sys.stderr.flush()
