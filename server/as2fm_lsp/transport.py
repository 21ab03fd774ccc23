# SPDX-License-Identifier: Apache-2.0
"""One connection to a client, on top of pygls: reading, checking, dispatching and answering messages.

This is the only module that uses private parts of pygls, or derives from its classes. It is written for pygls 2.1 and
the other versions that `pyproject.toml` allows (`pygls>=2.1,<3`). Review this module when that range changes.

It corrects these properties of pygls:

- pygls keeps an unused second copy of every document, splits lines differently and moves the positions of changes while
  it applies them. It also keeps a future for every notification.
- pygls executes requests that are not allowed yet or any more, and accepts any value as a token.
"""

from __future__ import annotations

import asyncio
import json
import logging
import sys
from collections.abc import Awaitable, Callable
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, BinaryIO
from urllib.parse import urlsplit

from lsprotocol import types
from pygls.exceptions import (
    JsonRpcException,
    JsonRpcInternalError,
    JsonRpcInvalidParams,
    JsonRpcInvalidRequest,
    JsonRpcParseError,
    JsonRpcRequestCancelled,
    JsonRpcServerNotInitialized,
    PyglsError,
)
from pygls.io_ import StdoutWriter
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol

from as2fm_lsp.inbox import CANCELLATIONS, Inbox, is_id
from as2fm_lsp.json_rpc import error_response, is_answered
from as2fm_lsp.sockets import Connection
from roaml import __version__

log = logging.getLogger(__name__)

_DOCUMENTS = (
    types.TEXT_DOCUMENT_DID_OPEN,
    types.TEXT_DOCUMENT_DID_CHANGE,
    types.TEXT_DOCUMENT_DID_CLOSE,
    types.NOTEBOOK_DOCUMENT_DID_OPEN,
    types.NOTEBOOK_DOCUMENT_DID_CHANGE,
    types.NOTEBOOK_DOCUMENT_DID_CLOSE,
)
"""Notifications that `Session` handles. The handlers of pygls for them are not called."""

_MAX_NAME_CHARACTERS = 60

_MAX_UNANSWERED = 1000
"""The maximum number of pending requests to the client: a client that never answers must not fill the memory."""


class Protocol(LanguageServerProtocol):
    """The protocol of one session, from `initialize` to `exit`."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._is_initialized = False
        for method in _DOCUMENTS:
            self.fm.builtin_features.pop(method, None)

    # ------------------------------------------------------------------ in

    def receive(self, message: object) -> None:
        """Handle a message: plain data, or the error if it is not JSON.

        Raises:
            JsonRpcException: the message is not valid, or arrives at the wrong time.
        """
        if isinstance(message, Exception):
            raise JsonRpcParseError(f"the message is not valid JSON: {message}")
        if not isinstance(message, dict) or message.get("jsonrpc") != self.VERSION:
            raise JsonRpcInvalidRequest(f'a message must be one JSON object with `"jsonrpc": "{self.VERSION}"`')
        if "id" in message and "method" not in message:
            self._response(message)
            return
        method = message.get("method")
        if not isinstance(method, str) or not is_id(message.get("id", 0)):
            raise JsonRpcInvalidRequest("`method` must be a string and `id` a number or a string")
        is_request = "id" in message
        if self._shutdown and method != types.EXIT:
            if is_request:
                raise JsonRpcInvalidRequest("the server was shut down; only `exit` is allowed")
            return
        if method == types.INITIALIZE:
            self._check_initialize(message)
        elif not self._is_initialized and method != types.EXIT:
            if is_request:
                raise JsonRpcServerNotInitialized(f"`{_short(method)}` is not allowed before `initialize`")
            return
        if method in CANCELLATIONS:
            _check_cancellation(message)
        structured = self._structured(message)
        if method == types.INITIALIZE:
            _check_folders(structured.params)
            self._is_initialized = True
        self.handle_message(structured)

    def _structured(self, message: dict[str, Any]) -> Any:
        if self.get_message_type(message["method"]) is None:
            message.setdefault("params", None)
        elif message.get("params", 0) is None:
            del message["params"]  # some clients send null where there are no parameters
        try:
            return self.structure_message(message)
        except Exception as error:
            raise JsonRpcInvalidParams(f"the parameters of `{_short(message['method'])}` are not valid") from error

    def _check_initialize(self, message: dict[str, Any]) -> None:
        if "id" not in message:
            raise JsonRpcInvalidRequest("`initialize` must be a request with an `id`")
        if self._is_initialized:
            raise JsonRpcInvalidRequest("the server is already initialized")

    def _response(self, message: dict[str, Any]) -> None:
        """Handle a response of the client. Unexpected responses are ignored."""
        if not is_id(message["id"]) or message["id"] not in self._request_futures:
            return
        if "error" in message:
            self._result_types.pop(message["id"], None)
        self.handle_message(self.structure_message(message))

    # ----------------------------------------------------------------- out

    def send_request(self, *arguments: Any, **named: Any) -> Future[Any]:
        future: Future[Any] = super().send_request(*arguments, **named)
        for id_ in tuple(self._result_types)[:-_MAX_UNANSWERED]:
            self._result_types.pop(id_, None)
            self._request_futures.pop(id_, None)
        return future

    def _execute_handler(self, msg_id: Any, handler: Any, callback: Any, args: Any = None, kwargs: Any = None) -> None:
        def done(future: Future[Any]) -> None:
            self._request_futures.pop(msg_id, None)
            with suppress(asyncio.CancelledError):  # for example at the end of the session, when nothing waits for it
                callback(future)

        super()._execute_handler(msg_id, handler, done, args, kwargs)


def _check_folders(params: types.InitializeParams) -> None:
    """Reject folders with invalid URIs, for which pygls would fail with an internal error."""
    folders = (("workspaceFolders", folder.uri) for folder in params.workspace_folders or ())
    for name, uri in (("rootUri", params.root_uri), *folders):
        try:
            urlsplit(uri or "")
        except ValueError:
            raise JsonRpcInvalidParams(f"`{name}` of `initialize` is not a valid URI") from None


def _check_cancellation(message: dict[str, Any]) -> None:
    """Reject an invalid id or token, because pygls accepts any value."""
    params, name = message.get("params"), CANCELLATIONS[message["method"]]
    if not isinstance(params, dict) or not is_id(params.get(name)):
        raise JsonRpcInvalidParams(f"`{name}` must be a number or a string")


def _short(text: str) -> str:
    return text if len(text) <= _MAX_NAME_CHARACTERS else f"{text[:_MAX_NAME_CHARACTERS]}…"


class Endpoint(LanguageServer):
    """The connection to one client.

    Attributes:
        is_shut_down: whether the client has asked the server to shut down.
        has_parent: whether the client has started this process, so that the server ends with it.
    """

    protocol: Protocol

    def __init__(self, inbox: Inbox) -> None:
        super().__init__("as2fm-lsp", __version__, protocol_cls=Protocol)
        self.is_shut_down = False
        self.has_parent = False
        self._inbox = inbox

    # ------------------------------------------------------------- dispatching

    @property
    def request_id(self) -> str | int | None:
        """The id of the current request; `None` for a notification."""
        id_: str | int | None = self.protocol.msg_id
        return id_

    def on(self, method: str, handler: Callable[..., Any], options: object = None) -> None:
        """Let `handler` answer a request or receive a notification."""
        self.feature(method, options)(handler)

    def on_command(self, name: str, handler: Callable[..., Awaitable[Any]]) -> None:
        """Let `handler` execute a command of `workspace/executeCommand`. It gets the arguments as received."""

        async def run(ls: LanguageServer, *arguments: object) -> Any:
            # pygls inspects names: the first parameter must be `ls`, and then any number of arguments is passed on.
            return await handler(*arguments)

        self.command(name)(run)

    def cancel_requests(self) -> None:
        """Cancel all requests except the current one.

        pygls does the same, but fails if a command is running: cancelling it changes the collection during the
        iteration.
        """
        for id_, future in tuple(self.protocol._request_futures.items()):
            if id_ != self.protocol.msg_id and not future.done():
                future.cancel()

    # ----------------------------------------------------------------- serving

    def start_io(self, stdin: BinaryIO | None = None, stdout: BinaryIO | None = None) -> None:
        self.has_parent = True
        # Open a second reader: a thread that reads `sys.stdin` keeps it locked, so the process could not end.
        source = stdin or open(sys.stdin.fileno(), "rb", closefd=False)  # noqa: SIM115 - read until the process ends
        self.serve(source, stdout or sys.stdout.buffer)

    def serve_client(self, connection: Connection) -> None:
        """Serve a client that has connected to a socket."""
        self._inbox.put(json.dumps(connection.first).encode())
        with connection.channel:
            self.serve(connection.source, connection.target)

    def serve(self, source: BinaryIO, target: BinaryIO) -> None:
        """Serve one client, until it requests the exit or closes the connection."""
        self.protocol.set_writer(StdoutWriter(target))
        try:
            asyncio.run(self._handle_messages(source))
        except BrokenPipeError:
            log.error("the connection to the client is lost")
        except (KeyboardInterrupt, SystemExit):
            pass
        finally:
            self.shutdown()  # type: ignore[no-untyped-call]

    async def _handle_messages(self, source: BinaryIO) -> None:
        asyncio.get_running_loop().set_exception_handler(_report)
        self._inbox.fill_from(source)
        async for message in self._inbox:
            try:
                self.protocol.receive(message)
            except BrokenPipeError:
                raise
            except JsonRpcException as error:
                self._refuse(message, error)
            except Exception as error:  # the session continues whatever the client sends
                log.exception("a message cannot be handled")
                self._refuse(message, JsonRpcInternalError(f"{type(error).__name__} in the server"))
            await asyncio.sleep(0)

    def _refuse(self, message: object, error: JsonRpcException) -> None:
        """Answer a message that is invalid or not allowed at this time, if it expects an answer."""
        if is_answered(message):
            self.protocol._send_data(error_response(message, error))
        else:
            log.warning("a message is ignored: %s", error)

    def report_server_error(self, error: Exception, source: type[PyglsError]) -> None:  # type: ignore[override]
        """Log an error of the server, without a message in the client for each keystroke. A rejected request is not an
        error."""
        if not isinstance(error, JsonRpcException) or isinstance(error, JsonRpcInternalError):
            known = error.data if isinstance(error, JsonRpcException) and isinstance(error.data, dict) else {}
            log.error("%s\n%s", source.__name__, "".join(known.get("traceback", ())), exc_info=error)


def _report(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Log an error that no coroutine waits for. A cancelled request is not an error."""
    if not isinstance(context.get("exception"), JsonRpcRequestCancelled):
        loop.default_exception_handler(context)
