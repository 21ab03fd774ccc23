# SPDX-License-Identifier: Apache-2.0
"""A status line on standard error, for the duration of some work.

On a terminal, it is one line that changes. Elsewhere, for example in the log of CI, it is a new line now and then, at
intervals that grow.
"""

from __future__ import annotations

import sys
import threading
import time
from types import TracebackType

from as2fm_lsp.cli.output import detail, is_quiet, note

SHOW_DELAY_S = 0.7
"""The delay before the line appears on a terminal, in s."""
REFRESH_INTERVAL_S = 0.1
LOG_DELAY_S = 10.0
"""The delay before the first line in a log, in s. Each further delay is twice as long, up to `MAX_LOG_DELAY_S`."""
MAX_LOG_DELAY_S = 60.0

_CLEAR = "\r\033[K"


class StatusLine:
    """A line on standard error, in a `with` statement. With `--quiet`, nothing is written; with `--verbose`, also how
    long each stage took."""

    def __init__(self) -> None:
        self.shown = threading.Event()
        self._is_terminal = sys.stderr.isatty()
        self._is_wanted = not is_quiet()
        self._delay = SHOW_DELAY_S if self._is_terminal else LOG_DELAY_S
        self._next = time.monotonic() + self._delay
        self._text = ""
        self._stage = ""
        self._began = time.monotonic()
        self._lock = threading.Lock()
        self._timer = threading.Timer(self._delay, self._appear)
        self._timer.daemon = True

    def __enter__(self) -> StatusLine:
        if self._is_wanted:
            self._timer.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._timer.cancel()
        with self._lock:
            if self.shown.is_set() and self._is_terminal:
                self._write("")
        self._end_stage()

    @property
    def is_due(self) -> bool:
        """Whether the line must be written now: for the first time after the delay, or because the last update is too
        old."""
        return self._is_wanted and time.monotonic() >= self._next

    def stage(self, text: str) -> None:
        """Set the text that describes the current stage of the work. It is shown when the line appears, or at once if
        the line is shown on a terminal already."""
        self._end_stage()
        self._stage, self._began = text, time.monotonic()
        with self._lock:
            self._text = f"{text} …"
            if self.shown.is_set() and self._is_terminal:
                self._write(self._text)

    def show(self, text: str) -> None:
        """Show a text now. Only for calls while `is_due` is true."""
        with self._lock:
            self._text = text
            self._present()

    def _appear(self) -> None:
        with self._lock:
            if not self.shown.is_set() and (self._is_terminal or self._text):
                self._present()

    def _present(self) -> None:
        """Write the line, and determine the time of the next one."""
        self.shown.set()
        if self._is_terminal:
            self._delay = REFRESH_INTERVAL_S
            self._write(self._text)
        else:
            self._delay = min(2 * self._delay, MAX_LOG_DELAY_S)
            note(self._text)
            sys.stderr.flush()
        self._next = time.monotonic() + self._delay

    def _end_stage(self) -> None:
        if self._stage:
            detail(f"{self._stage}: {time.monotonic() - self._began:.2f} s")
        self._stage = ""

    @staticmethod
    def _write(text: str) -> None:
        import shutil  # noqa: PLC0415 - only terminals need it

        width = shutil.get_terminal_size().columns - 1
        sys.stderr.write(_CLEAR + text[:width])
        sys.stderr.flush()
