# SPDX-License-Identifier: Apache-2.0
"""Interrupts of a long command: Ctrl-C, and SIGTERM, by which `timeout`, CI and containers end a command."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

from as2fm_lsp.cli.output import complain


class Interrupts:
    """While it is entered, SIGTERM raises `KeyboardInterrupt`, as Ctrl-C does: the command ends its workers and reports
    the results so far. Signals are not changed outside of the main thread, nor is a SIGTERM that is ignored or handled.
    """

    def __init__(self) -> None:
        self._is_terminated = False
        self._previous: dict[int, Any] = {}

    def __enter__(self) -> Interrupts:
        if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            self._previous[signal.SIGTERM] = signal.signal(signal.SIGTERM, self._terminate)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        for number, handler in self._previous.items():
            signal.signal(number, handler)
        self._previous.clear()

    @property
    def status(self) -> int:
        """The exit status of an interrupted command, as in shells: 128 + the number of the signal."""
        return 128 + (signal.SIGTERM if self._is_terminated else signal.SIGINT)

    def without_results(self) -> int:
        """Say that there are no results, and return the exit status."""
        complain("interrupted before there were results")
        return self.status

    def ignore(self) -> None:
        """Ignore further interrupts, so that the results so far are reported."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                previous = signal.signal(number, signal.SIG_IGN)
                self._previous.setdefault(number, previous)

    def _terminate(self, number: int, frame: FrameType | None) -> None:
        self._is_terminated = True
        raise KeyboardInterrupt
