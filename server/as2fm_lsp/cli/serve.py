# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp` without a command: the language server."""

from __future__ import annotations

import logging
import sys

from as2fm_lsp.cli.check import CLEAN, USAGE
from as2fm_lsp.cli.output import complain
from as2fm_lsp.server import create

UNEXPECTED_END = 1
"""The status that the protocol asks for when a server ends that was not told to shut down."""

SWITCH = 0.001
"""Seconds after which a computation lets the thread have a turn that reads what the client sends."""


def run(tcp: str | None) -> int:
    """Serve one client, on standard input and output or on `HOST:PORT`."""
    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(levelname)s %(name)s: %(message)s")
    logging.getLogger("pygls").setLevel(logging.CRITICAL)  # the server tells of errors itself
    sys.setswitchinterval(SWITCH)
    server = create()
    if tcp is None:
        server.start_io()
        return CLEAN if server.is_shut_down else UNEXPECTED_END
    host, _, port = tcp.rpartition(":")
    if not (port.isascii() and port.isdigit() and int(port) < 65536):
        return _usage(f"--tcp takes HOST:PORT, not {tcp}")
    try:
        server.start_tcp(host.removeprefix("[").removesuffix("]") or "127.0.0.1", int(port))
    except OSError as error:
        return _usage(f"--tcp {tcp}: {error.strerror or error}")
    return CLEAN if server.is_shut_down else UNEXPECTED_END


def _usage(message: str) -> int:
    complain(message)
    return USAGE
