# SPDX-License-Identifier: Apache-2.0
"""Requests about the state in which the run has stopped: stacks, variables, expressions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.debug.by_hand import ByHandRequests, is_command
from as2fm_lsp.debug.session import Body, DebugSession, Handler
from as2fm_lsp.debug.variables import Shown
from roaml.debugging.debugger import StopReason
from roaml.debugging.evaluate import evaluate, parsed
from roaml.debugging.frames import Frame
from roaml.debugging.scopes import ScopeEntries, ScopeEntry
from roaml.debugging.values import shown, type_of


class StateRequests:
    """The handlers of requests about the state."""

    def __init__(self, session: DebugSession, by_hand: ByHandRequests) -> None:
        self._session = session
        self._by_hand = by_hand
        self.handlers: Mapping[str, Handler] = {
            "threads": self._threads,
            "stackTrace": self._stack_trace,
            "scopes": self._scopes,
            "variables": self._variables,
            "evaluate": self._evaluate,
            "exceptionInfo": self._exception_info,
            "loadedSources": self._loaded_sources,
            "source": self._source_request,
        }

    def _threads(self, arguments: Arguments) -> Body:
        threads = () if self._session.debugger is None else self._session.debugger.threads
        return {"threads": [{"id": thread.number, "name": thread.name} for thread in threads]}

    def _stack_trace(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        thread = arguments.number("threadId")
        if all(known.number != thread for known in debugger.threads):
            raise RequestError(f"there is no thread {thread}; `threads` lists them")
        frames = debugger.stack(thread, self._session.stop)
        first, levels = arguments.natural("startFrame", 0), arguments.natural("levels", 0)
        chosen = frames[first : first + levels] if levels else frames[first:]
        return {"stackFrames": [self._stack_frame(frame) for frame in chosen], "totalFrames": len(frames)}

    def _stack_frame(self, frame: Frame) -> dict[str, Any]:
        number = len(self._session.frames) + 1
        self._session.frames[number] = frame
        where = {"line": 0, "column": 0, **self._session.where(frame.origin)}
        return {"id": number, "name": frame.name, **where, "canRestart": True}

    def _scopes(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        frame = self._session.frame(arguments)
        before = {} if debugger.before is None else _by_name(debugger.before.scopes(frame))
        scopes = []
        for scope in debugger.values.scopes(frame):
            entries = [Shown(entry, before.get((scope.name, entry.name))) for entry in scope.entries]
            hint = {} if scope.hint is None else {"presentationHint": scope.hint.value}
            reference = self._session.references.add(entries)
            scopes.append({"name": scope.name, "variablesReference": reference, "expensive": False,
                "namedVariables": len(entries), **hint})  # fmt: skip
        return {"scopes": scopes}

    def _variables(self, arguments: Arguments) -> Body:
        self._session.stopped  # noqa: B018 - raises an error while the run is moving
        children = self._session.children(arguments.number("variablesReference"))
        kind = arguments.text("filter")
        if kind in ("indexed", "named"):
            children = [child for child in children if child.entry.name.startswith("[") == (kind == "indexed")]
        first, count = arguments.natural("start", 0), arguments.natural("count", 0)
        chosen = children[first : first + count] if count else children[first:]
        return {"variables": [self._session.references.variable(child) for child in chosen]}

    def _evaluate(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        text = arguments.text("expression", None)
        frame = self._session.frame(arguments) if arguments.has("frameId") else None
        if arguments.text("context") == "repl" and is_command(text):
            return {"result": self._by_hand.execute(text, frame), "variablesReference": 0}
        value = evaluate(parsed(text), debugger.values.names(frame))
        entry = ScopeEntry(text, value, expression=text)
        body: dict[str, Any] = {"result": shown(value), "type": type_of(value)}
        body["variablesReference"] = self._session.references.of_value(value, entry, None)
        if isinstance(value, list):
            body["indexedVariables"] = len(value)
        return body

    def _exception_info(self, arguments: Arguments) -> Body:
        stop = self._session.stop
        if stop is None or (stop.filter is None and stop.reason is not StopReason.EXCEPTION):
            raise RequestError("the run has not stopped at an exception")
        happened, details = self._session.stopped.explanation(stop)
        return {"exceptionId": happened, "description": "\n".join(details), "breakMode": "always"}

    def _loaded_sources(self, arguments: Arguments) -> Body:
        debugger = self._session.debugger
        files = () if debugger is None else debugger.sources.target.files
        return {"sources": [self._session.client.source(path) for path in files]}

    def _source_request(self, arguments: Arguments) -> Body:
        raise RequestError("the text of a source cannot be requested, because all sources are files")


def _by_name(scopes: list[ScopeEntries]) -> dict[tuple[str, str], Any]:
    return {(scope.name, entry.name): entry.value for scope in scopes for entry in scope.entries}
