# SPDX-License-Identifier: Apache-2.0
"""Requests that set breakpoints. Breakpoints that a client sets before the launch are set in the model when it has been
read."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from as2fm_lsp.debug.arguments import Arguments
from as2fm_lsp.debug.session import Body, DebugSession, Handler
from roaml.debugging.breakpoints import Breakpoint, ExceptionFilter, WatchedVariable, breakpoint_of, nodes_named
from roaml.debugging.debugger import Debugger
from roaml.debugging.evaluate import WatchError
from roaml.debugging.values import SEPARATOR
from roaml.scxml.names import is_blackboard
from roaml.suggest import alternatives


class BreakpointRequests:
    """The handlers of requests about breakpoints, with the breakpoints that the client has set."""

    def __init__(self, session: DebugSession) -> None:
        self._session = session
        self._next_breakpoint = 1
        self._requested: dict[str, tuple[str, list[tuple[int, Arguments]]]] = {}
        self._functions: list[tuple[int, Arguments]] = []
        self._filters: list[tuple[str, str]] = []
        self._data: list[tuple[int, Arguments]] = []
        self.handlers: Mapping[str, Handler] = {
            "setBreakpoints": self._set_breakpoints,
            "setFunctionBreakpoints": self._set_function_breakpoints,
            "setExceptionBreakpoints": self._set_exception_breakpoints,
            "dataBreakpointInfo": self._data_breakpoint_info,
            "setDataBreakpoints": self._set_data_breakpoints,
            "breakpointLocations": self._breakpoint_locations,
        }

    def set_all(self) -> list[dict[str, Any]]:
        """Set the breakpoints that the client has requested in the model that has been read. Return the descriptions of
        breakpoints on lines, functions and data."""
        changed: list[dict[str, Any]] = []
        for path in self._requested:
            changed += self._set_lines(path)
        changed += self._set_functions()
        changed += self._set_data()
        self._set_filters()
        return changed

    def _set_breakpoints(self, arguments: Arguments) -> Body:
        path = self._session.client.path(arguments.object("source"))
        requested = arguments.objects("breakpoints")
        if not requested and arguments.has("lines"):
            requested = [Arguments({"line": line}) for line in _lines(arguments)]
        for breakpoint_ in requested:
            breakpoint_.number("line")
        self._requested[os.path.realpath(path)] = path, [(self._number(), breakpoint_) for breakpoint_ in requested]
        return {"breakpoints": self._set_lines(os.path.realpath(path))}

    def _number(self) -> int:
        self._next_breakpoint += 1
        return self._next_breakpoint - 1

    def _set_lines(self, key: str) -> list[dict[str, Any]]:
        """Set the breakpoints of a file; return their descriptions."""
        path, requested = self._requested[key]
        debugger = self._session.debugger
        if debugger is None:
            return _not_checked(requested)
        known = next(
            (known_path for known_path in debugger.places.by_path if os.path.realpath(known_path) == key), path
        )
        bodies, set_ = [], []
        for number, breakpoint_ in requested:
            body: dict[str, Any] = {"id": number, "verified": False, "source": self._session.client.source(path)}
            line = debugger.places.next_line(known, breakpoint_.number("line") + 1 - self._session.client.first_line)
            try:
                if line is None:
                    raise WatchError("neither this line nor a later one of this file is executed in this system")
                name = f"{os.path.basename(path)}:{line}"
                set_.append((line, self._breakpoint(number, name, breakpoint_)))
                body |= {"verified": True, "line": line - 1 + self._session.client.first_line}
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
        requested = arguments.objects("breakpoints")
        for breakpoint_ in requested:
            breakpoint_.text("name", None)
        self._functions = [(self._number(), breakpoint_) for breakpoint_ in requested]
        return {"breakpoints": self._set_functions()}

    def _set_functions(self) -> list[dict[str, Any]]:
        debugger = self._session.debugger
        if debugger is None:
            return _not_checked(self._functions)
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
        filters = [(name, "") for name in arguments.texts("filters")]
        filters += [
            (option.text("filterId", None), option.text("condition")) for option in arguments.objects("filterOptions")
        ]
        self._filters = filters
        return {"breakpoints": self._set_filters()}

    def _set_filters(self) -> list[dict[str, Any]]:
        bodies: list[dict[str, Any]] = []
        set_: dict[ExceptionFilter, Breakpoint] = {}
        for name, condition in self._filters:
            try:
                filter_ = next((known for known in ExceptionFilter if known.value == name), None)
                if filter_ is None:
                    known = [filter_.value for filter_ in ExceptionFilter]
                    raise WatchError(f"there is no filter `{name}`{alternatives((), known, 'filter')}")
                set_[filter_] = breakpoint_of(0, name, condition)
                bodies.append({"verified": True})
            except WatchError as error:
                bodies.append({"verified": False, "message": str(error)})
        if self._session.debugger is not None:
            self._session.debugger.breakpoints.filters = set_
            self._session.debugger.breakpoints_changed()
        return bodies

    def _data_breakpoint_info(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        name = arguments.text("name", None)
        if arguments.has("variablesReference"):
            children = self._session.children(arguments.number("variablesReference"))
            entry = next((child.entry for child in children if child.entry.name == name), None)
        else:
            entry = self._session.variable(name, arguments)
        if entry is None or entry.variable is None:
            description = f"`{name}` is neither a variable nor a blackboard entry, so it cannot be watched"
            return {"dataId": None, "description": description}
        variable = entry.variable
        owner = "" if variable.instance < 0 else debugger.session.automata[variable.instance]
        description = f"{_shown(debugger, variable)} changes"
        data = f"{owner}/{variable.name}"
        return {"dataId": data, "description": description, "accessTypes": ["write"], "canPersist": True}

    def _set_data_breakpoints(self, arguments: Arguments) -> Body:
        requested = arguments.objects("breakpoints")
        for breakpoint_ in requested:
            breakpoint_.text("dataId", None)
        self._data = [(self._number(), breakpoint_) for breakpoint_ in requested]
        return {"breakpoints": self._set_data()}

    def _set_data(self) -> list[dict[str, Any]]:
        debugger = self._session.debugger
        if debugger is None:
            return _not_checked(self._data)
        chosen: list[tuple[WatchedVariable, Breakpoint]] = []

        def add(number: int, given: Arguments) -> None:
            data = given.text("dataId")
            variable = _watched(debugger, data)
            if variable is None:
                raise WatchError(f"there is no variable `{data}`; set the breakpoint again in the variables view")
            name = f"{_shown(debugger, variable)} changes"
            chosen.append((variable, self._breakpoint(number, name, given)))

        bodies = _set_each(self._data, add)
        debugger.breakpoints.variables = chosen
        debugger.breakpoints_changed()
        return bodies

    def _breakpoint_locations(self, arguments: Arguments) -> Body:
        path = os.path.realpath(self._session.client.path(arguments.object("source")))
        offset = 1 - self._session.client.first_line
        first = arguments.number("line") + offset
        last = arguments.number("endLine", first - offset) + offset
        places = {} if self._session.debugger is None else self._session.debugger.places.by_path
        lines = next((lines for known_path, lines in places.items() if os.path.realpath(known_path) == path), [])
        chosen = [line - 1 + self._session.client.first_line for line in lines if first <= line <= last]
        return {"breakpoints": [{"line": line} for line in chosen]}


def _watched(debugger: Debugger, data: str) -> WatchedVariable | None:
    """The variable, or struct, with the name of its automaton, `/` and its own name; `None` if the model has none."""
    owner, _, name = data.partition("/")
    automata = list(debugger.session.automata)
    if owner and owner not in automata:
        return None
    watched = WatchedVariable(automata.index(owner) if owner else -1, name)
    variables = (variable for variable, _ in debugger.session.values() if variable.instance == watched.instance)
    is_known = any(variable.name == name or variable.name.startswith(f"{name}{SEPARATOR}") for variable in variables)
    return watched if is_known else None


def _shown(debugger: Debugger, variable: WatchedVariable) -> str:
    """The name of a variable in messages."""
    name = variable.name.replace(SEPARATOR, ".")
    if variable.instance < 0:
        return name
    automaton = debugger.session.automata[variable.instance]
    return f"{name} on the blackboard" if is_blackboard(automaton) else f"{debugger.session.names[automaton]}.{name}"


def _not_checked(requested: Iterable[tuple[int, Arguments]]) -> list[dict[str, Any]]:
    message = "not checked before the launch"
    return [{"id": number, "verified": False, "message": message} for number, _ in requested]


def _lines(arguments: Arguments) -> list[Any]:
    lines = arguments.members.get("lines")
    return lines if isinstance(lines, list) else []


def _set_each(
    breakpoints: Iterable[tuple[int, Arguments]], add: Callable[[int, Arguments], None]
) -> list[dict[str, Any]]:
    """Set breakpoints with their numbers; return a description of each. The description of a breakpoint that cannot be
    set contains the reason."""
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
