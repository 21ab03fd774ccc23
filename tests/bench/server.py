# SPDX-License-Identifier: Apache-2.0
"""A language server as a process, with which the benchmark communicates over standard input and output.

Messages are prepared before the measurement, and a thread records when each answer arrives. So the measured time is
that of the server: its computation, its reading and its writing.
"""

from __future__ import annotations

import json
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any, TypeAlias

from bench.report import listed
from timeouts import TIMEOUT_S

COMMAND = (sys.executable, "-m", "as2fm_lsp")

Wanted: TypeAlias = Callable[[dict[str, Any]], bool]
"""A function that returns whether a message is the expected one."""


class Server:
    """A server process.

    Attributes:
        started: when the process was started, in s of `time.perf_counter`.
        capabilities: the capabilities that the server declares.
    """

    def __init__(self, command: Sequence[str] = COMMAND) -> None:
        pipe = subprocess.PIPE
        self.started = time.perf_counter()
        self.capabilities: dict[str, Any] = {}
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe)
        self._answers: queue.Queue[tuple[float, dict[str, Any]]] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def initialize(
        self, folder: Path, capabilities: dict[str, Any] | None = None, options: dict[str, Any] | None = None
    ) -> None:
        """Initialize the server.

        Args:
            capabilities: the capabilities of the client.
            options: the initialization options.
        """
        folders = [{"uri": folder.as_uri(), "name": folder.name}]
        params = {"processId": None, "workspaceFolders": folders, "capabilities": capabilities or {}}
        self.send("initialize", {**params, "initializationOptions": options}, 1)
        self.capabilities = self.answer(1)[1]["result"]["capabilities"]
        self.send("initialized", {})

    def open(self, path: Path, text: str) -> float:
        """Open a document; return the time directly before."""
        document = {"uri": path.as_uri(), "languageId": "ascxml", "version": 1, "text": text}
        return self.send("textDocument/didOpen", {"textDocument": document})

    def change(self, path: Path, version: int, change: dict[str, Any]) -> float:
        """Send a change of a document; return the time directly before."""
        document = {"uri": path.as_uri(), "version": version}
        return self.send("textDocument/didChange", {"textDocument": document, "contentChanges": [change]})

    def send(self, method: str, params: object, id_: int | None = None) -> float:
        """Send a message; return the time directly before."""
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        body = json.dumps(message if id_ is None else {**message, "id": id_}).encode()
        stdin = self._process.stdin
        assert stdin is not None
        before = time.perf_counter()
        stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
        stdin.flush()
        return before

    def diagnostics(self, path: Path, version: int) -> tuple[float, list[dict[str, Any]]]:
        """Wait for the diagnostics of a version of a document. Return when they arrived, and the diagnostics."""
        at, message = self.wait(is_diagnostics(path, version))
        diagnostics: list[dict[str, Any]] = message["params"]["diagnostics"]
        return at, diagnostics

    def answer(self, id_: int) -> tuple[float, dict[str, Any]]:
        """Wait for the answer to a request. Return when it arrived."""
        return self.wait(is_answer(id_))

    def wait(self, predicate: Wanted) -> tuple[float, dict[str, Any]]:
        """The next message that is expected, and when it arrived. Other messages are discarded.

        Raises:
            TimeoutError: the message does not arrive.
        """
        return self.wait_for_all(predicate)[0]

    def wait_for_all(self, *predicates: Wanted) -> list[tuple[float, dict[str, Any]]]:
        """Like `wait`, for several messages in any order."""
        messages: dict[Wanted, tuple[float, dict[str, Any]]] = {}
        while len(messages) < len(predicates):
            try:
                at, message = self._answers.get(timeout=TIMEOUT_S)
            except queue.Empty:
                raise TimeoutError(
                    f"no such answer in {TIMEOUT_S} s: {listed(w.__qualname__ for w in predicates)}"
                ) from None
            for predicate in predicates:
                if predicate not in messages and predicate(message):
                    messages[predicate] = (at, message)
        return [messages[predicate] for predicate in predicates]

    def resident_memory(self) -> int | None:
        """The resident memory in bytes; `None` on systems without /proc."""
        status = Path(f"/proc/{self._process.pid}/status")
        if not status.is_file():
            return None
        rows = dict(line.split(":", 1) for line in status.read_text().splitlines())
        return int(rows["VmRSS"].split()[0]) * 1024

    def cpu_time(self) -> float:
        """The CPU time of all threads in s, with the resolution of the scheduler; 0 on systems without /proc."""
        tasks = Path(f"/proc/{self._process.pid}/task").glob("*/schedstat")
        return sum(int(task.read_text().split()[0]) for task in tasks) / 1e9

    def end(self) -> None:
        self._process.kill()
        self._process.wait()
        self._reader.join()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for at, body in _bodies(self._process.stdout):
            self._answers.put((at, json.loads(body)))


def is_answer(id_: int) -> Wanted:
    return lambda message: message.get("id") == id_ and "method" not in message


def is_diagnostics(path: Path, version: int) -> Wanted:
    """Whether a message contains the diagnostics of a version of a document."""
    uri = path.as_uri()

    def matches(message: dict[str, Any]) -> bool:
        params = message.get("params")
        return isinstance(params, dict) and (params.get("uri"), params.get("version")) == (uri, version)

    return matches


def _bodies(stream: IO[bytes]) -> Iterator[tuple[float, bytes]]:
    """The bodies of messages, each with the time at which its last byte was read."""
    length = 0
    for line in stream:
        name, _, value = line.partition(b":")
        if name.lower() == b"content-length":
            length = int(value)
        elif not line.strip():
            body = stream.read(length)
            yield time.perf_counter(), body


@contextmanager
def started(command: Sequence[str] = COMMAND) -> Iterator[Server]:
    server = Server(command)
    try:
        yield server
    finally:
        server.end()
