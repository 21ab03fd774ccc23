# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp serve`, or `as2fm-lsp` without a command: the language server."""

from __future__ import annotations

import logging
import os
import secrets
import socket
import sys
from collections.abc import Sequence

from as2fm_lsp import sockets
from as2fm_lsp.cli.arguments import ArgumentParser
from as2fm_lsp.cli.exit_status import CLEAN, USAGE
from as2fm_lsp.cli.options import serve_options
from as2fm_lsp.collector import spare_the_collector
from as2fm_lsp.server import create

UNEXPECTED_END = 1
"""The exit status that the protocol requires if a server ends without a `shutdown` request."""

SWITCH_INTERVAL_S = 0.001
"""The interval, in s, at which a computation gives way to the thread that reads the messages of the client."""

TOKEN = "AS2FM_TOKEN"
"""The environment variable with the token that a client must send. Without it, a token is generated and printed."""

MIN_TOKEN_CHARACTERS = 16


class _UsageError(ValueError):
    """A usage error; the message contains the reason."""


EXAMPLES = """\
examples:
  as2fm-lsp serve                          on standard input and output, as editors start the server
  as2fm-lsp serve --tcp 127.0.0.1:0        on a free port, for one editor that sends the printed token
  as2fm-lsp serve --socket server.sock     on a socket file to which only you can connect

exit status: 0 the editor has shut the server down, 1 the connection ended before that, 2 usage error
"""


def run(arguments: Sequence[str]) -> int:
    options = parser().parse_args(arguments)
    return serve(options.tcp, options.socket, options.allow_remote)


def parser() -> ArgumentParser:
    result = ArgumentParser(
        prog="as2fm-lsp serve",
        description="Serve one editor with the Language Server Protocol. as2fm-lsp without a command does the same.",
        epilog=EXAMPLES,
    )
    serve_options(result)
    return result


def serve(tcp: str | None = None, socket_file: str | None = None, allow_remote: bool = False) -> int:
    """Serve one client, on standard input and output, on a port or on a socket file.

    Args:
        tcp: `HOST:PORT`.
        socket_file: the path of the socket to create.
        allow_remote: whether `HOST` may be an address to which other machines can connect.
    """
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("pygls").setLevel(logging.CRITICAL)  # the server itself logs errors
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    spare_the_collector()
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
        raise _UsageError(f"--tcp needs HOST:PORT, not `{tcp}`")
    token = os.environ.pop(TOKEN, "") or secrets.token_urlsafe()
    if len(token) < MIN_TOKEN_CHARACTERS:
        raise _UsageError(f"{TOKEN} is too short to be a secret; use at least {MIN_TOKEN_CHARACTERS} characters")
    host = host.removeprefix("[").removesuffix("]") or "127.0.0.1"
    try:
        with sockets.listening_on(host, int(port), allow_remote) as listeners:
            for listener in listeners:
                _log(f"listening on {sockets.shown_address(listener)}")
            _log(f"the client must send as `token` in its initializationOptions: {token}")
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
            _log(f"listening on {path}")
            return sockets.first_client(listeners, token="")
    except OSError as error:
        raise _UsageError(f"--socket {path}: {error.strerror or error}") from None


def _log(text: str) -> None:
    """Log on standard error: standard output may be used for a client."""
    print(f"as2fm-lsp: {text}", file=sys.stderr, flush=True)
