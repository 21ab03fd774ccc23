# SPDX-License-Identifier: Apache-2.0
"""The debug adapter: reads requests, calls their handlers, moves the run, and reports where the run stops.

Requests are handled one after the other, in the order in which they arrive. The run moves in small portions, and
requests are handled between these portions. Any request may arrive at any time. The answer to a request that is not
possible states the reason.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.debug.breakpoints import BreakpointRequests
from as2fm_lsp.debug.by_hand import ByHandRequests
from as2fm_lsp.debug.capabilities import CAPABILITIES
from as2fm_lsp.debug.changed_files import ChangedFiles
from as2fm_lsp.debug.choices import ChoiceRequests
from as2fm_lsp.debug.framing import Message, PendingMessages
from as2fm_lsp.debug.launch import Launch, launch_of, load, warm_up
from as2fm_lsp.debug.movement import MovementRequests
from as2fm_lsp.debug.progress import SearchProgress
from as2fm_lsp.debug.session import Body, ClientFormat, DebugSession, Handler, MessageWriter
from as2fm_lsp.debug.state import StateRequests
from roaml.debugging.debugger import Unit
from roaml.debugging.evaluate import WatchError

if TYPE_CHECKING:
    from as2fm_lsp.debug.timeline import TimelineRequests

BESIDE_REQUESTS = ("timeline", "exportTimeline", "pictures", "moments")
"""The requests of `as2fm_lsp.debug.timeline`, which is imported on their first use."""

SHOWN_ERRORS = ("restart", "setExpression")
"""The requests whose errors a client shows to the user in a message. VS Code shows those of `setVariable` at the value.
For a failed `launch`, it would show a modal dialog that leads to launch.json: its extension shows the error instead."""


class Adapter:
    """Serves one client.

    Args:
        inbox: the requests.
        output: receives responses and events.
    """

    def __init__(self, inbox: PendingMessages, output: BinaryIO) -> None:
        self._inbox = inbox
        self._connection = MessageWriter(output)
        self._session = session = DebugSession(self._connection)
        self._breakpoints = BreakpointRequests(session)
        by_hand = ByHandRequests(session)
        self._timeline: TimelineRequests | None = None
        self._is_configured = False
        self._has_ended = False
        self._request = 0
        self._handlers: Mapping[str, Handler] = {
            "initialize": self._initialize,
            "launch": self._launch,
            "attach": self._attach,
            "configurationDone": self._configuration_done,
            "restart": self._restart,
            "disconnect": self._disconnect,
            "terminate": self._terminate,
            "cancel": self._cancel,
            **StateRequests(session, by_hand).handlers,
            **by_hand.handlers,
            **MovementRequests(session).handlers,
            **ChoiceRequests(session).handlers,
            **{name: self._beside(name) for name in BESIDE_REQUESTS},
            **self._breakpoints.handlers,
        }

    def _beside(self, name: str) -> Handler:
        def handle(arguments: Arguments) -> Body:
            from as2fm_lsp.debug.timeline import TimelineRequests  # noqa: PLC0415 - the first stop comes sooner

            if self._timeline is None:
                self._timeline = TimelineRequests(self._session)
            return self._timeline.handlers[name](arguments)

        return handle

    def run(self) -> None:
        """Handle requests until the session or the stream ends."""
        try:
            while not self._has_ended and not self._inbox.has_ended:
                debugger = self._session.debugger
                is_moving = debugger is not None and debugger.is_moving
                message = self._inbox.take(waits=not is_moving)
                if message is not None:
                    self._handle(message)
                elif debugger is not None and is_moving and (stop := debugger.advance()) is not None:
                    self._session.report(stop)
        except (OSError, ValueError) as error:
            if not self._connection.is_broken(error):
                raise

    def _handle(self, message: Message) -> None:
        command, sequence = message.get("command"), message.get("seq")
        if message.get("type") != "request" or not isinstance(command, str):
            return
        number = sequence if isinstance(sequence, int) and not isinstance(sequence, bool) else 0
        response: dict[str, Any] = {"type": "response", "request_seq": number, "command": command}
        self._session.after = []
        self._request = number
        try:
            handler = self._handlers.get(command)
            if handler is None:
                raise RequestError(f"unknown request `{command}`")
            body = handler(Arguments(message.get("arguments")))
        except (RequestError, WatchError) as error:
            text = str(error)
            details = {"id": 1, "format": _escaped(text), "showUser": command in SHOWN_ERRORS}
            self._connection.send({**response, "success": False, "message": text, "body": {"error": details}})
            return
        self._connection.send({**response, "success": True, **({} if body is None else {"body": body})})
        for action in self._session.after:
            action()

    # ------------------------------------------------------------ begin and end

    def _initialize(self, arguments: Arguments) -> Body:
        self._session.client = ClientFormat(
            int(arguments.flag("linesStartAt1", True)),
            int(arguments.flag("columnsStartAt1", True)),
            arguments.text("pathFormat") == "uri",
            arguments.flag("supportsProgressReporting"),
        )
        self._session.after.append(warm_up)
        return CAPABILITIES

    def _launch(self, arguments: Arguments) -> Body:
        if self._session.debugger is not None:
            raise RequestError("a run has already been launched; use `restart`")
        self._load(launch_of(arguments))
        self._session.after.append(lambda: self._connection.event("initialized"))
        if self._is_configured:
            self._session.after.append(self._begin)
        return None

    def _attach(self, arguments: Arguments) -> Body:
        raise RequestError("`attach` is not supported; use `launch`")

    def _load(self, launch: Launch) -> None:
        session = self._session
        gc.unfreeze()
        progress = SearchProgress(session, self._inbox, self._request)
        try:
            session.debugger = load(launch, session.log, progress)
        finally:
            progress.end()
        session.changed_files = ChangedFiles(session.debugger.sources.target.files)
        session.launch = launch
        session.has_begun = False
        session.stop = None
        session.forget()
        breakpoints = self._breakpoints.set_all()
        session.after.append(lambda: self._announce(breakpoints))
        gc.freeze()  # a collection of the objects of the model would delay a step by 80 ms

    def _announce(self, breakpoints: list[dict[str, Any]]) -> None:
        for breakpoint_ in breakpoints:
            self._connection.event("breakpoint", {"reason": "changed", "breakpoint": breakpoint_})

    def _configuration_done(self, arguments: Arguments) -> Body:
        self._is_configured = True
        if self._session.debugger is not None and not self._session.has_begun:
            self._session.after.append(self._begin)
        return None

    def _begin(self) -> None:
        debugger, launch = self._session.debugger, self._session.launch
        if debugger is None or launch is None:
            return
        self._session.has_begun = True
        run = debugger.session
        program = os.path.basename(launch.program)
        self._session.log(
            f"{program}: seed {run.seed}, trace {run.trace}, property {run.compiled_property.question.name}"
        )
        if launch.stops_on_entry:
            self._session.report(debugger.entry())
        else:
            debugger.begin(Unit.END, stops_here=True)

    def _restart(self, arguments: Arguments) -> Body:
        if self._session.launch is None:
            raise RequestError("no run has been launched; send `launch` first")
        given = arguments.object("arguments")
        launch = launch_of(given) if given.has("program") else self._session.launch
        self._load(launch)
        if self._is_configured:
            self._session.after.append(self._begin)
        return None

    def _disconnect(self, arguments: Arguments) -> Body:
        self._has_ended = True
        return None

    def _terminate(self, arguments: Arguments) -> Body:
        debugger = self._session.debugger
        if debugger is not None and debugger.is_moving:
            debugger.interrupt()
        self._session.debugger = None
        self._session.after.append(lambda: self._connection.event("terminated"))
        return None

    def _cancel(self, arguments: Arguments) -> Body:
        return None


def _escaped(text: str) -> str:
    """A text with parentheses instead of braces, because braces are placeholders in error messages of the protocol."""
    return text.replace("{", "(").replace("}", ")")
