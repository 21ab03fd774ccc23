# SPDX-License-Identifier: Apache-2.0
"""The state that the handlers of requests share: the connection, the run that is debugged, and where it has stopped."""

from __future__ import annotations

import os
import urllib.parse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.debug.changed_files import ChangedFiles
from as2fm_lsp.debug.framing import write_message
from as2fm_lsp.debug.launch import Launch
from as2fm_lsp.debug.variables import References, Shown
from roaml.debugging.debugger import Debugger, Stop, StopReason
from roaml.debugging.evaluate import dotted, parsed
from roaml.debugging.frames import Frame
from roaml.debugging.scopes import ScopeEntry
from roaml.disk import is_valid_path
from roaml.jani.node import Origin
from roaml.record import Record

Body = Mapping[str, Any] | None
Handler = Callable[[Arguments], Body]


class MessageWriter:
    """Numbers and sends messages."""

    def __init__(self, output: BinaryIO) -> None:
        self._output = output
        self._sequence = 0

    def send(self, message: dict[str, Any]) -> None:
        self._sequence += 1
        write_message(self._output, {"seq": self._sequence, **message})

    def event(self, event: str, body: Body = None) -> None:
        self.send({"type": "event", "event": event, **({} if body is None else {"body": body})})

    def is_broken(self, error: Exception) -> bool:
        """Whether an error means that the client has closed the connection."""
        return isinstance(error, (BrokenPipeError, ConnectionError)) or self._output.closed


class ClientFormat(Record, frozen=True):
    """How the client counts lines and columns and writes paths, and what it can show.

    Attributes:
        first_line: the number of the first line, 0 or 1.
        first_column: the number of the first column, 0 or 1.
        uses_uris: whether paths are URIs.
        shows_progress: whether the client shows the progress of requests.
    """

    first_line: int = 1
    first_column: int = 1
    uses_uris: bool = False
    shows_progress: bool = False

    def path(self, source: Arguments) -> str:
        """The absolute path of a `Source`.

        Raises:
            RequestError: the source has no path, or the path is not valid.
        """
        path = source.text("path", None)
        if path.startswith("file:"):
            path = urllib.parse.unquote(urllib.parse.urlsplit(path).path)
            path = path[1:] if os.name == "nt" else path
        if not is_valid_path(path):
            raise RequestError("`path` is not a path")
        return os.path.abspath(path)

    def source(self, path: str) -> dict[str, Any]:
        """The `Source` of a path."""
        return {"name": os.path.basename(path), "path": Path(path).as_uri() if self.uses_uris else path}


class DebugSession:
    """The run that is debugged, and the frames and variables that the client knows.

    Attributes:
        debugger: the run; `None` before the launch and after `terminate`.
        launch: the arguments of the last launch.
        has_begun: whether the first position of the run has been reported to the client.
        stop: the last stop of the run.
        frames: the frames that the client knows, by their numbers.
        references: the variables that the client may open.
        changed_files: the files of the system that have changed since the launch.
        after: the actions to take after the response to the current request.
    """

    def __init__(self, connection: MessageWriter) -> None:
        self.connection = connection
        self.client = ClientFormat()
        self.debugger: Debugger | None = None
        self.launch: Launch | None = None
        self.has_begun = False
        self.stop: Stop | None = None
        self.frames: dict[int, Frame] = {}
        self.references = References()
        self.changed_files = ChangedFiles(())
        self.after: list[Callable[[], None]] = []

    @property
    def loaded(self) -> Debugger:
        """The run, moving or stopped.

        Raises:
            RequestError: there is no run.
        """
        if self.debugger is None:
            raise RequestError("no run has been launched; send `launch` first")
        return self.debugger

    @property
    def stopped(self) -> Debugger:
        """The run, if it is stopped.

        Raises:
            RequestError: there is no run, or it has not begun, or it is moving.
        """
        debugger = self.loaded
        if not self.has_begun:
            raise RequestError("the run has not begun; send `configurationDone` first")
        if debugger.is_moving:
            raise RequestError("the run is moving; pause it first")
        return debugger

    def report(self, stop: Stop) -> None:
        """Report to the client that the run has stopped, and which files have changed since the launch."""
        self.stop = stop
        self.forget()
        for path in self.changed_files.take():
            self.log(f"{path} has changed since it was read; restart to debug the new version")
        body: dict[str, Any] = {"reason": stop.reason.value, "threadId": stop.thread, "allThreadsStopped": True}
        if stop.text:
            what, details = self.stopped.explanation(stop)
            body["text"] = "\n".join((what, *details))
            if stop.filter is not None:
                body["description"] = stop.text[0].upper() + stop.text[1:]
            elif stop.reason is not StopReason.EXCEPTION:
                body["description"] = f"Paused: {stop.text}"
            if details:
                self.log("\n    ".join((what, *details)), None if stop.cause is None else stop.cause.origin)
        if stop.breakpoints:
            body["hitBreakpointIds"] = list(stop.breakpoints)
        self.connection.event("stopped", body)

    def report_later(self, stop: Stop) -> None:
        """Report to the client that the run has stopped, after the response to the current request."""
        self.after.append(lambda: self.report(stop))

    def log(self, text: str, origin: Origin | None = None) -> None:
        """Write a line to the console of the client."""
        self.connection.event("output", {"category": "stdout", "output": f"{text}\n", **self.where(origin)})

    # ------------------------------------------------------------ valid while the run is stopped

    def forget(self) -> None:
        """Discard the frames and variables that the client knows. They are valid only while the run is stopped."""
        self.frames = {}
        self.references = References()

    def frame(self, arguments: Arguments) -> Frame:
        """The frame with the number that the client sends.

        Raises:
            RequestError: there is no such frame.
        """
        number = arguments.number("frameId")
        if number not in self.frames:
            raise RequestError(f"there is no frame {number}; frames are valid only until the run continues")
        return self.frames[number]

    def variable(self, expression: str, arguments: Arguments) -> ScopeEntry | None:
        """The variable or blackboard entry that an expression denotes in the frame of a request, if it has one; `None`
        if there is none.

        Raises:
            RequestError: there is no such frame.
            WatchError: the text is not an expression.
        """
        frame = self.frame(arguments) if arguments.has("frameId") else None
        path = dotted(parsed(expression))
        return None if path is None else self.stopped.values.entry(path, frame)

    def children(self, reference: int) -> list[Shown]:
        """The variables that a reference denotes.

        Raises:
            RequestError: there is no such reference.
        """
        children = self.references.children(reference)
        if children is None:
            raise RequestError(
                f"there are no variables with the reference {reference}; it is valid only until the run continues"
            )
        return list(children)

    def where(self, origin: Origin | None) -> dict[str, Any]:
        """`source`, `line` and `column` of a place; empty if it is not in a file."""
        place = None if self.debugger is None else self.debugger.sources.place(origin)
        if place is None:
            return {}
        return {
            "source": self.client.source(place.path),
            "line": place.line - 1 + self.client.first_line,
            "column": place.column - 1 + self.client.first_column,
        }
