# SPDX-License-Identifier: Apache-2.0
"""Random requests to the debug adapter in any order, with sensible and senseless arguments."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

MOVING = ("continue", "next", "stepIn", "stepOut", "stepBack", "reverseContinue")
STOPPING = ("goToStep", "choose", "restartFrame", "publish", "setVariable", "setExpression")
OTHERS = (
    *("initialize", "launch", "configurationDone", "threads", "stackTrace", "scopes", "variables", "evaluate", "pause"),
    *("setBreakpoints", "setFunctionBreakpoints", "setExceptionBreakpoints", "setDataBreakpoints", "choices", "cancel"),
    *("timeline", "exportTimeline", "pictures", "moments", "properties"),
    *("dataBreakpointInfo", "breakpointLocations", "loadedSources", "exceptionInfo", "saveSession", "restart"),
    *("source", "attach", "nothing", "modules", "events", "completions"),
)
NAMES = ("threadId", "frameId", "variablesReference", "step", "choice", "outcome", "line", "name", "dataId", "seed")
LISTS = ("breakpoints", "filters", "filterOptions", "lines")
EXPRESSIONS = (
    *("Arm.way", "holding", "way + 1", "_msg.data", "1 / 0", "(", "", "time > 3", "[1, 2][5]", "{", "'x' < 3"),
    *("publish /arm/command {data: 2}", "publish /arm/command", "call /x {", "publish /arm/command {data: [1]}"),
)
EVENTS = ("/arm/command", "/arm/gripper", "topic_arm__command_msg", "/nothing", "/level", "/block/placed")
FIELDS = (
    *({}, {"data": 1}, {"data": True}, {"data": 300}, {"data": "x"}, {"x": 1}, {"data": [1]}),
    *("{data: 2}", "{", 5, [1]),
)
COMMANDS = ("publish ", "publish /arm", "pub", "call /", "", "x", "publish /arm/command {data: 2}")


class Requests:
    """A source of random requests for a system."""

    def __init__(self, seed: int, program: Path) -> None:
        self._random = random.Random(seed)
        self._files = [str(path) for path in program.parent.rglob("*") if path.is_file()]
        self._program = str(program)

    def next(self) -> tuple[str, dict[str, Any]]:
        draw = self._random
        kind = draw.random()
        command = draw.choice(MOVING if kind < 0.3 else STOPPING if kind < 0.45 else OTHERS)
        arguments = {name: self._value() for name in NAMES if draw.random() < 0.6}
        arguments |= {name: self._list() for name in LISTS if draw.random() < 0.3}
        if draw.random() < 0.9:
            arguments["source"] = {"path": draw.choice(self._files)}
        if draw.random() < 0.8:
            arguments["program"] = self._program
            arguments.pop("seed", None)
        if draw.random() < 0.8:
            arguments["event"] = draw.choice(EVENTS)
            arguments["fields"] = draw.choice(FIELDS)
            arguments["value"] = draw.choice(EXPRESSIONS)
            arguments["text"] = draw.choice(COMMANDS)
            arguments["context"] = draw.choice(("repl", "watch"))
        if draw.random() < 0.8:
            arguments["expression"] = draw.choice(EXPRESSIONS)
        if draw.random() < 0.05:
            arguments = {name: self._anything() for name in (*arguments, "arguments", "session")}
        return command, arguments

    def _value(self) -> Any:
        draw = self._random
        if draw.random() < 0.9:
            return draw.choice((0, 1, 1, 1, 2, 2, 3, 4, 7, 20, draw.randrange(400)))
        return self._anything()

    def _anything(self) -> Any:
        values = (
            None,
            True,
            -1,
            0.5,
            1e300,
            2**70,
            "",
            "x",
            "\ud800",
            "\0",
            [],
            [[]],
            {},
            {"a": None},
            "../..",
            [1, "x"],
        )
        return self._random.choice(values)

    def _list(self) -> list[Any]:
        draw = self._random
        names = ("/arm/command", "PickUp", "bt_1003", "violated", "chance", "time", "Arm/way", "Arm/holding", "x")
        texts = ("way > 2", "5", "% 2", "log {way}", "", "(")
        members = {"line": draw.randrange(60), "name": draw.choice(names), "dataId": draw.choice(names)}
        members |= {
            name: draw.choice(texts) for name in ("condition", "hitCondition", "logMessage") if draw.random() < 0.2
        }
        if draw.random() < 0.1:
            return [self._anything()]
        return [{**members, "filterId": draw.choice(names)}] if draw.random() < 0.8 else [draw.choice(names)]
