# SPDX-License-Identifier: Apache-2.0
"""Whether the answer to a request is still needed.

- A request that the client has cancelled is answered with `RequestCancelled`, at once if it has not begun, otherwise at
  the next checkpoint.
- A request about a text that is about to change is answered with `ContentModified`, if the client has declared that it
  will then repeat the request. Others are answered for the text of the request, as the protocol requires.
"""

from __future__ import annotations

import asyncio
import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from pygls.exceptions import JsonRpcContentModified, JsonRpcRequestCancelled

from as2fm_lsp.inbox import Inbox
from roaml.interruption import Interrupted
from roaml.record import Record


class _Request(Record):
    """A request that is being handled.

    Attributes:
        ids: the id of the request, and the tokens of the progress that is shown for it.
        uri: the document whose change makes the answer useless; empty if there is none.
    """

    ids: list[object]
    uri: str


_current: ContextVar[_Request | None] = ContextVar("request", default=None)


class Requests:
    """The requests of a session.

    Args:
        inbox: the messages of the client.
        id_: a function that returns the id of the current request; `None` for a notification.

    Attributes:
        asked_again: the methods that the client repeats after `ContentModified`.
    """

    def __init__(self, inbox: Inbox, id_: Callable[[], str | int | None]) -> None:
        self.asked_again: frozenset[str] = frozenset()
        self._inbox = inbox
        self._id = id_

    def guarded(self, method: str, handler: Callable[..., Any]) -> Callable[..., Any]:
        """A handler that stops at its next checkpoint when its answer is no longer needed."""
        if asyncio.iscoroutinefunction(handler):

            @functools.wraps(handler)
            async def answer_later(*arguments: Any) -> Any:
                with self._request(method, arguments):
                    return await handler(*arguments)

            return answer_later

        @functools.wraps(handler)
        def answer(*arguments: Any) -> Any:
            with self._request(method, arguments):
                return handler(*arguments)

        return answer

    @property
    def is_handled(self) -> bool:
        """Whether the current code runs for a request."""
        return _current.get() is not None

    def checkpoint(self) -> None:
        """Stop the handling of a request whose answer is not needed.

        Raises:
            Interrupted: the answer to the current request is no longer needed.
        """
        request = _current.get()
        if request is not None and (self._is_cancelled(request) or self._is_stale(request)):
            raise Interrupted

    @contextmanager
    def cancelled_by(self, token: str) -> Iterator[None]:
        """Let the user also cancel the current request in the progress with this token, for the duration of the `with`
        statement."""
        request = _current.get()
        if request is not None:
            request.ids.append(token)
        try:
            yield
        finally:
            if request is not None:
                request.ids.remove(token)

    @contextmanager
    def _request(self, method: str, arguments: tuple[Any, ...]) -> Iterator[None]:
        id_ = self._id()
        if id_ is None:
            yield
            return
        request = _Request([id_], _uri(arguments) if method in self.asked_again else "")
        self._inbox.alive.add(id_)
        before = _current.set(request)
        try:
            self.checkpoint()
            yield
        except Interrupted:
            raise JsonRpcRequestCancelled() if self._is_cancelled(request) else JsonRpcContentModified() from None
        finally:
            _current.reset(before)
            self._inbox.forget(id_)

    def _is_cancelled(self, request: _Request) -> bool:
        return any(map(self._inbox.is_cancelled, request.ids))

    def _is_stale(self, request: _Request) -> bool:
        return bool(request.uri) and self._inbox.will_change(request.uri)


def _uri(arguments: tuple[Any, ...]) -> str:
    """The URI of the document of a request; "" if it is not about a document."""
    document = getattr(arguments[0], "text_document", None) if arguments else None
    return getattr(document, "uri", "")
