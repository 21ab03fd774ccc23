# SPDX-License-Identifier: Apache-2.0
"""Work that the client shows as being done, if it can."""

from __future__ import annotations

import asyncio
import logging
import uuid
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from lsprotocol import types

if TYPE_CHECKING:
    from as2fm_lsp.server import Server

log = logging.getLogger(__name__)

PATIENCE = 10.0
"""Seconds in which a client must say that it shows the work; the work waits for that."""


class Progress:
    """What is told of some work. Nothing is told if `token` is empty.

    The same share of the work is told once only.
    """

    def __init__(self, server: Server, token: str) -> None:
        self.token = token
        self._server = server
        self._told = 0

    @property
    def is_cancelled(self) -> bool:
        """Whether the user has cancelled the work where the client shows it."""
        return bool(self.token) and self._server.inbox.is_cancelled(self.token)

    async def step(self, what: str) -> None:
        """Begin a part of the work, after what the client has sent in the meantime is handled.

        Raises:
            Interrupted: the work is not wanted any more.
        """
        self.say(what)
        await asyncio.sleep(0)
        self._server.requests.checkpoint()

    def say(self, what: str) -> None:
        """Tell what is being done."""
        if self.token:
            self._server.work_done_progress.report(self.token, types.WorkDoneProgressReport(message=what))

    def report(self, done: int, total: int) -> None:
        percentage = done * 100 // max(total, 1)
        if self.token and percentage > self._told:
            self._told = percentage
            value = types.WorkDoneProgressReport(message=f"{done}/{total}", percentage=percentage)
            self._server.work_done_progress.report(self.token, value)


@asynccontextmanager
async def progress(server: Server, title: str, *, cancellable: bool = False) -> AsyncIterator[Progress]:
    token = await _created(server)
    if not token:
        yield Progress(server, "")
        return
    server.inbox.alive.add(token)
    begin = types.WorkDoneProgressBegin(title, cancellable=cancellable, percentage=None if cancellable else 0)
    server.work_done_progress.begin(token, begin)
    await asyncio.sleep(0)  # let the message out
    try:
        yield Progress(server, token)
    finally:
        server.work_done_progress.end(token, types.WorkDoneProgressEnd())
        server.work_done_progress.tokens.pop(token, None)
        server.inbox.forget(token)


async def _created(server: Server) -> str:
    """The token of work that the client is ready to show; empty if it is not."""
    window = server.client_capabilities.window
    if window is None or not window.work_done_progress:
        return ""
    token = str(uuid.uuid4())
    try:
        await asyncio.wait_for(server.work_done_progress.create_async(token), PATIENCE)
    except Exception as error:  # the work is done all the same
        log.warning("progress cannot be shown: %s", error or type(error).__name__)
        return ""
    return token
