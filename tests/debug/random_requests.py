# SPDX-License-Identifier: Apache-2.0
"""Sends random requests to an adapter in a separate process. The adapter must answer each one."""

from __future__ import annotations

from pathlib import Path

from dap_client import Client

from fuzz.debug_requests import MOVING, Requests


def run(seed: int, count: int, program: Path) -> tuple[int, int]:
    """Send random requests; return the numbers of successful and rejected ones. Each must be answered by a message that
    fits the schema."""
    requests, done, refused = Requests(seed, program), 0, 0
    with Client() as client:
        client.launch(program)
        client.ask("configurationDone")
        client.event("stopped")
        for _ in range(count):
            command, arguments = requests.next()
            response = client.response(client.send(command, **arguments))
            done, refused = done + response["success"], refused + (not response["success"])
            if command in (*MOVING, "goToStep") and response["success"]:
                client.response(client.send("pause", threadId=1))
            client.events.clear()
        client.ask("threads")
    return done, refused
