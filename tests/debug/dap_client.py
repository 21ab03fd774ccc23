# SPDX-License-Identifier: Apache-2.0
"""A client of the Debug Adapter Protocol over standard input and output. It shares no code with the adapter, and
validates every message in both directions against the schema of the protocol."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import prefork
from dap_schema import validate


class Client:
    """An adapter as a separate process: a fork (`prefork`), unless a command is given.

    Attributes:
        events: the events that have arrived and that no test has waited for yet.
    """

    def __init__(self, command: tuple[str, ...] = (), *, validates: bool = True) -> None:
        self._validates = validates
        self.process = subprocess.Popen(
            (*(command or prefork.command()), "debug"),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self.events: list[dict[str, Any]] = []
        self._sequence = 0
        self._last = 0

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *error: object) -> None:
        self.process.kill()
        self.process.communicate()

    # ------------------------------------------------------------ messages

    def send(self, command: str, **arguments: Any) -> int:
        """Send a request; return its number."""
        self._sequence += 1
        request = {"seq": self._sequence, "type": "request", "command": command, "arguments": arguments}
        self.write(json.dumps(request).encode())
        return self._sequence

    def write(self, body: bytes) -> None:
        self.raw(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))

    def raw(self, data: bytes) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(data)
        self.process.stdin.flush()

    def read(self) -> dict[str, Any]:
        """The next message, validated with the schema.

        Raises:
            EOFError: the adapter has ended.
        """
        stream = self.process.stdout
        assert stream is not None
        header = b""
        while not header.endswith(b"\r\n\r\n"):
            line = stream.readline()
            if not line:
                raise EOFError
            header += line
        length = int(header.split(b":")[1])
        message = json.loads(stream.read(length))
        assert message["seq"] == self._last + 1
        self._last = message["seq"]
        if self._validates:
            validate(message)
        assert isinstance(message, dict)
        return message

    def response(self, number: int) -> dict[str, Any]:
        """The response to a request; events before it are kept."""
        while True:
            message = self.read()
            if message["type"] == "response":
                assert message["request_seq"] == number
                return message
            self.events.append(message)

    def ask(self, command: str, **arguments: Any) -> Any:
        """The body of the successful response to a request."""
        response = self.response(self.send(command, **arguments))
        assert response["success"], response
        return response.get("body")

    def refusal(self, command: str, **arguments: Any) -> str:
        """The reason why a request is rejected."""
        response = self.response(self.send(command, **arguments))
        assert not response["success"], response
        assert isinstance(response["message"], str)
        return response["message"]

    def event(self, name: str) -> dict[str, Any]:
        """The body of the next event of this name; others are kept."""
        for number, event in enumerate(self.events):
            if event["event"] == name:
                return dict(self.events.pop(number).get("body", {}))
        while True:
            message = self.read()
            assert message["type"] == "event"
            if message["event"] == name:
                return dict(message.get("body", {}))
            self.events.append(message)

    # ------------------------------------------------------------ sessions

    def launch(self, program: Path | str, **arguments: Any) -> None:
        self.ask("initialize", adapterID="as2fm", clientID="test")
        self.ask("launch", program=str(program), **arguments)
        self.event("initialized")

    def begin(self, program: Path | str, **arguments: Any) -> dict[str, Any]:
        """Launch and begin; return where the run stops first."""
        self.launch(program, **arguments)
        self.ask("configurationDone")
        return self.event("stopped")

    def move(self, command: str = "continue", **arguments: Any) -> dict[str, Any]:
        """Move the run; return where it stops."""
        self.ask(command, **{"threadId": 1, **arguments})
        return self.event("stopped")

    def stack(self, thread: int) -> list[dict[str, Any]]:
        frames = self.ask("stackTrace", threadId=thread)["stackFrames"]
        assert isinstance(frames, list)
        return frames

    def top(self, thread: int) -> tuple[str, int]:
        """The file name and the line of the innermost frame."""
        frame = self.stack(thread)[0]
        return frame["source"]["name"], frame["line"]

    def scope(self, frame: int, name: str) -> dict[str, dict[str, Any]]:
        """The variables of a scope, by their names."""
        scopes = self.ask("scopes", frameId=frame)["scopes"]
        reference = next(scope["variablesReference"] for scope in scopes if scope["name"] == name)
        return {
            variable["name"]: variable for variable in self.ask("variables", variablesReference=reference)["variables"]
        }

    def step(self) -> int:
        step = self.ask("choices")["step"]
        assert isinstance(step, int)
        return step
