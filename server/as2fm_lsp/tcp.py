# SPDX-License-Identifier: Apache-2.0
"""Waiting for one client on a socket."""

from __future__ import annotations

import errno
import selectors
import socket
from contextlib import ExitStack

_ABSENT = (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT)
"""A name may stand for addresses that this machine does not have, as that of IPv6."""


def accepted(host: str, port: int) -> socket.socket:
    """Wait for the first client that connects, on all addresses that `host` stands for.

    Raises:
        OSError: an address is taken, or there is none.
    """
    addresses = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    with ExitStack() as listeners, selectors.DefaultSelector() as ready:
        absent = None
        for family, _, _, _, address in dict.fromkeys(addresses):
            try:
                listener = listeners.enter_context(socket.create_server(address[:2], family=family))
            except OSError as error:
                if error.errno not in _ABSENT:
                    raise
                absent = error
            else:
                ready.register(listener, selectors.EVENT_READ, listener)
        if absent is not None and not ready.get_map():
            raise absent
        key, _ = ready.select()[0]
        client: socket.socket = key.data.accept()[0]
        return client
