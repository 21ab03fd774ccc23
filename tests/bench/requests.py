# SPDX-License-Identifier: Apache-2.0
"""Requests that an editor sends while a user reads and types: each request after a pause, and directly after a key.

Requests that a server does not support are not sent, and their rows are omitted.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from bench.check import SYSTEM_FILES, opened, system
from bench.generate import FIRST
from bench.keystrokes import keys, places, position
from bench.report import Benchmark, Row, listed, median, percentile, seconds
from bench.server import Server, is_answer, is_diagnostics

SESSIONS = 2
BURST = 100
"""The number of keys that are pressed without waiting for answers."""

PAUSES = (0.0, 0.01, 0.03)
"""The times in s between these keys: pasted by a terminal, faster than anybody types, a key that is held down."""

REST = 0.5
"""The time in s that a server has after its start to check the other files."""

RENAMES = 5
"""The number of renames of each symbol."""

ASKED_WHILE_TYPING = ("completion", "semantic tokens")

_ID = 1000
"""The number of the first request."""

RENAMED = (
    '<data id="here',
    'topic="/ring/topic_0',
    '<state id="state_3',
    'event="ring_0_event_1',
    'location="here.x',
    'service_name="/ring/add_0',
)
"""The renamed symbols, given by the text up to the end of the name: a variable, a topic, a state, an event, a member of
a struct that each machine uses, a service."""


class Request(NamedTuple):
    """A request of an editor.

    Attributes:
        capability: the property of the server's capabilities that declares support for the request.
        more: its parameters except the document and the position.
        whole: whether it is about a whole document.
    """

    name: str
    method: str
    capability: str
    target: str
    more: Mapping[str, Any] = MappingProxyType({})
    whole: bool = False

    def params(self, path: Path, place: dict[str, int]) -> dict[str, Any]:
        document: dict[str, Any] = {"textDocument": {"uri": path.as_uri()}, **self.more}
        return document if self.whole else {**document, "position": place}


_TEXT = "textDocument"
REQUESTS = (
    Request("completion", f"{_TEXT}/completion", "completionProvider", "< 40 ms"),
    Request("hover", f"{_TEXT}/hover", "hoverProvider", "< 40 ms"),
    Request("definition", f"{_TEXT}/definition", "definitionProvider", "< 40 ms"),
    Request(
        "references", f"{_TEXT}/references", "referencesProvider", "< 40 ms", {"context": {"includeDeclaration": True}}
    ),
    Request("semantic tokens", f"{_TEXT}/semanticTokens/full", "semanticTokensProvider", "< 60 ms", whole=True),
    Request("rename", f"{_TEXT}/rename", "renameProvider", "< 300 ms", {"newName": "fresh"}),
    Request(
        "formatting",
        f"{_TEXT}/formatting",
        "documentFormattingProvider",
        "",
        {"options": {"tabSize": 4, "insertSpaces": True}},
        whole=True,
    ),
)


def requests() -> list[Row]:
    """Each request many times, in a long machine of a system."""
    with system(SYSTEM_FILES) as folder:
        return [row for request in REQUESTS for row in asked(folder, request)]


def asked(folder: Path, request: Request) -> list[Row]:
    rested: list[float] = []
    typing: list[float] = []
    for _ in range(SESSIONS):
        with opened(folder, REST) as (server, text):
            if request.capability not in server.capabilities:
                return []
            rested += idle_times(server, folder / FIRST, text, request)
            typing += behind_keys(server, folder / FIRST, text, request)
    return [_row(request, "", rested), _row(request, ", right behind a key", typing)]


def _row(request: Request, when: str, took: Sequence[float]) -> Row:
    middle, slowest = seconds(median(took)), seconds(max(took))
    how = f"`{request.method}`, {len(took)} times over stdio; median {middle}, slowest {slowest}"
    return Row(f"{request.name}{when}, 95th percentile", seconds(percentile(took, 95)), request.target, how)


def idle_times(server: Server, path: Path, text: str, request: Request) -> Iterator[float]:
    """The time in s of each answer while the server has no other work."""
    for number, offset in enumerate(_offsets(text, request)):
        sent = server.send(request.method, request.params(path, position(text, offset)), _ID + number)
        arrived, answer = server.answer(_ID + number)
        assert "error" not in answer, answer
        yield arrived - sent


def behind_keys(server: Server, path: Path, text: str, request: Request) -> Iterator[float]:
    """The time in s of each answer if the request is sent together with the change of a key. The next key is pressed
    after the diagnostics have arrived."""
    for version, key in enumerate(keys(text), 3):
        offset = key.start + len(key.inserted)
        if request.name == "rename":
            named = _offsets(text, request)[version % len(RENAMED)]
            offset = named + (len(key.text) - len(text) if named > key.start else 0)
        server.change(path, version, key.change())
        sent = server.send(request.method, request.params(path, position(key.text, offset)), _ID + version)
        (arrived, _), _ = server.wait_for_all(is_answer(_ID + version), is_diagnostics(path, version))
        yield arrived - sent


def burst() -> list[Row]:
    """Keys in quick succession, with the requests that an editor sends after each."""
    plain, asking = [], []
    with system(SYSTEM_FILES) as folder:
        for _ in range(SESSIONS):
            for pause in PAUSES:
                plain.append(after_burst(folder, pause, ()))
                asking.append(after_burst(folder, pause, ASKED_WHILE_TYPING))
    how = f"from the last of {BURST} keys to its diagnostics; keys every {listed(f'{p * 1000:.0f}' for p in PAUSES)} ms"
    return [
        Row("burst of keys, slowest", seconds(max(plain)), "< 150 ms", how),
        Row(
            "the same with requests",
            seconds(max(asking)),
            "< 150 ms",
            "completion and semantic tokens with each key, those of the key before cancelled, as VS Code does",
        ),
    ]


def after_burst(folder: Path, pause: float, names: Sequence[str]) -> float:
    """The time in s from the last key to its diagnostics. `pause` is the time in s between keys."""
    path = folder / FIRST
    with opened(folder, REST) as (server, text):
        offered = [r for r in REQUESTS if r.name in names and r.capability in server.capabilities]
        sent, version = 0.0, 2
        for key in islice(keys(text), BURST + 1):  # the final text contains a misspelled word, so there are diagnostics
            for number in range(len(offered)):
                server.send("$/cancelRequest", {"id": _ID * version + number})
            version += 1
            sent = server.change(path, version, key.change())
            place = position(key.text, key.start + len(key.inserted))
            for number, request in enumerate(offered):
                server.send(request.method, request.params(path, place), _ID * version + number)
            time.sleep(pause)
        return server.diagnostics(path, version)[0] - sent


def _offsets(text: str, request: Request) -> Sequence[int]:
    if request.name == "rename":
        return [text.index(word) + len(word) for word in RENAMED] * RENAMES
    return places(text)


BENCHMARKS: dict[str, Benchmark] = {"requests": requests, "burst": burst}
