# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp` without a command: the language server."""

from __future__ import annotations

import logging
import os
import secrets
import socket
import sys

from as2fm_lsp import sockets
from as2fm_lsp.cli.check import CLEAN, USAGE
from as2fm_lsp.server import create

UNEXPECTED_END = 1
"""The exit status that the protocol requires if a server ends without a `shutdown` request."""

SWITCH = 0.001
"""The interval in s after which a computation yields to the thread that reads the client's messages."""


TOKEN = "AS2FM_TOKEN"
"""The environment variable with the token of a client, so that it need not be read from the log."""

SHORTEST_TOKEN = 16


class _UsageError(ValueError):
    """A usage error; the message contains the reason."""


def run(tcp: str | None = None, socket_file: str | None = None, allow_remote: bool = False) -> int:
    """Serve one client, on standard input and output, on a port or on a socket file.

    Args:
        tcp: `HOST:PORT`.
        socket_file: the path of the socket to create.
        allow_remote: whether `HOST` may be an address to which other machines can connect.
    """
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("pygls").setLevel(logging.CRITICAL)  # the server itself logs errors
    sys.setswitchinterval(SWITCH)
    server = create()
    try:
        if tcp is not None and socket_file is not None:
            raise _UsageError("--tcp and --socket exclude each other")
        if allow_remote and tcp is None:
            raise _UsageError("--allow-remote needs --tcp")
        if tcp is not None:
            server.serve_client(_tcp_client(tcp, allow_remote))
        elif socket_file is not None:
            server.serve_client(_socket_file_client(socket_file))
        else:
            server.start_io()
    except _UsageError as error:
        print(f"as2fm-lsp: {error}", file=sys.stderr)
        return USAGE
    return CLEAN if server.is_shut_down else UNEXPECTED_END


def _tcp_client(tcp: str, allow_remote: bool) -> sockets.Connection:
    host, _, port = tcp.rpartition(":")
    if not (port.isascii() and port.isdigit() and len(port) < 6 and int(port) < 65536):
        raise _UsageError(f"--tcp needs HOST:PORT, not {tcp}")
    token = os.environ.pop(TOKEN, "") or secrets.token_urlsafe()
    if len(token) < SHORTEST_TOKEN:
        raise _UsageError(f"{TOKEN} is too short for a secret; it needs at least {SHORTEST_TOKEN} characters")
    host = host.removeprefix("[").removesuffix("]") or "127.0.0.1"
    try:
        with sockets.listening_on(host, int(port), allow_remote) as listeners:
            for listener in listeners:
                _say(f"listening on {sockets.shown_address(listener)}")
            _say(f"the client must send as `token` in its initializationOptions: {token}")
            return sockets.first_client(listeners, token)
    except sockets.RemoteError:
        text = f"--tcp {tcp}: other machines could connect there; use 127.0.0.1, or add --allow-remote"
        raise _UsageError(text) from None
    except OSError as error:
        raise _UsageError(f"--tcp {tcp}: {error.strerror or error}") from None


def _socket_file_client(path: str) -> sockets.Connection:
    if not hasattr(socket, "AF_UNIX"):
        raise _UsageError("--socket: this system does not support socket files; use --tcp")
    try:
        with sockets.listening_at(path) as listeners:
            _say(f"listening on {path}")
            return sockets.first_client(listeners, token="")
    except OSError as error:
        raise _UsageError(f"--socket {path}: {error.strerror or error}") from None


def _say(text: str) -> None:
    """Log on standard error: standard output may be used for a client."""
    print(f"as2fm-lsp: {text}", file=sys.stderr, flush=True)
