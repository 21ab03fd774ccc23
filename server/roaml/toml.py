# SPDX-License-Identifier: Apache-2.0
"""TOML with positions, which Python's parser does not keep.

`tomllib` validates the text and provides the values. The scanner in this module reads the text again and records
the positions of keys and values; it requires valid text.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from roaml.record import Record
from roaml.regex import regex
from roaml.text import LineIndex, Position, Span

Path: TypeAlias = "tuple[str | int, ...]"
"""Keys of tables and indices of arrays, from the outermost to the innermost."""


class Places(Record, frozen=True):
    """The positions of the keys and values of a document. For a table with a header, `values` has the span of the
    header."""

    keys: Mapping[Path, Span]
    values: Mapping[Path, Span]


class TomlError(ValueError):
    """Raised for text that is not valid TOML. The message is that of the parser without the position; `span` is the
    character at the position."""

    def __init__(self, message: str, span: Span) -> None:
        super().__init__(message)
        self.span = span


_WHERE = regex(r" \(at (?:line (\d+), column (\d+)|end of document)\)\Z")


def _parsed(text: str) -> dict[str, Any]:
    # Most commands read no TOML.
    if sys.version_info >= (3, 11):
        import tomllib  # noqa: PLC0415
    else:
        import tomli as tomllib  # noqa: PLC0415
    return tomllib.loads(text)


def loads(text: str) -> dict[str, Any]:
    """The values of a document.

    Raises:
        TomlError: the text is not valid TOML, or is nested too deeply for the parser.
    """
    _check_keys(text)
    try:
        return _parsed(text)
    except RecursionError:
        raise TomlError("Values are nested too deeply", Span(0, min(1, len(text)))) from None
    except ValueError as error:
        message = str(error)
        where = _WHERE.search(message)
        last = at = max(0, len(text.rstrip()) - 1)
        if where is not None:
            message = message[: where.start()]
            if where[1] is not None:
                # The parser turns `\r\n` into `\n`, which changes neither lines nor columns.
                at = LineIndex(text).offset(Position(int(where[1]) - 1, int(where[2]) - 1))
        start = min(at, last)
        raise TomlError(message, Span(start, min(start + 1, len(text)))) from None


def _check_keys(text: str) -> None:
    """Check that no key has too many parts: the time of the parser grows with the square of their number.

    Raises:
        TomlError: a key has more than `MAX_KEY_PARTS` parts.
    """
    for match in _TOKEN.finditer(text):
        parts = len(_PART.findall(match[0])) if match.lastgroup == "key" and match[0].count(".") >= MAX_KEY_PARTS else 0
        if parts > MAX_KEY_PARTS:
            raise TomlError(f"A key has {parts:,} parts; at most {MAX_KEY_PARTS} are supported", Span(*match.span()))


MAX_KEY_PARTS = 20
"""The maximum number of parts of a dotted key. No setting has more than three."""

# Each alternative also matches a text that is not complete, so that no position is examined twice.
_PART = regex(r"""[A-Za-z0-9_-]+|"(?:[^"\\\n]|\\.)*"?|'[^'\n]*'?""")
_TOKEN = regex(
    r"#[^\n]*"
    r'|"""(?:[^\\]|\\.)*?(?:"""|\Z)'
    r"|'''.*?(?:'''|\Z)"
    rf"|(?P<key>(?:{_PART.pattern})(?:[ \t]*\.[ \t]*(?:{_PART.pattern}))*)",
    re.DOTALL,
)

_MAX_DEPTH = 8
"""The maximum nesting depth of values whose positions are recorded."""

_SPACE = regex(r"[ \t]*")
_BLANK = regex(r"(?:[ \t\r\n]|#[^\n]*)*")
_KEY = regex(r"""[A-Za-z0-9_-]+|"(?:[^"\\]|\\.)*"|'[^']*'""")
_STRING = regex(
    r'"""(?:[^\\]|\\.)*?"{3,5}(?!")' r"|'''.*?'{3,5}(?!')" r'|"(?:[^"\\\n]|\\.)*"' r"|'[^'\n]*'",
    re.DOTALL,
)
_BARE = regex(r"[^,\]}#\n]*")
_WORD = regex(r"[^,=\[\]{}#\s\"']+")


def places(text: str) -> Places:
    """The positions of the keys and values in `text`, which must be valid TOML."""
    scanner = _Scanner(text)
    scanner.document()
    return Places(scanner.keys, scanner.values)


class _Scanner:
    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.keys: dict[Path, Span] = {}
        self.values: dict[Path, Span] = {}

    def document(self) -> None:
        table: Path = ()
        counts: dict[Path, int] = {}
        while self._blank():
            if not self._sees("["):
                self._pair(table, 0)
                continue
            start = self.at
            is_element = self._sees("[[")
            self.at += 2 if is_element else 1
            table = ()
            for part, span in self._key():
                table = (*table, part)
                self.keys.setdefault(table, span)
                if table in counts:
                    table = (*table, counts[table])
            if is_element:
                array = table[:-1] if table[-1:] and isinstance(table[-1], int) else table
                counts[array] = counts.get(array, -1) + 1
                table = (*array, counts[array])
            self.at = self.text.index("]", self.at) + (2 if is_element else 1)
            header = Span(start, self.at)
            self.values.setdefault(table, header)
            if is_element:
                self.values.setdefault(table[:-1], header)

    def _sees(self, mark: str) -> bool:
        return self.text.startswith(mark, self.at)

    def _blank(self) -> bool:
        """Skip white space and comments; return whether anything follows."""
        match = _BLANK.match(self.text, self.at)
        assert match is not None
        self.at = match.end()
        return self.at < len(self.text)

    def _space(self) -> None:
        match = _SPACE.match(self.text, self.at)
        assert match is not None
        self.at = match.end()

    def _key(self) -> Iterator[tuple[str, Span]]:
        """The parts of a dotted key."""
        while True:
            self._space()
            match = _KEY.match(self.text, self.at)
            if match is None:  # only in a text that is not valid TOML
                return
            self.at = match.end()
            yield _decoded(match[0]), Span(match.start(), match.end())
            self._space()
            if not self._sees("."):
                return
            self.at += 1

    def _pair(self, table: Path, depth: int) -> None:
        path = table
        for part, span in self._key():
            path = (*path, part)
            self.keys.setdefault(path, span)
        self.at = self.text.index("=", self.at) + 1
        self._space()
        self._value(path, depth)

    def _value(self, path: Path, depth: int) -> None:
        start = self.at
        if depth >= _MAX_DEPTH:
            self._skip()
        elif self._sees("["):
            self._items(path, "]", depth)
        elif self._sees("{"):
            self._items(path, "}", depth)
        else:
            self._scalar()
        self.values[path] = Span(start, self.at)

    def _items(self, path: Path, end: str, depth: int) -> None:
        """Read the items of an array or inline table up to the bracket `end`."""
        self.at += 1
        index = 0
        while self._blank() and not self._sees(end):
            if end == "]":
                self._value((*path, index), depth + 1)
                index += 1
            else:
                self._pair(path, depth + 1)
            self._blank()
            if self._sees(","):
                self.at += 1
        self.at += 1

    def _scalar(self) -> None:
        match = _STRING.match(self.text, self.at)
        if match is not None:
            self.at = match.end()
            return
        bare = _BARE.match(self.text, self.at)
        assert bare is not None
        self.at += max(1, len(bare[0].rstrip()))

    def _skip(self) -> None:
        """Skip a value, without recursion."""
        depth = 0
        while self._blank():
            character = self.text[self.at]
            if character in "[{":
                depth += 1
                self.at += 1
            elif character in "]}":
                depth -= 1
                self.at += 1
            elif character in ",=":
                self.at += 1
            else:
                match = _STRING.match(self.text, self.at) or _WORD.match(self.text, self.at)
                self.at = match.end() if match else self.at + 1
            if depth <= 0:
                return


def _decoded(key: str) -> str:
    if key[0] == "'":
        return key[1:-1]
    if key[0] == '"':
        return str(next(iter(_parsed(f"{key} = 0")))) if "\\" in key else key[1:-1]
    return key
