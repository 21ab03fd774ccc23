# SPDX-License-Identifier: Apache-2.0
"""The protocol below the features: what is a message, and what is said to a message that comes at the wrong time.

pygls keeps a second copy of every document, of which nobody reads, splits lines differently and moves the positions of
changes while it applies them; and it keeps a future for every notification. Neither is done here.
"""

from __future__ import annotations

import asyncio
from concurrent.futures import Future
from contextlib import suppress
from typing import Any

from lsprotocol import types
from pygls.exceptions import (
    JsonRpcException,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcParseError,
    JsonRpcServerNotInitialized,
)
from pygls.protocol import JsonRPCProtocol, LanguageServerProtocol

from as2fm_lsp.inbox import CANCELLATIONS, is_id

_DOCUMENTS = (
    types.TEXT_DOCUMENT_DID_OPEN,
    types.TEXT_DOCUMENT_DID_CHANGE,
    types.TEXT_DOCUMENT_DID_CLOSE,
    types.NOTEBOOK_DOCUMENT_DID_OPEN,
    types.NOTEBOOK_DOCUMENT_DID_CHANGE,
    types.NOTEBOOK_DOCUMENT_DID_CLOSE,
)
"""What `Session` does and pygls would do a second time."""

_LONGEST_NAME = 60

_MOST_UNANSWERED = 1000
"""Requests to the client whose answers are waited for. A client that never answers must not fill the memory."""


class Protocol(LanguageServerProtocol):
    """The protocol of one session, from `initialize` to `exit`."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._is_initialized = False
        for method in _DOCUMENTS:
            self.fm.builtin_features.pop(method, None)

    # ------------------------------------------------------------------ in

    def receive(self, message: object) -> None:
        """Handle a message that was read: plain data, or the error if it is no JSON.

        Raises:
            JsonRpcException: it is no message that is understood, or it comes at the wrong time.
        """
        if isinstance(message, Exception):
            raise JsonRpcParseError(f"the message is not JSON: {message}")
        if not isinstance(message, dict) or message.get("jsonrpc") != self.VERSION:
            raise JsonRpcInvalidRequest(f'a message is one JSON object with `"jsonrpc": "{self.VERSION}"`')
        if "id" in message and "method" not in message:
            self._response(message)
            return
        method = message.get("method")
        if not isinstance(method, str) or not is_id(message.get("id", 0)):
            raise JsonRpcInvalidRequest("`method` is a string and `id` a number or a string")
        is_request = "id" in message
        if self._shutdown and method != types.EXIT:
            if is_request:
                raise JsonRpcInvalidRequest("the server was told to shut down; only `exit` can follow")
            return
        if method == types.INITIALIZE:
            self._check_initialize(message)
        elif not self._is_initialized and method != types.EXIT:
            if is_request:
                raise JsonRpcServerNotInitialized(f"`{_short(method)}` comes before `initialize`")
            return
        if method in CANCELLATIONS:
            _check_cancellation(message)
        structured = self._structured(message)
        if method == types.INITIALIZE:
            self._is_initialized = True
        self.handle_message(structured)

    def _structured(self, message: dict[str, Any]) -> Any:
        if self.get_message_type(message["method"]) is None:
            message.setdefault("params", None)
        elif message.get("params", 0) is None:
            del message["params"]  # some clients send null where there are none
        try:
            return self.structure_message(message)
        except Exception as error:
            raise JsonRpcInvalidParams(f"the parameters of `{_short(message['method'])}` are not understood") from error

    def _check_initialize(self, message: dict[str, Any]) -> None:
        if "id" not in message:
            raise JsonRpcInvalidRequest("`initialize` is a request and has an `id`")
        if self._is_initialized:
            raise JsonRpcInvalidRequest("the server is initialized already")

    def _response(self, message: dict[str, Any]) -> None:
        """An answer of the client. Those that nobody waits for are passed over."""
        if not is_id(message["id"]) or message["id"] not in self._request_futures:
            return
        if "error" in message:
            self._result_types.pop(message["id"], None)
        self.handle_message(self.structure_message(message))

    # ----------------------------------------------------------------- out

    def send_request(self, *arguments: Any, **named: Any) -> Future[Any]:
        future: Future[Any] = super().send_request(*arguments, **named)
        for id_ in tuple(self._result_types)[:-_MOST_UNANSWERED]:
            self._result_types.pop(id_, None)
            self._request_futures.pop(id_, None)
        return future

    def _execute_handler(self, msg_id: Any, handler: Any, callback: Any, args: Any = None, kwargs: Any = None) -> None:
        def done(future: Future[Any]) -> None:
            self._request_futures.pop(msg_id, None)
            with suppress(asyncio.CancelledError):  # as when the session ends: nobody waits
                callback(future)

        super()._execute_handler(msg_id, handler, done, args, kwargs)


def _check_cancellation(message: dict[str, Any]) -> None:
    """pygls takes any value for a token."""
    params, name = message.get("params"), CANCELLATIONS[message["method"]]
    if not isinstance(params, dict) or not is_id(params.get(name)):
        raise JsonRpcInvalidParams(f"`{name}` must be a number or a string")


def is_answered(message: object) -> bool:
    """Whether a message that is not understood is answered: notifications and answers are not."""
    return not isinstance(message, dict) or ("id" in message) == ("method" in message)


def error_response(message: object, error: JsonRpcException) -> dict[str, Any]:
    """The answer to a message that is not understood; its id is null where the message has none that could be used."""
    id_ = message.get("id") if isinstance(message, dict) else None
    body = {"code": error.code, "message": error.message}
    return {"jsonrpc": JsonRPCProtocol.VERSION, "id": id_ if is_id(id_) else None, "error": body}


def _short(text: str) -> str:
    return text if len(text) <= _LONGEST_NAME else f"{text[:_LONGEST_NAME]}…"
