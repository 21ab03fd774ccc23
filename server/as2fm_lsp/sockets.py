# SPDX-License-Identifier: Apache-2.0
"""Waiting for one client on sockets.

Anyone who can reach a port can send data to it: other users of the machine, and the web pages that are open in a
browser. So a client is served only after its first message, which must be an `initialize` with the token that the
server was started with. A connection that begins in any other way, such as with HTTP, is closed before its data are
processed. A socket file needs no token: the operating system allows only its owner to connect.
"""

from __future__ import annotations

import errno
import ipaddress
import json
import logging
import os
import re
import secrets
import selectors
import socket
import stat
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from io import BufferedReader
from typing import Any, BinaryIO

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInvalidRequest, JsonRpcServerNotInitialized

from as2fm_lsp.json_rpc import error_response
from roaml.record import Record
from roaml.regex import regex

log = logging.getLogger(__name__)

FIRST_MESSAGE_TIMEOUT_S = 30.0

MAX_WAITING_CONNECTIONS = 16
"""The maximum number of connections without a first message. Further connections are rejected."""

MAX_FIRST_MESSAGE_BYTES = 1 << 24

_HEADER = regex(rb"Content-(?:Length:[ \t]*(?P<length>\d{1,9})|Type:[^\r\n]*)\r?\n", re.IGNORECASE)
_BEGIN = b"content-"
_MAX_HEADER_LINE_BYTES = 1000
_ABSENT = (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT)
"""Errors of addresses that this machine does not support, such as IPv6. A host name may have other addresses."""


class RemoteError(ValueError):
    """An address to which other machines can connect."""


class InUseError(OSError):
    """Another server uses the socket file, or the file is not a socket. The message states what to do."""


class Connection(Record, frozen=True):
    """The connection of an accepted client.

    Attributes:
        first: its first message, the `initialize`, without the token.
        source: the stream of its further messages.
        target: the stream for the answers.
    """

    first: dict[str, Any]
    channel: socket.socket
    source: BinaryIO
    target: BinaryIO


# -------------------------------------------------------------------- listening


@contextmanager
def listening_on(host: str, port: int, allow_remote: bool = False) -> Iterator[tuple[socket.socket, ...]]:
    """Sockets that listen at all addresses of `host`.

    Raises:
        RemoteError: other machines could connect, and `allow_remote` is False.
        OSError: an address is in use, or `host` has no address on this machine.
    """
    candidates = dict.fromkeys(socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE))
    addresses = [(family, address) for family, _, _, _, address in candidates]
    if not allow_remote and not all(_is_loopback(str(address[0])) for _, address in addresses):
        raise RemoteError(host)
    with ExitStack() as stack:
        listeners, absent = [], None
        for family, address in addresses:
            try:
                listeners.append(stack.enter_context(socket.create_server(address[:2], family=family)))
            except OSError as error:
                if error.errno not in _ABSENT:
                    raise
                absent = error
        if absent is not None and not listeners:
            raise absent
        yield tuple(listeners)


@contextmanager
def listening_at(path: str) -> Iterator[tuple[socket.socket, ...]]:
    """A socket file to which only the user can connect; it is removed at the end. A leftover file of another server is
    replaced.

    Raises:
        InUseError: another server listens at `path`, or `path` is a file of another kind.
        OSError: the file cannot be created.
    """
    if _is_socket(path):
        with socket.socket(socket.AF_UNIX) as probe:
            if probe.connect_ex(path) == 0:
                raise InUseError("another server is listening there; stop it, or name another file")
        os.unlink(path)
    elif os.path.lexists(path):
        raise InUseError("a file with this name already exists; remove it, or name another")
    with socket.socket(socket.AF_UNIX) as listener:
        before = os.umask(0o177)
        try:
            listener.bind(path)
        finally:
            os.umask(before)
        try:
            listener.listen()
            yield (listener,)
        finally:
            with suppress(OSError):
                os.unlink(path)


def shown_address(listener: socket.socket) -> str:
    """The address of a socket, in the form of `--tcp` or `--socket`."""
    name = listener.getsockname()
    if isinstance(name, str):
        return name
    host = f"[{name[0]}]" if ":" in name[0] else name[0]
    return f"{host}:{name[1]}"


def _is_loopback(address: str) -> bool:
    return ipaddress.ip_address(address.partition("%")[0]).is_loopback


def _is_socket(path: str) -> bool:
    try:
        return stat.S_ISSOCK(os.lstat(path).st_mode)
    except OSError:
        return False


# --------------------------------------------------------------------- admitting


def first_client(listeners: Sequence[socket.socket], token: str) -> Connection:
    """Wait for the first client that is accepted. Connections that are not accepted are closed.

    Args:
        token: the `token` that the client must send in its `initializationOptions`; "" if none is required.
    """
    admitted: list[Connection] = []
    claimed = threading.Lock()
    waiting = threading.Semaphore(MAX_WAITING_CONNECTIONS)
    news, wake_up = socket.socketpair()

    def greet(connection: socket.socket) -> None:
        try:
            client = _admitted(connection, token)
        except (OSError, ValueError, RecursionError) as error:  # the client has disconnected, or has sent invalid JSON
            log.warning("a connection was refused: %s", error)
            client = None
        finally:
            waiting.release()
        if client is not None and claimed.acquire(blocking=False):
            admitted.append(client)
            wake_up.send(b"!")
        else:
            connection.close()

    with news, wake_up, selectors.DefaultSelector() as ready:
        for listener in listeners:
            listener.setblocking(False)
            ready.register(listener, selectors.EVENT_READ, listener)
        ready.register(news, selectors.EVENT_READ)
        while not admitted:
            for key, _ in ready.select():
                if key.data is None:
                    continue
                with suppress(OSError):  # the other side has already disconnected
                    connection, _ = key.data.accept()
                    connection.setblocking(True)
                    if waiting.acquire(blocking=False):
                        threading.Thread(target=greet, args=(connection,), daemon=True).start()
                    else:
                        connection.close()
    return admitted[0]


def _admitted(connection: socket.socket, token: str) -> Connection | None:
    """The connection if its first message is accepted; otherwise `None`. The client then gets an error, unless the
    message does not follow the protocol.

    Raises:
        OSError, ValueError, RecursionError: the client has disconnected, or the message is not valid JSON.
    """
    connection.settimeout(FIRST_MESSAGE_TIMEOUT_S)
    source, target = connection.makefile("rb"), connection.makefile("wb")
    body = _first_body(source)
    if body is None:
        log.warning("a connection that does not follow the protocol was rejected")
        return None
    message = json.loads(body)
    error = _objection(message, token)
    if error is not None:
        log.warning("a client was rejected: %s", error)
        answer = json.dumps(error_response(message, error)).encode()
        target.write(b"Content-Length: %d\r\n\r\n%b" % (len(answer), answer))
        target.flush()
        return None
    connection.settimeout(None)
    return Connection(message, connection, source, target)


def _first_body(source: BufferedReader) -> bytes | None:
    """The body of the first message; `None` if a header line does not follow the protocol, or the message is too long
    or not complete."""
    length = 0
    begin = source.peek(len(_BEGIN))[: len(_BEGIN)].lower()
    if not _BEGIN.startswith(begin):  # checked first, because reading a line would wait for its end
        return None
    for line in iter(lambda: source.readline(_MAX_HEADER_LINE_BYTES), b""):
        if length and line in (b"\r\n", b"\n"):
            body = source.read(length)
            return body if len(body) == length else None
        header = _HEADER.fullmatch(line)
        if header is None:
            return None
        length = int(header["length"] or length)
        if length > MAX_FIRST_MESSAGE_BYTES:
            return None
    return None


def _objection(message: Any, token: str) -> JsonRpcException | None:
    """The error with which a first message is rejected; `None` if the message is valid. The token is removed from the
    message."""
    if not isinstance(message, dict) or message.get("method") != types.INITIALIZE:
        return JsonRpcServerNotInitialized("the first message must be `initialize`")
    if not token:
        return None
    params = message.get("params")
    options = params.get("initializationOptions") if isinstance(params, dict) else None
    given = options.pop("token", None) if isinstance(options, dict) else None
    if isinstance(given, str) and secrets.compare_digest(given.encode(errors="replace"), token.encode()):
        return None
    return JsonRpcInvalidRequest("`token` in `initializationOptions` must be the token that the server has printed")
