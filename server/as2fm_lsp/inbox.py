# SPDX-License-Identifier: Apache-2.0
"""Messages that have been read and are not yet handled.

- A separate thread reads them, so that they are available during computations; they are handled one after the other, in
  their order, on the event loop.
- A cancellation takes effect as soon as it is read, before the messages that precede it are handled.
"""

from __future__ import annotations

import asyncio
import json
import logging
import re
import threading
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, BinaryIO, TypeGuard

from lsprotocol import types

from roaml.regex import regex

log = logging.getLogger(__name__)

_LENGTH = regex(rb"(?:.*[^-])?Content-Length:[ \t]*(\d{1,12})\s*", re.IGNORECASE | re.DOTALL)
"""A header with the length. It may follow the rest of an invalid message, so that the next message is recognised."""

_FIELD = regex(rb"[A-Za-z-]+:")
"""The beginning of a header line."""

MAX_MESSAGE_BYTES = 1 << 28
"""The maximum length of a message, in bytes; longer input is invalid."""

_MAX_LINE_BYTES = 1 << 16
_PIECE_BYTES = 1 << 20
_CHANGES = (types.TEXT_DOCUMENT_DID_CHANGE, types.TEXT_DOCUMENT_DID_CLOSE)
CANCELLATIONS = {types.CANCEL_REQUEST: "id", types.WINDOW_WORK_DONE_PROGRESS_CANCEL: "token"}


class Inbox:
    """The queue of the client's messages.

    Attributes:
        alive: the ids of requests and the tokens of work that can still be cancelled, besides those in the queue.
    """

    def __init__(self) -> None:
        self.alive: set[object] = set()
        self._messages: deque[object] = deque()
        self._cancelled: set[object] = set()
        self._news = asyncio.Event()
        self._ended = False
        self._wake: Callable[[], None] = lambda: None

    # ---------------------------------------------------------------- filling

    def fill_from(self, stream: BinaryIO) -> None:
        """Read a stream to its end, in a daemon thread."""
        loop = asyncio.get_running_loop()

        def wake() -> None:
            try:
                loop.call_soon_threadsafe(self._news.set)
            except RuntimeError:  # the loop is closed: there is no receiver left
                return

        self._wake = wake

        def read() -> None:
            try:
                for body in bodies(stream):
                    self.put(body)
                    wake()
            except (OSError, ValueError) as error:  # the connection is lost, or the stream was closed
                log.debug("reading from the client failed: %s", error)
            finally:
                self.end()

        threading.Thread(target=read, name="inbox", daemon=True).start()

    def end(self) -> None:
        """Signal the end of the messages, from any thread."""
        self._ended = True
        self._wake()

    def put(self, body: bytes) -> None:
        try:
            message = json.loads(body)
        except (ValueError, RecursionError) as error:
            message = error
        cancelled = _cancelled(message)
        if cancelled is not None:
            self._cancelled.add(cancelled)
        self._messages.append(message)

    # ---------------------------------------------------------------- looking

    @property
    def waiting(self) -> bool:
        """Whether there is a pending message."""
        return bool(self._messages)

    def is_cancelled(self, id_: object) -> bool:
        """Whether a request, or work with a token, has been cancelled."""
        return id_ in self._cancelled

    def will_change(self, uri: str) -> bool:
        """Whether a notification that changes or closes a document is pending."""
        return any(_changes(message, uri) for message in tuple(self._messages))

    # ----------------------------------------------------------------- taking

    def __aiter__(self) -> Inbox:
        return self

    async def __anext__(self) -> Any:
        """The next message as plain data, or an error if the message is not valid JSON."""
        while not self._messages:
            if self._ended:
                raise StopAsyncIteration
            self._news.clear()
            if not self._messages and not self._ended:
                await self._news.wait()
        message = self._messages.popleft()
        cancelled = _cancelled(message)
        if cancelled is not None and cancelled not in self.alive:
            self._cancelled.discard(cancelled)  # the request was answered before
        return message

    def forget(self, id_: object) -> None:
        """Discard the state of a request that was answered, or of work that has ended."""
        self.alive.discard(id_)
        self._cancelled.discard(id_)


def bodies(stream: BinaryIO) -> Iterator[bytes]:
    """The bodies of the messages in a stream; invalid data are skipped."""
    length = 0
    for line in iter(partial(stream.readline, _MAX_LINE_BYTES), b""):
        match = _LENGTH.fullmatch(line)
        if match:
            length = int(match[1])
        elif line.strip():
            length = length if _FIELD.match(line) else 0  # not a header line: the length before it is invalid
        elif length:
            if length <= MAX_MESSAGE_BYTES:
                body = b"".join(_pieces(stream, length))
                if len(body) < length:
                    return
                yield body
            length = 0


def _pieces(stream: BinaryIO, length: int) -> Iterator[bytes]:
    """The next `length` bytes of a stream, in pieces. Memory is allocated for received data, not for the announced
    length."""
    while length and (piece := stream.read(min(length, _PIECE_BYTES))):
        length -= len(piece)
        yield piece


def _params(message: object, *methods: str) -> dict[str, Any] | None:
    """The parameters of a message if it has one of these methods."""
    if isinstance(message, dict) and message.get("method") in methods and isinstance(message.get("params"), dict):
        params: dict[str, Any] = message["params"]
        return params
    return None


def _cancelled(message: object) -> str | int | None:
    """The id or token of the request or work that a message cancels."""
    params = _params(message, *CANCELLATIONS)
    if params is None or not isinstance(message, dict):
        return None
    id_ = params.get(CANCELLATIONS[message["method"]])
    return id_ if is_id(id_) else None


def is_id(value: object) -> TypeGuard[int | str]:
    """Whether a value is a valid id of a request, or a valid token of work."""
    return isinstance(value, (int, str)) and not isinstance(value, bool)


def _changes(message: object, uri: str) -> bool:
    params = _params(message, *_CHANGES)
    document = params.get("textDocument") if params else None
    return isinstance(document, dict) and document.get("uri") == uri
