# SPDX-License-Identifier: Apache-2.0
"""Input of the debug adapter: requests in any order, with sensible, senseless and damaged arguments. The client may die
at any time.

Each readable request is answered once, by a message that fits the schema of the protocol. The adapter ends when its
client does.
"""

from __future__ import annotations

import copy
import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from random import Random
from typing import Any

import jsonschema

from as2fm_lsp.debug.adapter import Adapter
from as2fm_lsp.debug.framing import Message, messages
from dap_schema import validate
from fuzz import limits
from fuzz.corpus import ROOT
from fuzz.debug_requests import Requests
from fuzz.strategies.frames import WAYS, frame
from fuzz.strategy import Failure, Strategy

PROGRAMS = tuple(
    ROOT / "examples" / name
    for name in ("assembly_robot/main_with_bug.xml", "assembly_robot/main.xml", "delivery_robot/main.xml")
)
REQUESTS = 50
"""The maximum number of requests of a case."""


@dataclass
class Session:
    """The input of one client.

    Attributes:
        data: the bytes that the client sends.
        damage: a description of the damage.
        survives: the number of messages that the client reads before it dies; `None` if it does not die.
    """

    seed: int
    data: bytes = b""
    damage: list[str] = field(default_factory=list)
    survives: int | None = None

    def description(self) -> Iterator[str]:
        yield "requests to the debug adapter"
        yield from self.damage
        if self.survives is not None:
            yield f"the client dies after {self.survives} messages"

    def files(self) -> Mapping[str, str | bytes]:
        return {"messages": self.data}

    def run(self) -> Iterator[Failure]:
        inbox = _Inbox(Random(self.seed), list(messages(BytesIO(self.data))))
        output = _Output(self.survives)
        Adapter(inbox, output).run()
        if self.survives is None:
            yield from _missing_answers(inbox.taken, output.getvalue())
        yield from _invalid(output.getvalue())


class _Inbox:
    """An inbox in which messages seldom arrive while a run is moving, so that it can move."""

    def __init__(self, random: Random, waiting: list[Message]) -> None:
        self._random = random
        self._waiting = waiting[::-1]
        self.taken: list[Message] = []

    def take(self, *, waits: bool) -> Message | None:
        if not self._waiting or (not waits and self._random.random() < 0.7):
            return None
        limits.restart()
        self.taken.append(self._waiting.pop())
        return self.taken[-1]

    @property
    def has_ended(self) -> bool:
        return not self._waiting

    def has(self, matches: Callable[[Message], bool]) -> bool:
        return any(map(matches, self._waiting))


class _Output(BytesIO):
    """A stream that has no reader after some messages."""

    def __init__(self, survives: int | None) -> None:
        super().__init__()
        self._left = survives

    def write(self, data: Any) -> int:
        if self._left is not None:
            self._left -= 1
            if self._left < 0:
                raise BrokenPipeError
        return super().write(data)


def _missing_answers(taken: list[Message], said: bytes) -> Iterator[Failure]:
    answers = Counter(m["command"] for m in messages(BytesIO(said)) if m["type"] == "response")
    asked = Counter(m["command"] for m in taken if m.get("type") == "request" and isinstance(m.get("command"), str))
    for command in sorted({*answers, *asked}):
        if answers[command] != asked[command]:
            details = f"{asked[command]} requests have {answers[command]} answers"
            yield Failure(f"`{command}` is not answered once", details)


def _invalid(said: bytes) -> Iterator[Failure]:
    for message in messages(BytesIO(said)):
        limits.restart()
        if message["type"] == "response" and message["request_seq"] < 1:
            continue  # the number of the request was damaged
        try:
            validate(dict(message))
        except jsonschema.ValidationError as error:
            name = message.get("command") or message.get("event")
            yield Failure(f"`{name}` does not fit the schema: {error.json_path}", f"{error.message}\n{message}"[:3000])


def make(seed: int) -> Session:
    random = Random(seed)
    case = Session(seed)
    program = random.choice(PROGRAMS)
    requests = Requests(seed, program)
    begin = [("initialize", {"adapterID": "as2fm"}), ("launch", {"program": str(program)}), ("configurationDone", {})]
    if random.random() < 0.1:
        random.shuffle(begin)
    sent = [*begin, *(requests.next() for _ in range(REQUESTS))]
    damaged = {random.randrange(len(sent)) for _ in range(random.choice([0, 0, 1, 3]))}
    parts: list[bytes] = []
    for number, (command, arguments) in enumerate(sent, 1):
        message: dict[str, Any] = {"seq": number, "type": "request", "command": command, "arguments": arguments}
        if number - 1 in damaged:
            way = random.choice(WAYS)
            case.damage.append(f"{way.__name__} in request {number}, {command}")
            parts.append(way(random, json.loads(json.dumps(copy.deepcopy(message)))))
        else:
            parts.append(frame(message))
    case.data = b"".join(parts)
    case.survives = random.randrange(60) if random.random() < 0.1 else None
    return case


STRATEGY = Strategy("debug", f"sends {REQUESTS} random requests to the debug adapter", make)
