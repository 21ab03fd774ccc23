# SPDX-License-Identifier: Apache-2.0
"""Sends every request that the server supports at many places of a system, and checks invariants of the answers.

- The requests are read from the server's capabilities. An unknown capability is a failure, so a new feature must define
  its request here.
- No answer is an error, except for names that cannot be renamed. Every range in an answer is within its text.
  Formatting does not change the meaning of a model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any, TypeAlias

from lsprotocol import types
from pygls.uris import to_fs_path

import prefork
from as2fm_lsp.convert import Converter
from bench.server import Server, is_answer, started
from roaml import api
from roaml.jani.writer import write
from roaml.project.settings import Settings
from roaml.text import SourceFile, TextEdit, apply_edits, decode

Json: TypeAlias = dict[str, Any]
STEP = 7
"""The number of characters between two places of requests."""

CAPABILITIES: Json = {
    "general": {"positionEncodings": ["utf-16"]},
    "textDocument": {
        "completion": {"completionItem": {"snippetSupport": True, "documentationFormat": ["markdown"]}},
        "documentSymbol": {"hierarchicalDocumentSymbolSupport": True},
        "codeAction": {"codeActionLiteralSupport": {"codeActionKind": {"valueSet": ["quickfix", "refactor"]}}},
        "rename": {"prepareSupport": True},
        "diagnostic": {},
    },
}
_CONTEXTS: dict[str, Json] = {
    "textDocument/references": {"includeDeclaration": True},
    "textDocument/codeAction": {"diagnostics": []},
    "textDocument/completion": {"triggerKind": 1},
}


@dataclass(frozen=True)
class Method:
    """A request that is tested.

    Attributes:
        needs: the condition on the options of the capability.
        at: whether it is about a place ("position", "range"), a whole document ("") or the workspace (None).
        more: further parameters.
        follow: the requests that are sent for each item of the answer.
    """

    name: str
    needs: str = ""
    at: str | None = "position"
    more: Mapping[str, Any] = field(default_factory=dict)
    follow: tuple[str, ...] = ()


_FORMAT = {"options": {"tabSize": 4, "insertSpaces": True}}
_INLAY = ("inlayHint/resolve",)
_TD = "textDocument"
METHODS: dict[str, tuple[Method, ...]] = {
    "callHierarchyProvider": (
        Method(f"{_TD}/prepareCallHierarchy", follow=("callHierarchy/incomingCalls", "callHierarchy/outgoingCalls")),
    ),
    "codeActionProvider": (Method(f"{_TD}/codeAction", at="range", follow=("codeAction/resolve",)),),
    "codeLensProvider": (Method(f"{_TD}/codeLens", at="", follow=("codeLens/resolve",)),),
    "completionProvider": (Method(f"{_TD}/completion", follow=("completionItem/resolve",)),),
    "declarationProvider": (Method(f"{_TD}/declaration"),),
    "definitionProvider": (Method(f"{_TD}/definition"),),
    "diagnosticProvider": (
        Method(f"{_TD}/diagnostic", at=""),
        Method("workspace/diagnostic", "workspaceDiagnostics", at=None, more={"previousResultIds": []}),
    ),
    "documentFormattingProvider": (Method(f"{_TD}/formatting", at="", more=_FORMAT),),
    "documentHighlightProvider": (Method(f"{_TD}/documentHighlight"),),
    "documentLinkProvider": (Method(f"{_TD}/documentLink", at="", follow=("documentLink/resolve",)),),
    "documentOnTypeFormattingProvider": (
        Method(f"{_TD}/onTypeFormatting", more=_FORMAT | {"ch": ">"}),
        Method(f"{_TD}/onTypeFormatting", more=_FORMAT | {"ch": "/"}),
    ),
    "documentRangeFormattingProvider": (Method(f"{_TD}/rangeFormatting", at="range", more=_FORMAT),),
    "documentSymbolProvider": (Method(f"{_TD}/documentSymbol", at=""),),
    "foldingRangeProvider": (Method(f"{_TD}/foldingRange", at=""),),
    "hoverProvider": (Method(f"{_TD}/hover"),),
    "implementationProvider": (Method(f"{_TD}/implementation"),),
    "inlayHintProvider": (Method(f"{_TD}/inlayHint", at="range", follow=_INLAY),),
    "linkedEditingRangeProvider": (Method(f"{_TD}/linkedEditingRange"),),
    "referencesProvider": (Method(f"{_TD}/references"),),
    "renameProvider": (
        Method(f"{_TD}/prepareRename", "prepareProvider"),
        Method(f"{_TD}/rename", more={"newName": "fresh_name"}),
    ),
    "selectionRangeProvider": (Method(f"{_TD}/selectionRange", at="positions"),),
    "semanticTokensProvider": (
        Method(f"{_TD}/semanticTokens/full", "full", at=""),
        Method(f"{_TD}/semanticTokens/full/delta", "full.delta", at="", more={"previousResultId": ""}),
        Method(f"{_TD}/semanticTokens/range", "range", at="range"),
    ),
    "signatureHelpProvider": (Method(f"{_TD}/signatureHelp"),),
    "typeDefinitionProvider": (Method(f"{_TD}/typeDefinition"),),
    "typeHierarchyProvider": (
        Method(f"{_TD}/prepareTypeHierarchy", follow=("typeHierarchy/supertypes", "typeHierarchy/subtypes")),
    ),
    "workspaceSymbolProvider": (
        Method("workspace/symbol", at=None, more={"query": "s"}, follow=("workspaceSymbol/resolve",)),
    ),
}
NO_METHODS = frozenset(("executeCommandProvider", "positionEncoding", "textDocumentSync", "workspace"))
"""Capabilities of requests that are not about places. Other tests cover them."""

_REFUSABLE = ("textDocument/prepareRename", "textDocument/rename")
_REFUSED = types.LSPErrorCodes.RequestFailed.value
_FOLLOWED = 3
"""The number of items of an answer for which the next request is sent."""


def offered(capabilities: Json) -> tuple[tuple[Method, ...], tuple[str, ...]]:
    """The requests that a server supports, and those that resolve the answers of others.

    Raises:
        AssertionError: the server declares an unknown capability.
    """
    unknown = capabilities.keys() - METHODS.keys() - NO_METHODS
    assert not unknown, f"say in {Path(__file__).name} how to ask for {sorted(unknown)}"
    actual_methods: list[Method] = []
    resolvers: list[str] = []
    for name, methods in METHODS.items():
        options = capabilities.get(name)
        if not options and options != {}:
            continue
        actual_methods += [method for method in methods if _has(options, method.needs)]
        for method in methods:
            resolvers += [
                follower for follower in method.follow if "/resolve" not in follower or _has(options, "resolveProvider")
            ]
    return tuple(actual_methods), tuple(resolvers)


def _has(options: object, path: str) -> bool:
    for name in filter(None, path.split(".")):
        options = options.get(name) if isinstance(options, dict) else None
    return bool(options) or options == {}


def every_place(text: str) -> Sequence[int]:
    return range(0, len(text) + 1, STEP)


def some_places(seed: int, count: int) -> Callable[[str], Sequence[int]]:
    """Some of the places, always the same for a seed."""
    chance = Random(seed)

    def choose(text: str) -> Sequence[int]:
        places = every_place(text)
        return sorted(chance.sample(places, min(count, len(places))))

    return choose


class Sweep:
    """One system in a separate server.

    Args:
        main: the system file.
        ros_paths: folders with ROS packages.
        places: selects the offsets of a file for requests.
    """

    def __init__(
        self, main: Path, ros_paths: Sequence[str], places: Callable[[str], Sequence[int]] = every_place
    ) -> None:
        result = api.check([str(main)], ros_paths, Settings())
        self.main, self.ros_paths, self.places = main, tuple(ros_paths), places
        self.texts = {path: result.source(path) for path in result.files}
        self.asked = 0
        self.methods: set[str] = set()
        self._sources: dict[str, SourceFile] = dict(self.texts)
        self._convert = Converter("utf-16")
        self._next_id = 10

    def failures(self) -> Iterator[str]:
        """The invariants that do not hold."""
        with started(prefork.command()) as server:
            server.initialize(
                self.main.parent,
                capabilities=CAPABILITIES,
                options={"settings": {"rosPath": list(self.ros_paths)}},
            )
            methods, resolvers = offered(server.capabilities)
            self.methods = {method.name for method in methods}
            for path, source in self.texts.items():
                server.open(Path(path), source.text)
            yield from self._requests(server, [(method, "", {}) for method in methods if method.at is None], resolvers)
            formatted: dict[str, str] = {}
            for path, source in self.texts.items():
                yield from self._file(server, path, source, methods, resolvers)
                if "textDocument/formatting" in self.methods:
                    formatted[path] = self._formatted(server, path, source)
            yield from self._model_changes(formatted)

    def _file(
        self, server: Server, path: str, source: SourceFile, methods: Sequence[Method], resolvers: Sequence[str]
    ) -> Iterator[str]:
        uri = Path(path).as_uri()
        whole = [(method, path, self._params(uri, method)) for method in methods if method.at == ""]
        yield from self._requests(server, whole, resolvers)
        for offset in self.places(source.text):
            place = self._position(source, offset)
            end = self._position(source, min(offset + 5 * STEP, len(source.text)))
            asked = [
                (method, path, self._params(uri, method, place, end))
                for method in methods
                if method.at in ("position", "positions", "range")
            ]
            for failure in self._requests(server, asked, resolvers):
                yield f"at {place['line'] + 1}:{place['character'] + 1}: {failure}"

    def _params(self, uri: str, method: Method, place: Json | None = None, end: Json | None = None) -> Json:
        params: Json = {"textDocument": {"uri": uri}, **method.more}
        if method.name in _CONTEXTS:
            params["context"] = _CONTEXTS[method.name]
        if method.at == "position":
            params["position"] = place
        elif method.at == "positions":
            params["positions"] = [place]
        elif method.at == "range":
            params["range"] = {"start": place, "end": end}
        return params

    # --------------------------------------------------------------- requests

    def _requests(
        self, server: Server, asked: Sequence[tuple[Method, str, Json]], resolvers: Sequence[str]
    ) -> Iterator[str]:
        """Send all requests at once, and then those that follow from the answers."""
        sent = [(method.name, path, params or dict(method.more)) for method, path, params in asked]
        answers = self._answers(server, sent)
        following: list[tuple[str, str, Json]] = []
        for (method, path, _), (name, _, params), answer in zip(asked, sent, answers, strict=True):
            yield from (f"{path}: {name}: {failure}" for failure in self._wrong(name, path, answer))
            items = _items(answer.get("result"))[:_FOLLOWED]
            for follow in method.follow:
                if follow in resolvers:
                    resolves = "/resolve" in follow
                    following += [(follow, _path(item, path), item if resolves else {"item": item}) for item in items]
            del params
        for (name, path, _), answer in zip(following, self._answers(server, following), strict=True):
            self.methods.add(name)
            yield from (f"{path}: {name}: {failure}" for failure in self._wrong(name, path, answer))

    def _answers(self, server: Server, sent: Sequence[tuple[str, str, Json]]) -> list[Json]:
        first = self._next_id
        self._next_id += len(sent)
        self.asked += len(sent)
        for number, (name, _, params) in enumerate(sent):
            server.send(name, params, first + number)
        expected = [is_answer(first + number) for number in range(len(sent))]
        return [message for _, message in server.wait_for_all(*expected)] if expected else []

    def _wrong(self, name: str, path: str, answer: Json) -> Iterator[str]:
        error = answer.get("error")
        if error is not None:
            if name not in _REFUSABLE or error["code"] != _REFUSED:
                yield f"{error['code']} {error['message'][:200]}"
            return
        result = answer.get("result")
        yield from self._ranges(result, path)
        source = self._sources.get(path)
        if source is None:
            return
        if name == "textDocument/foldingRange":
            for fold in result or ():
                if not 0 <= fold["startLine"] <= fold["endLine"] < source.lines.line_count:
                    yield f"fold {fold} of {source.lines.line_count} lines"
        if "semanticTokens" in name and isinstance(result, dict) and "data" in result:
            yield from self._tokens(source, result["data"])

    def _ranges(self, value: object, path: str) -> Iterator[str]:
        """The ranges in an answer that are outside their texts."""
        if isinstance(value, list):
            for inner in value:
                yield from self._ranges(inner, path)
        if not isinstance(value, dict):
            return
        if value.keys() == {"start", "end"}:
            yield from self._range(value, path)
            return
        # The ranges of a call are in the file of the caller: the source of the call, or the item of the request.
        document = value.get("textDocument", value.get("from", value))
        here = _path(document, path)
        for key, inner in value.items():
            if key == "changes" and isinstance(inner, dict):
                for uri, edits in inner.items():
                    yield from self._ranges(edits, str(to_fs_path(uri)))
            elif key in ("targetRange", "targetSelectionRange"):
                yield from self._ranges(inner, str(to_fs_path(value["targetUri"])))
            elif key != "data":
                yield from self._ranges(inner, here)

    def _range(self, value: Json, path: str) -> Iterator[str]:
        source = self._source(path)
        if source is None:
            yield f"{value} in {path}, which cannot be read"
            return
        for place in (value["start"], value["end"]):
            position = types.Position(place["line"], place["character"])
            if self._convert.position(source, self._convert.offset(source, position)) != position:
                yield f"{place} is not in {path}"
        start, end = ((value[side]["line"], value[side]["character"]) for side in ("start", "end"))
        if start > end:
            yield f"{value} ends before it begins"

    def _tokens(self, source: SourceFile, data: Sequence[int]) -> Iterator[str]:
        line = character = before = 0
        for lines, characters, length, *_ in zip(*[iter(data)] * 5, strict=True):
            line, character = (line + lines, characters) if lines else (line, character + characters)
            end = {"line": line, "character": character + length}
            yield from self._range({"start": {"line": line, "character": character}, "end": end}, source.path)
            if not length or (not lines and character < before):
                yield f"an odd token at {line + 1}:{character + 1}"
            before = character + length

    def _source(self, path: str) -> SourceFile | None:
        if path not in self._sources and Path(path).is_file():
            self._sources[path] = decode(path, Path(path).read_bytes())
        return self._sources.get(path)

    def _position(self, source: SourceFile, offset: int) -> Json:
        position = self._convert.position(source, offset)
        return {"line": position.line, "character": position.character}

    # ------------------------------------------------------------- formatting

    def _formatted(self, server: Server, path: str, source: SourceFile) -> str:
        params = {"textDocument": {"uri": Path(path).as_uri()}, **_FORMAT}
        (answer,) = self._answers(server, [("textDocument/formatting", path, params)])
        edits = []
        for edit in answer.get("result") or ():
            start, end = (types.Position(**edit["range"][side]) for side in ("start", "end"))
            edits.append(TextEdit(self._convert.span(source, types.Range(start, end)), edit["newText"]))
        return apply_edits(source.text, edits)

    def _model_changes(self, formatted: dict[str, str]) -> Iterator[str]:
        before, after = self._translated({}), self._translated(formatted)
        if before != after:
            yield f"{self.main}: formatting changes the model"

    def _translated(self, texts: dict[str, str]) -> object:
        """The text of the translation; for a system with errors, the errors."""
        try:
            system = api.load(str(self.main), self.ros_paths, Settings(), texts)
        except api.ModelError as error:
            return sorted((d.path, d.code, d.message) for d in error.result.diagnostics)
        return "".join(write(api.to_jani(system)))


def _path(value: object, otherwise: str) -> str:
    """The path of an item with a URI."""
    uri = value.get("uri") if isinstance(value, dict) else None
    return str(to_fs_path(uri)) if isinstance(uri, str) else otherwise


def _items(result: object) -> list[Any]:
    if isinstance(result, dict):
        result = result.get("items")
    return result if isinstance(result, list) else []
