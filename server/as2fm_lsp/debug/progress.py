# SPDX-License-Identifier: Apache-2.0
"""The progress of a search for a trace, which the client shows and can cancel."""

from __future__ import annotations

import time
from collections.abc import Callable

from as2fm_lsp.debug.framing import Message, PendingMessages
from as2fm_lsp.debug.session import DebugSession
from roaml.debugging.start import MAX_TRACES

PROGRESS_DELAY_S = 0.5
"""A search that takes less time shows no progress."""
UPDATE_INTERVAL_S = 0.25
LOG_INTERVAL_S = 10.0
"""The time between two lines of the console, for clients that do not show progress."""
_ENDING = ("disconnect", "terminate")


class SearchProgress:
    """The progress of the search for which a request waits; is called after each trace.

    Args:
        request: the number of the request.
        clock: the current time in s.
    """

    def __init__(
        self,
        session: DebugSession,
        inbox: PendingMessages,
        request: int,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._session = session
        self._inbox = inbox
        self._request = request
        self._id = f"search-{request}"
        self._clock = clock
        self._shows_progress = session.client.shows_progress
        self._next = clock() + (PROGRESS_DELAY_S if self._shows_progress else LOG_INTERVAL_S)
        self._has_begun = False

    def __call__(self, count: int) -> bool:
        """Show that `count` traces have been simulated; return whether the search is cancelled."""
        if self._clock() >= self._next:
            self._show(count)
        return self._inbox.has(self._cancels)

    def _cancels(self, message: Message) -> bool:
        if message.get("command") in _ENDING:
            return True
        arguments = message.get("arguments")
        given = arguments if isinstance(arguments, dict) else {}
        is_ours = given.get("requestId") == self._request or given.get("progressId") == self._id
        return message.get("command") == "cancel" and is_ours

    def _show(self, count: int) -> None:
        text = f"{count:,} of at most {MAX_TRACES:,} traces"
        connection = self._session.connection
        if not self._shows_progress:
            self._session.log(f"searching for a trace: {text}")
            self._next = self._clock() + LOG_INTERVAL_S
            return
        body = {"progressId": self._id, "message": text, "percentage": 100 * count / MAX_TRACES}
        if self._has_begun:
            connection.event("progressUpdate", body)
        else:
            begin = {"title": "Searching for a trace", "requestId": self._request, "cancellable": True}
            connection.event("progressStart", {**body, **begin})
        self._has_begun = True
        self._next = self._clock() + UPDATE_INTERVAL_S

    def end(self) -> None:
        """Show that the search has ended."""
        if self._has_begun:
            self._session.connection.event("progressEnd", {"progressId": self._id})
