# SPDX-License-Identifier: Apache-2.0
"""Requests that move the run."""

from __future__ import annotations

from collections.abc import Mapping

from as2fm_lsp.debug.arguments import Arguments
from as2fm_lsp.debug.session import Body, DebugSession, Handler
from roaml.debugging.debugger import Unit


class MovementRequests:
    """The handlers of requests that move the run."""

    def __init__(self, session: DebugSession) -> None:
        self._session = session
        self.handlers: Mapping[str, Handler] = {
            "continue": self._continue,
            "next": self._moving(Unit.TURN),
            "stepIn": self._moving(Unit.STEP),
            "stepOut": self._moving(Unit.TICK),
            "stepBack": self._moving(Unit.STEP, forwards=False),
            "reverseContinue": self._moving(Unit.END, forwards=False),
            "pause": self._pause,
            "restartFrame": self._restart_frame,
            "goToStep": self._go_to_step,
        }

    def _moving(self, unit: Unit, *, forwards: bool = True) -> Handler:
        def move(arguments: Arguments) -> Body:
            self._session.stopped.begin(unit, forwards=forwards)
            return None

        return move

    def _continue(self, arguments: Arguments) -> Body:
        self._session.stopped.begin(Unit.END)
        return {"allThreadsContinued": True}

    def _pause(self, arguments: Arguments) -> Body:
        debugger = self._session.loaded
        if debugger.is_moving:
            stop = debugger.interrupt()
            self._session.report_later(stop)
        return None

    def _restart_frame(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        self._session.report_later(debugger.restart_frame(self._session.frame(arguments)))
        return None

    def _go_to_step(self, arguments: Arguments) -> Body:
        debugger, step = self._session.stopped, arguments.natural("step")
        debugger.begin_going_to(step)
        stop = debugger.advance()
        if stop is not None:
            self._session.report_later(stop)
        else:
            thread = debugger.threads[0].number if debugger.threads else 0
            continued = {"threadId": thread, "allThreadsContinued": True}
            self._session.after.append(lambda: self._session.connection.event("continued", continued))
        return {"step": debugger.session.position}
