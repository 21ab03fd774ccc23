# SPDX-License-Identifier: Apache-2.0
"""Messages of the base protocol: a header with `Content-Length`, an empty line, and JSON of that length.

The reader accepts any bytes. It skips data that are not a message: a header without a length, or a body that is not a
JSON object.
"""

from __future__ import annotations

import json
import re
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from typing import Any, BinaryIO, Protocol

from roaml.regex import regex

MAX_BODY = 1 << 26
"""The maximum length of a message in bytes; a longer one is skipped."""
MAX_HEADER_LINE = 4096
_LENGTH = regex(rb"\s*content-length\s*:\s*(\d{1,18})\s*", re.IGNORECASE)

Message = Mapping[str, Any]


def messages(stream: BinaryIO) -> Iterator[Message]:
    """The messages of a stream, until it ends."""
    while True:
        length = _read_header(stream)
        if length is None:
            return
        if length > MAX_BODY:
            _skip(stream, length)
            continue
        body = stream.read(length)
        if len(body) < length:
            return
        try:
            value = json.loads(body)
        except (ValueError, RecursionError):
            continue
        if isinstance(value, dict):
            yield value


def _read_header(stream: BinaryIO) -> int | None:
    """The length of the next message; `None` at the end of the stream."""
    length: int | None = None
    while True:
        line = stream.readline(MAX_HEADER_LINE)
        if not line:
            return None
        match = _LENGTH.fullmatch(line)
        if match is not None:
            length = int(match[1])
        elif not line.strip() and length is not None:
            return length


def _skip(stream: BinaryIO, length: int) -> None:
    while length > 0 and (part := stream.read(min(length, 1 << 16))):
        length -= len(part)


def write_message(stream: BinaryIO, message: Mapping[str, Any]) -> None:
    """Write a message with its header.

    Raises:
        OSError, ValueError: the stream is closed.
    """
    # Escapes in ASCII also preserve half a surrogate pair, which a client may have sent and UTF-8 cannot encode.
    body = json.dumps(message, separators=(",", ":")).encode("ascii")
    stream.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
    stream.flush()


class PendingMessages(Protocol):
    """Messages that have arrived and are not handled yet."""

    def take(self, *, waits: bool) -> Message | None:
        """The next message; `None` if there is none. With `waits`, wait for a message; `None` then means that no more
        messages arrive."""

    @property
    def has_ended(self) -> bool:
        """Whether the last message has been taken."""

    def has(self, matches: Callable[[Message], bool]) -> bool:
        """Whether there is a waiting message for which `matches` is true, or no more messages arrive."""


class MessageReader:
    """The messages that have arrived and are not handled yet; a thread reads them."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._waiting: deque[Message] = deque()
        self._has_ended = False
        self._changed = threading.Condition()
        threading.Thread(target=self._read, name="reader", daemon=True).start()

    def _read(self) -> None:
        try:
            for message in messages(self._stream):
                with self._changed:
                    self._waiting.append(message)
                    self._changed.notify()
        except (OSError, ValueError):
            pass  # the stream was closed
        with self._changed:
            self._has_ended = True
            self._changed.notify()

    def take(self, *, waits: bool) -> Message | None:
        """The next message; `None` if there is none. With `waits`, wait for a message; `None` then means that the
        stream has ended."""
        with self._changed:
            while waits and not self._waiting and not self._has_ended:
                self._changed.wait()
            return self._waiting.popleft() if self._waiting else None

    @property
    def has_ended(self) -> bool:
        """Whether the stream has ended and all of its messages have been taken."""
        with self._changed:
            return self._has_ended and not self._waiting

    def has(self, matches: Callable[[Message], bool]) -> bool:
        """Whether there is a waiting message for which `matches` is true, or the stream has ended."""
        with self._changed:
            return self._has_ended or any(map(matches, self._waiting))
