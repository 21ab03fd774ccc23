# SPDX-License-Identifier: Apache-2.0
"""A language server as a process, spoken to over its standard input and output.

Messages are built before the clock starts, and a thread notes when each answer arrives, so that what is timed is the
server: its process, its reading and its writing.
"""

from __future__ import annotations

import json
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

COMMAND = (sys.executable, "-m", "as2fm_lsp")
PATIENCE = 60
"""Seconds to wait for an answer before giving up."""


class Server:
    """`started` is when its process was started, in seconds of `time.perf_counter`."""

    def __init__(self) -> None:
        pipe = subprocess.PIPE
        self.started = time.perf_counter()
        self._process = subprocess.Popen(COMMAND, stdin=pipe, stdout=pipe)
        self._answers: queue.Queue[tuple[float, dict[str, Any]]] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def initialize(self, folder: Path) -> None:
        folders = [{"uri": folder.as_uri(), "name": folder.name}]
        self.tell("initialize", {"processId": None, "workspaceFolders": folders, "capabilities": {}}, 1)
        self.wait(lambda message: message.get("id") == 1)
        self.tell("initialized", {})

    def open(self, path: Path, text: str) -> float:
        """Open a document; the time just before."""
        document = {"uri": path.as_uri(), "languageId": "ascxml", "version": 1, "text": text}
        return self.tell("textDocument/didOpen", {"textDocument": document})

    def change(self, path: Path, version: int, change: dict[str, Any]) -> float:
        """Tell of one change in a document; the time just before."""
        document = {"uri": path.as_uri(), "version": version}
        return self.tell("textDocument/didChange", {"textDocument": document, "contentChanges": [change]})

    def tell(self, method: str, params: object, id_: int | None = None) -> float:
        """Send a message; the time just before."""
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        body = json.dumps(message if id_ is None else {**message, "id": id_}).encode()
        stdin = self._process.stdin
        assert stdin is not None
        before = time.perf_counter()
        stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
        stdin.flush()
        return before

    def diagnostics(self, path: Path, version: int) -> tuple[float, list[dict[str, Any]]]:
        """Wait for the diagnostics of a version of a document: when they arrived, and what they are."""
        uri = path.as_uri()

        def is_it(message: dict[str, Any]) -> bool:
            params = message.get("params")
            return isinstance(params, dict) and (params.get("uri"), params.get("version")) == (uri, version)

        at, message = self.wait(is_it)
        found: list[dict[str, Any]] = message["params"]["diagnostics"]
        return at, found

    def wait(self, wanted: Callable[[dict[str, Any]], bool]) -> tuple[float, dict[str, Any]]:
        """The first message from now on that is wanted, and when it arrived; others are dropped.

        Raises:
            TimeoutError: it does not come.
        """
        while True:
            try:
                at, message = self._answers.get(timeout=PATIENCE)
            except queue.Empty:
                raise TimeoutError(f"no such answer in {PATIENCE} s: {wanted.__qualname__}") from None
            if wanted(message):
                return at, message

    def resident_memory(self) -> int | None:
        """Bytes; None where the system has no /proc."""
        status = Path(f"/proc/{self._process.pid}/status")
        if not status.is_file():
            return None
        rows = dict(line.split(":", 1) for line in status.read_text().splitlines())
        return int(rows["VmRSS"].split()[0]) * 1024

    def end(self) -> None:
        self._process.kill()
        self._process.wait()
        self._reader.join()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for at, body in _bodies(self._process.stdout):
            self._answers.put((at, json.loads(body)))


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
def started() -> Iterator[Server]:
    server = Server()
    try:
        yield server
    finally:
        server.end()
