# SPDX-License-Identifier: Apache-2.0
"""A session of the debug adapter: answers requests, moves the run, and reports where it stops.

Requests are handled one after the other, in the order in which they arrive. While the run is moving, it is moved in
small portions, and requests are handled between them. Any request may arrive at any time: one that is not possible is
answered with the reason.
"""

from __future__ import annotations

import functools
import os
import urllib.parse
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.debug.capabilities import CAPABILITIES
from as2fm_lsp.debug.framing import Message, MessageReader, write_message
from as2fm_lsp.debug.launch import Launch, launch_of, load
from as2fm_lsp.debug.variables import References, Shown
from roaml.debugging.breakpoints import Breakpoint, ExceptionFilter, WatchedVariable, breakpoint_of, nodes_named
from roaml.debugging.debugger import Debugger, Stop, StopReason, Unit
from roaml.debugging.evaluate import WatchError, evaluate, parsed
from roaml.debugging.frames import Frame
from roaml.debugging.scopes import ScopeEntries, ScopeEntry
from roaml.debugging.values import shown, type_of
from roaml.jani.node import Origin
from roaml.simulation.choices import Choice
from roaml.smc.fault import FaultError

Body = Mapping[str, Any] | None
_ENDING = ("disconnect", "terminate")


class Adapter:
    """
    Args:
        inbox: the requests.
        output: receives responses and events.
    """

    def __init__(self, inbox: MessageReader, output: BinaryIO) -> None:
        self._inbox = inbox
        self._output = output
        self._sequence = 0
        self._first_line = self._first_column = 1
        self._uses_uris = False
        self._debugger: Debugger | None = None
        self._launch: Launch | None = None
        self._is_configured = False
        self._has_begun = False
        self._has_ended = False
        self._stop: Stop | None = None
        self._frames: dict[int, Frame] = {}
        self._references = References()
        self._data: dict[str, WatchedVariable] = {}
        self._next_breakpoint = 1
        self._wanted: dict[str, tuple[str, list[tuple[int, Arguments]]]] = {}
        self._functions: list[tuple[int, Arguments]] = []
        self._filters: list[tuple[str, str]] = []
        self._after: list[Callable[[], None]] = []
        self._handlers: dict[str, Callable[[Arguments], Body]] = {
            "initialize": self._initialize,
            "launch": self._launch_request,
            "attach": self._attach,
            "configurationDone": self._configuration_done,
            "restart": self._restart,
            "disconnect": self._end,
            "terminate": self._terminate,
            "cancel": self._cancel,
            "threads": self._threads,
            "stackTrace": self._stack_trace,
            "scopes": self._scopes,
            "variables": self._variables,
            "evaluate": self._evaluate,
            "exceptionInfo": self._exception_info,
            "loadedSources": self._loaded_sources,
            "source": self._source_request,
            "continue": self._continue,
            "next": self._next,
            "stepIn": self._step_in,
            "stepOut": self._step_out,
            "stepBack": self._step_back,
            "reverseContinue": self._reverse_continue,
            "pause": self._pause,
            "restartFrame": self._restart_frame,
            "goToStep": self._go_to_step,
            "choices": self._choices,
            "choose": self._choose,
            "saveSession": self._save_session,
            "setBreakpoints": self._set_breakpoints,
            "setFunctionBreakpoints": self._set_function_breakpoints,
            "setExceptionBreakpoints": self._set_exception_breakpoints,
            "dataBreakpointInfo": self._data_breakpoint_info,
            "setDataBreakpoints": self._set_data_breakpoints,
            "breakpointLocations": self._breakpoint_locations,
        }

    def run(self) -> None:
        """Handle requests until the session or the stream ends."""
        try:
            while not self._has_ended and not self._inbox.has_ended:
                is_moving = self._debugger is not None and self._debugger.is_moving
                message = self._inbox.take(waits=not is_moving)
                if message is not None:
                    self._handle(message)
                elif self._debugger is not None and is_moving:
                    self._advance(self._debugger)
        except (OSError, ValueError) as error:
            if not self._is_broken(error):
                raise

    def _is_broken(self, error: Exception) -> bool:
        """Whether nobody reads the output any more."""
        return isinstance(error, (BrokenPipeError, ConnectionError)) or self._output.closed

    # ------------------------------------------------------------ messages

    def _send(self, message: dict[str, Any]) -> None:
        self._sequence += 1
        write_message(self._output, {"seq": self._sequence, **message})

    def _event(self, event: str, body: Body = None) -> None:
        self._send({"type": "event", "event": event, **({} if body is None else {"body": body})})

    def _handle(self, message: Message) -> None:
        command, sequence = message.get("command"), message.get("seq")
        if message.get("type") != "request" or not isinstance(command, str):
            return
        number = sequence if isinstance(sequence, int) and not isinstance(sequence, bool) else 0
        response: dict[str, Any] = {"type": "response", "request_seq": number, "command": command}
        self._after = []
        try:
            handler = self._handlers.get(command)
            if handler is None:
                raise RequestError(f"unknown request `{command}`")
            body = handler(Arguments(message.get("arguments")))
        except (RequestError, WatchError) as error:
            text = str(error)
            details = {"id": 1, "format": _escaped(text), "showUser": command in ("launch", "restart")}
            self._send({**response, "success": False, "message": text, "body": {"error": details}})
            return
        self._send({**response, "success": True, **({} if body is None else {"body": body})})
        for action in self._after:
            action()

    def _log(self, text: str, origin: Origin | None = None, category: str = "console") -> None:
        body: dict[str, Any] = {"category": category, "output": f"{text}\n", **self._where(origin)}
        self._event("output", body)

    # ------------------------------------------------------------ begin and end

    def _initialize(self, arguments: Arguments) -> Body:
        self._first_line = int(arguments.flag("linesStartAt1", True))
        self._first_column = int(arguments.flag("columnsStartAt1", True))
        self._uses_uris = arguments.text("pathFormat") == "uri"
        return CAPABILITIES

    def _launch_request(self, arguments: Arguments) -> Body:
        if self._debugger is not None:
            raise RequestError("a run has already been launched; use `restart`")
        self._load(launch_of(arguments))
        self._after.append(lambda: self._event("initialized"))
        if self._is_configured:
            self._after.append(self._begin)
        return None

    def _attach(self, arguments: Arguments) -> Body:
        raise RequestError("a model cannot be attached to; use `launch`")

    def _load(self, launch: Launch) -> None:
        self._debugger = load(launch, self._log_point, self._is_cancelled)
        self._launch = launch
        self._stop = None
        self._forget()
        changed: list[dict[str, Any]] = []
        for path in self._wanted:
            changed += self._set_lines(path)
        changed += self._set_functions()
        self._after.append(functools.partial(self._announce, changed))
        self._set_filters()

    def _announce(self, breakpoints: list[dict[str, Any]]) -> None:
        for breakpoint_ in breakpoints:
            self._event("breakpoint", {"reason": "changed", "breakpoint": breakpoint_})

    def _log_point(self, text: str, origin: Origin | None) -> None:
        self._log(text, origin)

    def _is_cancelled(self) -> bool:
        return self._inbox.has(lambda message: message.get("command") in (*_ENDING, "cancel"))

    def _configuration_done(self, arguments: Arguments) -> Body:
        self._is_configured = True
        if self._debugger is not None and not self._has_begun:
            self._after.append(self._begin)
        return None

    def _begin(self) -> None:
        debugger, launch = self._debugger, self._launch
        if debugger is None or launch is None:
            return
        self._has_begun = True
        session = debugger.session
        self._log(f"{os.path.basename(launch.program)}: seed {session.seed}, trace {session.trace}, "
            f"property {session.asked.question.name}")  # fmt: skip
        if launch.stops_on_entry:
            self._report(debugger.entry())
        else:
            debugger.begin(Unit.END, stops_here=True)

    def _restart(self, arguments: Arguments) -> Body:
        if self._launch is None:
            raise RequestError("no run has been launched")
        given = arguments.object("arguments")
        launch = launch_of(given) if given.has("program") else self._launch
        self._has_begun = False
        self._load(launch)
        if self._is_configured:
            self._after.append(self._begin)
        return None

    def _end(self, arguments: Arguments) -> Body:
        self._has_ended = True
        return None

    def _terminate(self, arguments: Arguments) -> Body:
        self._settle()
        self._debugger = None
        self._after.append(lambda: self._event("terminated"))
        return None

    def _cancel(self, arguments: Arguments) -> Body:
        return None

    # ------------------------------------------------------------ the run

    @property
    def _loaded(self) -> Debugger:
        if self._debugger is None:
            raise RequestError("no run has been launched")
        return self._debugger

    @property
    def _stopped(self) -> Debugger:
        debugger = self._loaded
        if not self._has_begun:
            raise RequestError("the run has not begun; `configurationDone` is missing")
        if debugger.is_moving:
            raise RequestError("the run is moving; pause it first")
        return debugger

    def _settle(self) -> None:
        if self._debugger is not None and self._debugger.is_moving:
            self._debugger.interrupt()

    def _advance(self, debugger: Debugger) -> None:
        stop = debugger.advance()
        if stop is not None:
            self._report(stop)

    def _report(self, stop: Stop) -> None:
        self._stop = stop
        self._forget()
        body: dict[str, Any] = {"reason": stop.reason.value, "threadId": stop.thread, "allThreadsStopped": True}
        if stop.text:
            body["text"] = stop.text
            if stop.reason is not StopReason.EXCEPTION:
                body["description"] = f"Paused: {stop.text}"
        if stop.breakpoints:
            body["hitBreakpointIds"] = list(stop.breakpoints)
        self._event("stopped", body)

    def _forget(self) -> None:
        """Frames and variables are valid only while the run is stopped."""
        self._frames = {}
        self._references = References()

    def _moving(self, unit: Unit, *, forwards: bool = True) -> Callable[[Arguments], Body]:
        def move(arguments: Arguments) -> Body:
            self._stopped.begin(unit, forwards=forwards)
            return None

        return move

    def _continue(self, arguments: Arguments) -> Body:
        self._stopped.begin(Unit.END)
        return {"allThreadsContinued": True}

    def _next(self, arguments: Arguments) -> Body:
        return self._moving(Unit.TURN)(arguments)

    def _step_in(self, arguments: Arguments) -> Body:
        return self._moving(Unit.STEP)(arguments)

    def _step_out(self, arguments: Arguments) -> Body:
        return self._moving(Unit.TICK)(arguments)

    def _step_back(self, arguments: Arguments) -> Body:
        return self._moving(Unit.STEP, forwards=False)(arguments)

    def _reverse_continue(self, arguments: Arguments) -> Body:
        return self._moving(Unit.END, forwards=False)(arguments)

    def _pause(self, arguments: Arguments) -> Body:
        debugger = self._loaded
        if debugger.is_moving:
            stop = debugger.interrupt()
            self._after.append(lambda: self._report(stop))
        return None

    def _report_later(self, stop: Stop) -> None:
        self._after.append(lambda: self._report(stop))

    def _restart_frame(self, arguments: Arguments) -> Body:
        debugger = self._stopped
        self._report_later(debugger.restart_frame(self._frame(arguments)))
        return None

    def _go_to_step(self, arguments: Arguments) -> Body:
        debugger = self._stopped
        self._report_later(debugger.go_to(arguments.natural("step")))
        return {"step": debugger.session.position}

    def _choices(self, arguments: Arguments) -> Body:
        debugger = self._stopped
        session = debugger.session
        end = session.end
        upcoming = debugger.upcoming()
        return {
            "step": session.position,
            "time": session.time,
            "seed": session.seed,
            "trace": session.trace,
            "property": session.asked.question.name,
            "verdicts": debugger.verdicts,
            "isByHand": session.is_by_hand,
            "end": None if end is None else end.text,
            "fault": None if debugger.fault is None else debugger.fault.message,
            "choices": [
                {**self._choice(choice), "isNext": upcoming is not None and _is_choice(debugger, choice)}
                for choice in ([] if end is not None else session.choices())
            ],
        }

    def _choice(self, choice: Choice) -> dict[str, Any]:
        outcomes = [
            {"number": number, "text": outcome.text, "probability": outcome.probability}
            for number, outcome in enumerate(choice.outcomes, 1)
        ]
        text = {"number": choice.number, "text": choice.text, "probability": choice.probability}
        return {**text, "outcomes": outcomes, **self._where(choice.origin)}

    def _choose(self, arguments: Arguments) -> Body:
        debugger = self._stopped
        number, drawn = arguments.number("choice"), arguments.natural("outcome", 0)
        choice = next((each for each in debugger.session.choices() if each.number == number), None)
        if debugger.session.end is not None or choice is None:
            raise RequestError(f"there is no choice {number} in this state")
        if drawn > len(choice.outcomes):
            raise RequestError(f"choice {number} has no outcome {drawn}")
        try:
            stop = debugger.choose(choice, choice.outcomes[drawn - 1] if drawn else None)
        except FaultError as fault:
            raise RequestError(fault.message) from None
        self._report_later(stop)
        return {"step": debugger.session.position}

    def _save_session(self, arguments: Arguments) -> Body:
        return {"session": self._stopped.session.save().to_json()}

    # ------------------------------------------------------------ the state

    def _threads(self, arguments: Arguments) -> Body:
        threads = () if self._debugger is None else self._debugger.threads
        return {"threads": [{"id": thread.number, "name": thread.name} for thread in threads]}

    def _stack_trace(self, arguments: Arguments) -> Body:
        debugger = self._stopped
        thread = arguments.number("threadId")
        if all(each.number != thread for each in debugger.threads):
            raise RequestError(f"there is no thread {thread}")
        frames = debugger.stack(thread)
        first, levels = arguments.natural("startFrame", 0), arguments.natural("levels", 0)
        chosen = frames[first : first + levels] if levels else frames[first:]
        return {"stackFrames": [self._stack_frame(frame) for frame in chosen], "totalFrames": len(frames)}

    def _stack_frame(self, frame: Frame) -> dict[str, Any]:
        number = len(self._frames) + 1
        self._frames[number] = frame
        where = {"line": 0, "column": 0, **self._where(frame.origin)}
        return {"id": number, "name": frame.name, **where, "canRestart": True}

    def _frame(self, arguments: Arguments) -> Frame:
        number = arguments.number("frameId")
        if number not in self._frames:
            raise RequestError(f"there is no frame {number}")
        return self._frames[number]

    def _scopes(self, arguments: Arguments) -> Body:
        debugger = self._stopped
        frame = self._frame(arguments)
        before = {} if debugger.before is None else _by_name(debugger.before.scopes(frame))
        scopes = []
        for scope in debugger.values.scopes(frame):
            entries = [Shown(entry, before.get((scope.name, entry.name))) for entry in scope.entries]
            hint = {"presentationHint": scope.hint} if scope.hint in ("locals", "arguments") else {}
            reference = self._references.add(entries)
            scopes.append({"name": scope.name, "variablesReference": reference, "expensive": False,
                "namedVariables": len(entries), **hint})  # fmt: skip
        return {"scopes": scopes}

    def _variables(self, arguments: Arguments) -> Body:
        self._stopped  # noqa: B018 - raises an error while the run is moving
        children = self._children(arguments.number("variablesReference"))
        kind = arguments.text("filter")
        if kind in ("indexed", "named"):
            children = [child for child in children if child.entry.name.startswith("[") == (kind == "indexed")]
        first, count = arguments.natural("start", 0), arguments.natural("count", 0)
        chosen = children[first : first + count] if count else children[first:]
        return {"variables": [self._references.variable(child) for child in chosen]}

    def _children(self, reference: int) -> list[Shown]:
        children = self._references.children(reference)
        if children is None:
            raise RequestError(f"there are no variables with the reference {reference}")
        return list(children)

    def _evaluate(self, arguments: Arguments) -> Body:
        debugger = self._stopped
        text = arguments.text("expression", None)
        frame = self._frame(arguments) if arguments.has("frameId") else None
        value = evaluate(parsed(text), debugger.values.names(frame))
        entry = ScopeEntry(text, value, expression=text)
        body: dict[str, Any] = {"result": shown(value), "type": type_of(value)}
        body["variablesReference"] = self._references.of_value(value, entry, None)
        if isinstance(value, list):
            body["indexedVariables"] = len(value)
        return body

    def _exception_info(self, arguments: Arguments) -> Body:
        self._stopped  # noqa: B018
        stop = self._stop
        if stop is None or stop.reason is not StopReason.EXCEPTION:
            raise RequestError("the run has not stopped at an exception")
        return {"exceptionId": stop.filter, "description": stop.text, "breakMode": "always"}

    def _loaded_sources(self, arguments: Arguments) -> Body:
        debugger = self._debugger
        files = () if debugger is None else debugger.sources.target.files
        return {"sources": [self._source(path) for path in files]}

    def _source_request(self, arguments: Arguments) -> Body:
        raise RequestError("all sources are files")

    # ------------------------------------------------------------ breakpoints

    def _set_breakpoints(self, arguments: Arguments) -> Body:
        path = self._path(arguments.object("source"))
        wanted = arguments.objects("breakpoints")
        if not wanted and arguments.has("lines"):
            wanted = [Arguments({"line": line}) for line in _lines(arguments)]
        for each in wanted:
            each.number("line")
        self._wanted[os.path.realpath(path)] = path, [(self._number(), each) for each in wanted]
        return {"breakpoints": self._set_lines(os.path.realpath(path))}

    def _number(self) -> int:
        self._next_breakpoint += 1
        return self._next_breakpoint - 1

    def _set_lines(self, key: str) -> list[dict[str, Any]]:
        """Set the breakpoints of a file; returns their descriptions."""
        path, wanted = self._wanted[key]
        debugger = self._debugger
        if debugger is None:
            message = "not checked before the launch"
            return [{"id": number, "verified": False, "message": message} for number, _ in wanted]
        known = next((each for each in debugger.places.by_path if os.path.realpath(each) == key), path)
        bodies, set_ = [], []
        for number, each in wanted:
            body: dict[str, Any] = {"id": number, "verified": False, "source": self._source(path)}
            line = debugger.places.next_line(known, each.number("line") + 1 - self._first_line)
            try:
                if line is None:
                    raise WatchError("no line from here on is executed in this system")
                name = f"{os.path.basename(path)}:{line}"
                set_.append((line, self._breakpoint(number, name, each)))
                body |= {"verified": True, "line": line - 1 + self._first_line}
            except WatchError as error:
                body["message"] = str(error)
            bodies.append(body)
        debugger.breakpoints.lines[known] = set_
        debugger.breakpoints_changed()
        return bodies

    def _breakpoint(self, number: int, name: str, given: Arguments) -> Breakpoint:
        condition, hits = given.text("condition"), given.text("hitCondition")
        return breakpoint_of(number, name, condition, hits, given.text("logMessage"))

    def _set_function_breakpoints(self, arguments: Arguments) -> Body:
        wanted = arguments.objects("breakpoints")
        for each in wanted:
            each.text("name", None)
        self._functions = [(self._number(), each) for each in wanted]
        return {"breakpoints": self._set_functions()}

    def _set_functions(self) -> list[dict[str, Any]]:
        debugger = self._debugger
        if debugger is None:
            message = "not checked before the launch"
            return [{"id": number, "verified": False, "message": message} for number, _ in self._functions]
        chosen: list[tuple[str, Breakpoint]] = []

        def add(number: int, given: Arguments) -> None:
            name = given.text("name")
            if not debugger.session.has_event(name) and not nodes_named(debugger.sources, name):
                raise WatchError(f"there is no topic, service, action, event or node `{name}`")
            chosen.append((name, self._breakpoint(number, name, given)))

        bodies = _set_each(self._functions, add)
        debugger.breakpoints.names = chosen
        debugger.breakpoints_changed()
        return bodies

    def _set_exception_breakpoints(self, arguments: Arguments) -> Body:
        wanted = [(name, "") for name in arguments.texts("filters")]
        wanted += [(each.text("filterId", None), each.text("condition")) for each in arguments.objects("filterOptions")]
        self._filters = wanted
        return {"breakpoints": self._set_filters()}

    def _set_filters(self) -> list[dict[str, Any]]:
        bodies: list[dict[str, Any]] = []
        set_: dict[ExceptionFilter, Breakpoint] = {}
        for name, condition in self._filters:
            try:
                filter_ = next((each for each in ExceptionFilter if each.value == name), None)
                if filter_ is None:
                    raise WatchError(f"there is no filter `{name}`")
                set_[filter_] = breakpoint_of(0, name, condition)
                bodies.append({"verified": True})
            except WatchError as error:
                bodies.append({"verified": False, "message": str(error)})
        if self._debugger is not None:
            self._debugger.breakpoints.filters = set_
            self._debugger.breakpoints_changed()
        return bodies

    def _data_breakpoint_info(self, arguments: Arguments) -> Body:
        self._stopped  # noqa: B018
        name = arguments.text("name", None)
        children: list[Shown] = []
        if arguments.has("variablesReference"):
            children = self._children(arguments.number("variablesReference"))
        entry = next((child.entry for child in children if child.entry.name == name), None)
        if entry is None or entry.variable is None:
            return {"dataId": None, "description": f"`{name}` is not a variable that can be watched"}
        variable = entry.variable
        owner = "" if variable.instance < 0 else f"{self._loaded.session.automata[variable.instance]}/"
        data = f"{owner}{variable.name}"
        self._data[data] = variable
        return {"dataId": data, "description": f"{name} changes", "accessTypes": ["write"], "canPersist": True}

    def _set_data_breakpoints(self, arguments: Arguments) -> Body:
        debugger = self._loaded
        chosen: list[tuple[WatchedVariable, Breakpoint]] = []

        def add(number: int, given: Arguments) -> None:
            data = given.text("dataId", None)
            variable = self._variable(debugger, data)
            if variable is None:
                raise WatchError(f"there is no variable `{data}`")
            chosen.append((variable, self._breakpoint(number, f"{data} changes", given)))

        numbered = [(self._number(), given) for given in arguments.objects("breakpoints")]
        bodies = _set_each(numbered, add)
        debugger.breakpoints.variables = chosen
        debugger.breakpoints_changed()
        return {"breakpoints": bodies}

    def _variable(self, debugger: Debugger, data: str) -> WatchedVariable | None:
        if data in self._data:
            return self._data[data]
        owner, _, name = data.rpartition("/")
        automata = list(debugger.session.automata)
        if owner in automata and name:
            return WatchedVariable(automata.index(owner), name)
        return WatchedVariable(-1, name) if not owner and name else None

    def _breakpoint_locations(self, arguments: Arguments) -> Body:
        path = os.path.realpath(self._path(arguments.object("source")))
        first = arguments.number("line") + 1 - self._first_line
        last = arguments.number("endLine", first - 1 + self._first_line) + 1 - self._first_line
        places = {} if self._debugger is None else self._debugger.places.by_path
        lines = next((lines for each, lines in places.items() if os.path.realpath(each) == path), [])
        chosen = [line - 1 + self._first_line for line in lines if first <= line <= last]
        return {"breakpoints": [{"line": line} for line in chosen]}

    # ------------------------------------------------------------ places

    def _path(self, source: Arguments) -> str:
        path = source.text("path", None)
        if path.startswith("file:"):
            path = urllib.parse.unquote(urllib.parse.urlsplit(path).path)
            path = path[1:] if os.name == "nt" else path
        if "\0" in path:
            raise RequestError("`path` is not a path")
        return os.path.abspath(path)

    def _source(self, path: str) -> dict[str, Any]:
        shown_path = Path(path).as_uri() if self._uses_uris else path
        return {"name": os.path.basename(path), "path": shown_path}

    def _where(self, origin: Origin | None) -> dict[str, Any]:
        debugger = self._debugger
        place = None if debugger is None else debugger.sources.place(origin)
        if place is None or origin is None or debugger is None:
            return {}
        return {
            "source": self._source(place.path),
            "line": place.line - 1 + self._first_line,
            "column": place.column - 1 + self._first_column,
        }


def _by_name(scopes: list[ScopeEntries]) -> dict[tuple[str, str], Any]:
    return {(scope.name, entry.name): entry.value for scope in scopes for entry in scope.entries}


def _lines(arguments: Arguments) -> list[Any]:
    lines = arguments.members.get("lines")
    return lines if isinstance(lines, list) else []


def _escaped(text: str) -> str:
    """A text as the format of an error, in which braces are placeholders."""
    return text.replace("{", "(").replace("}", ")")


def _is_choice(debugger: Debugger, choice: Choice) -> bool:
    """Whether the next step takes a choice, unless another one is taken by hand."""
    step = debugger.upcoming()
    taken = [] if step is None else [part.automaton for part in step.parts]
    return step is not None and set(taken) == set(choice.automata)


def _set_each(
    breakpoints: Iterable[tuple[int, Arguments]], add: Callable[[int, Arguments], None]
) -> list[dict[str, Any]]:
    """Set breakpoints with their numbers; returns a description of each. One that cannot be set has the reason."""
    bodies = []
    for number, given in breakpoints:
        body: dict[str, Any] = {"id": number, "verified": False}
        try:
            add(number, given)
            body["verified"] = True
        except WatchError as error:
            body["message"] = str(error)
        bodies.append(body)
    return bodies
