# SPDX-License-Identifier: Apache-2.0
"""Progress of work, shown by the client if it supports that."""

from __future__ import annotations

import asyncio
import logging
import uuid
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from lsprotocol import types

from as2fm_lsp.client import Client
from as2fm_lsp.inbox import Inbox
from as2fm_lsp.requests import Requests

log = logging.getLogger(__name__)

CREATION_TIMEOUT_S = 10.0
"""The time that a client has to accept a progress token, in s; the work waits for it."""


class Progress:
    """The displayed progress of some work. Nothing is shown if `token` is empty.

    A percentage is sent only if it is greater than the previous one.
    """

    def __init__(self, client: Client, inbox: Inbox, requests: Requests, token: str) -> None:
        self.token = token
        self._client = client
        self._inbox = inbox
        self._requests = requests
        self._percentage = 0

    @property
    def is_cancelled(self) -> bool:
        """Whether the user has cancelled the work in the client."""
        return bool(self.token) and self._inbox.is_cancelled(self.token)

    async def step(self, message: str) -> None:
        """Begin a part of the work, after pending messages of the client are handled.

        Raises:
            Interrupted: the work is no longer needed.
        """
        self.set_message(message)
        await asyncio.sleep(0)
        self._requests.checkpoint()

    def set_message(self, message: str) -> None:
        """Show a text."""
        if self.token:
            self._client.report_progress(self.token, types.WorkDoneProgressReport(message=message))

    def report(self, done: int, total: int) -> None:
        percentage = done * 100 // max(total, 1)
        if self.token and percentage > self._percentage:
            self._percentage = percentage
            value = types.WorkDoneProgressReport(message=f"{done}/{total}", percentage=percentage)
            self._client.report_progress(self.token, value)


class ProgressReporter:
    """Shows the progress of work in the client."""

    def __init__(self, client: Client, inbox: Inbox, requests: Requests) -> None:
        self._client = client
        self._inbox = inbox
        self._requests = requests

    @asynccontextmanager
    async def show(self, title: str, *, cancellable: bool = False) -> AsyncIterator[Progress]:
        """Show the progress of some work, for the duration of the `async with` statement."""
        token = await self._created()
        work = Progress(self._client, self._inbox, self._requests, token)
        if not token:
            yield work
            return
        self._inbox.alive.add(token)
        begin = types.WorkDoneProgressBegin(title, cancellable=cancellable, percentage=None if cancellable else 0)
        self._client.begin_progress(token, begin)
        await asyncio.sleep(0)  # let the message be sent
        try:
            yield work
        finally:
            self._client.end_progress(token)
            self._inbox.forget(token)

    async def _created(self) -> str:
        """The token of the progress that the client accepts to show; empty if it does not."""
        window = self._client.capabilities.window
        if window is None or not window.work_done_progress:
            return ""
        token = str(uuid.uuid4())
        try:
            await asyncio.wait_for(self._client.create_progress(token), CREATION_TIMEOUT_S)
        except Exception as error:  # the work continues without it
            log.warning("progress cannot be shown: %s", error or type(error).__name__)
            return ""
        return token
