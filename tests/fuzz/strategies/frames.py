# SPDX-License-Identifier: Apache-2.0
"""Damaged input of the language server: bytes, headers, values of JSON, the order of messages.

A correct request at the end is answered once, whatever came before. No request is answered twice, and no answer reports
a failure in the server.
"""

from __future__ import annotations

import copy
import json
import logging
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from io import BytesIO
from random import Random
from typing import Any

from pygls.protocol import default_converter

from as2fm_lsp.inbox import MAX_MESSAGE_BYTES, bodies
from as2fm_lsp.server import create
from fuzz.corpus import Model, snippets
from fuzz.strategy import Failure, Strategy

FOLDER = "file:///nowhere/robot"
LAST = "the last request"
INTERNAL_ERROR = -32603
MAX_TEXT_LENGTH = 5000
"""The maximum number of characters of a document, because this strategy tests the protocol."""

Json = Any
Message = dict[str, Json]

REQUESTS = (
    "textDocument/hover",
    "textDocument/completion",
    "textDocument/definition",
    "textDocument/references",
    "textDocument/prepareRename",
    "textDocument/rename",
    "textDocument/documentHighlight",
    "textDocument/documentSymbol",
    "textDocument/foldingRange",
    "textDocument/selectionRange",
    "textDocument/semanticTokens/full",
    "textDocument/semanticTokens/range",
    "textDocument/inlayHint",
    "textDocument/codeLens",
    "textDocument/codeAction",
    "textDocument/signatureHelp",
    "textDocument/formatting",
    "textDocument/rangeFormatting",
    "textDocument/onTypeFormatting",
    "textDocument/linkedEditingRange",
    "textDocument/prepareCallHierarchy",
    "textDocument/prepareTypeHierarchy",
    "textDocument/documentLink",
    "textDocument/diagnostic",
    "as2fm/about",
    "as2fm/plainScxml",
    "as2fm/picture",
    "as2fm/pictureFile",
    "as2fm/pictureEdit",
    "as2fm/migrate",
    "as2fm/counterexample",
    "as2fm/parting",
    "as2fm/traceState",
    "as2fm/coverage",
    "as2fm/expectations",
    "as2fm/setExpectation",
    "as2fm/experiment",
    "as2fm/newParameter",
    "as2fm/propertySentences",
    "as2fm/newProperty",
    "as2fm/mocks",
    "as2fm/setMock",
    "as2fm/janiView",
)
OTHERS = (
    "workspace/symbol",
    "workspace/diagnostic",
    "as2fm/properties",
    "completionItem/resolve",
    "codeLens/resolve",
    "codeAction/resolve",
    "inlayHint/resolve",
    "workspaceSymbol/resolve",
    "callHierarchy/incomingCalls",
    "typeHierarchy/supertypes",
    "no/such",
)
ODD: tuple[Json, ...] = (
    *(None, True, False, 0, -1, 1, 2**31 - 1, 2**31, 2**53, 10**40, 0.5, 1e308, float("inf"), float("nan")),
    *("", "\0", "x", "\ud800", "\ufeff", "é🤖", "a" * 5000, "file:///a/%00", "file://[", "untitled:1", "full", "2.0"),
    *([], {}, [None], [[]], {"": None}, {"type_name": 1}, {"uri": 5}, {"line": -1, "character": 2**40}, ["a"] * 50),
)


@dataclass
class Frames:
    """The input of one client.

    Attributes:
        model: the model whose texts are opened.
        data: the bytes that are sent.
        damage: a description of the damage.
        asked: the ids of requests that were sent undamaged.
    """

    seed: int
    model: Model
    data: bytes = b""
    damage: list[str] = field(default_factory=list)
    asked: list[int] = field(default_factory=list)

    def description(self) -> Iterator[str]:
        yield f"messages about {self.model.name}"
        yield from self.damage

    def files(self) -> dict[str, str | bytes]:
        return {"messages": self.data}

    def run(self) -> Iterator[Failure]:
        answers = Counter[object]()
        for body in bodies(BytesIO(_said(self.data))):
            message = json.loads(body)
            if "method" in message:
                continue
            if ("result" in message) == ("error" in message):
                yield Failure("neither a result nor an error, or both", body.decode()[:1000])
            answers[repr(message["id"])] += 1
            error = message.get("error")
            if error and error["code"] == INTERNAL_ERROR:
                yield Failure(f"a failure in the server: {error['message'].split(':')[0]}", str(error)[:3000])
        if answers[repr(LAST)] != 1:
            yield Failure(f"the last request is answered {answers[repr(LAST)]} times", "")
        for id_ in self.asked:
            if answers[repr(id_)] != 1:
                yield Failure(f"a request is answered {answers[repr(id_)]} times", str(id_))


def _said(data: bytes) -> bytes:
    """The output of a server for some bytes."""
    logging.getLogger("pygls").setLevel(logging.CRITICAL)  # as the command does
    server = create()
    server.endpoint.protocol._converter = _converter()
    target = _Kept()
    server.serve(BytesIO(data), target)
    return target.getvalue()


@cache
def _converter() -> Any:
    """The converter of the protocol, shared because its creation takes longer than a case."""
    return default_converter()


class _Kept(BytesIO):
    """A stream whose content can be read after it was closed."""

    def close(self) -> None:
        pass


# ------------------------------------------------------------------ a session


def _session(random: Random, model: Model) -> Iterator[Message]:
    """The messages of a possible client, from the first one on."""
    yield _initialize(random)
    yield {"method": "initialized", "params": {}}
    texts = {f"{FOLDER}/{path.rpartition('/')[2]}": text[:MAX_TEXT_LENGTH] for path, text in model.texts.items()}
    for uri, text in texts.items():
        document = {"uri": uri, "languageId": "ascxml", "version": 1, "text": text}
        yield {"method": "textDocument/didOpen", "params": {"textDocument": document}}
    for number in range(random.randrange(3, 12)):
        uri = random.choice(list(texts))
        kind = random.random()
        if kind < 0.4:
            changes = [_change(random, texts[uri]) for _ in range(random.randrange(1, 3))]
            params = {"textDocument": {"uri": uri, "version": number + 2}, "contentChanges": changes}
            yield {"method": "textDocument/didChange", "params": params}
        elif kind < 0.85:
            method = random.choice(REQUESTS)
            yield {"id": number + 10, "method": method, "params": _params(random, uri, texts[uri])}
        elif kind < 0.93:
            yield {"id": number + 10, "method": random.choice(OTHERS), "params": _other(random, uri)}
        else:
            yield _notification(random, uri, number)


def _initialize(random: Random) -> Message:
    encodings = random.sample(["utf-8", "utf-16", "utf-32", "utf-7"], random.randrange(5))
    capabilities: Json = {"general": {"positionEncodings": encodings}} if encodings else {}
    if random.random() < 0.5:
        hierarchical = {"documentSymbol": {"hierarchicalDocumentSymbolSupport": True}}
        markdown = {"hover": {"contentFormat": ["markdown"]}}
        capabilities["textDocument"] = {"diagnostic": {}, **hierarchical, **markdown}
    params: Json = {
        "processId": None,
        "rootUri": FOLDER,
        "capabilities": capabilities,
        "workspaceFolders": [{"uri": FOLDER, "name": "robot"}],
        "initializationOptions": {"trusted": False, "settings": {"ignore": []}},
    }
    return {"id": 1, "method": "initialize", "params": params}


def _position(random: Random, text: str) -> Json:
    line = random.randrange(text.count("\n") + 2)
    return {"line": line, "character": random.randrange(random.choice([1, 5, 40, 200]))}


def _range(random: Random, text: str) -> Json:
    return {"start": _position(random, text), "end": _position(random, text)}


def _change(random: Random, text: str) -> Json:
    if random.random() < 0.1:
        return {"text": text[: random.randrange(len(text) + 1)]}
    start = random.randrange(len(text) + 1)
    piece = random.choice(["", "<", "\ufeff", "\u2028", "\r", "🤖", "\x0c", text[start : start + random.randrange(50)]])
    return {"range": _range(random, text), "text": piece}


def _params(random: Random, uri: str, text: str) -> Json:
    """Parameters for any request about a document. Superfluous ones are ignored."""
    return {
        "textDocument": {"uri": uri},
        "position": _position(random, text),
        "positions": [_position(random, text)],
        "range": _range(random, text),
        "context": {"diagnostics": [], "includeDeclaration": True},
        "newName": random.choice(["a", "new", "", "<b>"]),
        "ch": random.choice(["\n", ">"]),
        "options": {"tabSize": 2, "insertSpaces": True},
        "kind": random.choice(["machine", "tree", "ros"]),
        "property": random.choice(["p", "never_empty", ""]),
        "expected": random.choice([">= 0.9", "", "= P"]),
        "witness": random.random() < 0.5,
        **{name: random.randrange(3) for name in ("trace", "step", "earlier", "offset")},
        "pattern": random.choice(["", "<leaf>"]),
        "within": random.choice(["", "1 s"]),
        "sentence": random.choice(["existence", "absence", ""]),
        "events": random.choice([["a"], [""], []]),
    }


def _other(random: Random, uri: str) -> Json:
    item = {"name": "a", "kind": 5, "uri": uri, "range": _range(random, ""), "selectionRange": _range(random, "")}
    return {
        "query": random.choice(["", "a", "\0"]),
        "previousResultIds": [{"uri": uri, "value": "x"}],
        "label": "a",
        "title": "a",
        "range": _range(random, ""),
        "position": _position(random, ""),
        "data": random.choice([None, [], [uri], [uri, "a", "b", "c", "d"], {"uri": uri}, 5, "x"]),
        "item": {**item, "data": random.choice([None, [], ["a", "b"], 5])},
    }


def _notification(random: Random, uri: str, number: int) -> Message:
    method, params = random.choice(
        [
            ("textDocument/didSave", {"textDocument": {"uri": uri}}),
            ("textDocument/didClose", {"textDocument": {"uri": uri}}),
            ("$/cancelRequest", {"id": number + 9}),
            ("$/setTrace", {"value": "off"}),
            ("$/unknown", {}),
            ("window/workDoneProgress/cancel", {"token": "t"}),
            ("workspace/didChangeConfiguration", {"settings": {"as2fm": random.choice(ODD)}}),
            ("workspace/didChangeWatchedFiles", {"changes": [{"uri": uri, "type": 2}]}),
            ("workspace/didChangeWorkspaceFolders", {"event": {"added": [], "removed": []}}),
            ("as2fm/didChangeTrust", {"trusted": False}),
        ]
    )
    return {"method": method, "params": params}


# --------------------------------------------------------------------- damage


def frame(message: Json) -> bytes:
    body = json.dumps(message).encode()
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


def _odd_value(random: Random, message: Message) -> bytes:
    """Replace a part of a message by another value."""
    places = list(_places(message))
    holder, key = random.choice(places)
    holder[key] = copy.deepcopy(random.choice(ODD))
    return frame(message)


def _missing(random: Random, message: Message) -> bytes:
    holder, key = random.choice(list(_places(message)))
    del holder[key]
    return frame(message)


def _places(value: Json) -> Iterator[tuple[Json, Any]]:
    """Every member of every object and list in a value."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in list(items):
        yield value, key
        yield from _places(inner)


def _odd_bytes(random: Random, message: Message) -> bytes:
    """Change the body, with a header that fits it."""
    body = bytearray(json.dumps(message).encode())
    for _ in range(random.randrange(1, 4)):
        at = random.randrange(len(body))
        body[at : at + random.randrange(4)] = random.choice(
            [b"", b"\xff", b"\0", b'"', b"{", b"]", b"\xed\xa0\x80", b"\\u"]
        )
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


def _odd_header(random: Random, message: Message) -> bytes:
    body = json.dumps(message).encode()
    length = random.choice([b"0", b"-1", b"9" * 4301, b"%d" % (MAX_MESSAGE_BYTES + 1), b"1e3", b"", b"\xd9\xa3"])
    end = random.choice([b"\r\n\r\n", b"\n\n", b"\r\n", b"", b"\r\nContent-Type: x\r\n\r\n", b"\r\n\r\n\r\n"])
    name = random.choice([b"Content-Length: ", b"content-length:", b"Content-Length ", b"X-Content-Length: ", b""])
    return name + random.choice([length, b"%d" % len(body)]) + end + body + b"\r\n"


def _short(random: Random, message: Message) -> bytes:
    """Make the announced length too small, so that the rest of the body is noise."""
    body = json.dumps(message).encode()
    return b"Content-Length: %d\r\n\r\n%b\r\n" % (random.randrange(1, len(body)), body)


def _bomb(random: Random, message: Message) -> bytes:
    depth = random.choice([100, 900, 5000, 200_000])
    opening, closing = random.choice([(b"[", b"]"), (b'{"a":', b"}")])
    nested = opening * depth + b"1" + closing * depth
    fields = json.dumps({"jsonrpc": "2.0", **message}).encode()
    body = random.choice([nested, opening * depth, fields[:-1] + b', "params": ' + nested + b"}"])
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


def _noise(random: Random, message: Message) -> bytes:
    """Put bytes that are not a message before a message."""
    noise = [
        b"GET / HTTP/1.1\r\nHost: x\r\n\r\n",
        b"\r\n" * 5,
        random.randbytes(200),
        b"x" * 70_000,
        b"{}",
        b"Content-",
    ]
    return random.choice(noise) + b"\r\n" + frame(message)


def _twice(_: Random, message: Message) -> bytes:
    return frame(message) * 2


def _early_end(random: Random, message: Message) -> bytes:
    ending = {"jsonrpc": "2.0", "id": 5000, "method": "shutdown"}
    return frame(ending) + frame(message) if random.random() < 0.5 else frame(message) + frame(ending)


WAYS: tuple[Callable[[Random, Message], bytes], ...] = (
    _odd_value,
    _odd_value,
    _odd_value,
    _missing,
    _odd_bytes,
    _odd_header,
    _short,
    _bomb,
    _noise,
    _twice,
    _early_end,
)


def make(seed: int) -> Frames:
    random = Random(seed)
    case = Frames(seed, random.choice(snippets()))
    messages = [{"jsonrpc": "2.0", **message} for message in _session(random, case.model)]
    if random.random() < 0.1:
        at = random.randrange(len(messages))
        messages.insert(random.randrange(len(messages)), messages.pop(at))
        case.damage.append(f"message {at} comes at another time")
    chosen = {random.randrange(len(messages)) for _ in range(random.choice([1, 1, 2, 4]))}
    parts: list[bytes] = []
    for number, message in enumerate(messages):
        if number in chosen:
            way = random.choice(WAYS)
            case.damage.append(f"{way.__name__} in message {number}, {message['method']}")
            parts.append(way(random, copy.deepcopy(message)))
        else:
            parts.append(frame(message))
            if "id" in message:
                case.asked.append(message["id"])
    # After damage of an id, two requests may have the same one.
    case.asked = [] if any("_twice" in name or "_odd" in name for name in case.damage) else case.asked
    parts += (b"\r\n", frame({"jsonrpc": "2.0", "id": LAST, "method": "no/such", "params": {}}))
    case.data = b"".join(parts)
    return case


STRATEGY = Strategy("frames", "damages what a client sends to the language server", make)
