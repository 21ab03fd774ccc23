# SPDX-License-Identifier: Apache-2.0
"""Text -> JSON tree, for any text.

- Never fails and takes time linear in the text: every error becomes a finding (`json-syntax`, or `duplicate-json-key`),
  and parsing continues after it. A text without `json-syntax` findings is valid JSON (RFC 8259).
- Recovers for texts that are being typed: a string with an open quote ends with its line; a name without a value is a
  member without a value; the syntax of other notations (comments, single quotes, bare words) is read and reported.
- Does not recurse.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NoReturn

from roaml.diagnostics import Finding, Fix, Related
from roaml.json_syntax.brackets import MAX_DEPTH, Bracket, PendingName
from roaml.json_syntax.frequent import END, read_frequent
from roaml.json_syntax.strings import quote, unescape
from roaml.json_syntax.values import (
    JsonArray,
    JsonBool,
    JsonError,
    JsonNull,
    JsonNumber,
    JsonObject,
    JsonString,
    JsonValue,
    Member,
    Nulls,
)
from roaml.record import replace
from roaml.regex import regex
from roaml.text import Span, TextEdit

MAX_FINDINGS = 100
"""The maximum number of errors; a text with more is unlikely to be JSON and is not read further."""


def parse(text: str) -> tuple[JsonValue, tuple[Finding, ...]]:
    """The value in `text`, and its syntax errors, in the order of the text."""
    parser = _Parser(text)
    value = parser.run()
    return value, tuple(sorted(parser.findings, key=lambda finding: finding.span))


_SPACE = r"[ \t\n\r]*"
_TOKEN = regex(
    rf"{_SPACE}(,)?{_SPACE}(?:"
    rf'"([^"\\\x00-\x1f]*)"(?:{_SPACE}(:))?'
    r"|(-?(?:0|[1-9][0-9]*))((?:\.[0-9]+)?[eE][+-]?[0-9]+|\.[0-9]+)?(?![\w.+-])"
    r"|(true|false)(?!\w)"
    r"|(null(?:,null)*)(?!\w)"
    r"|([\[{])"
    r"|([\]}])"
    r")?"
)
"""An ordinary token with the comma before it. Always matches; `lastindex` identifies the token."""
_STRING, _KEY, _INTEGER, _REAL, _BOOL, _NULLS, _OPEN, _CLOSE = 2, 3, 4, 5, 6, 7, 8, 9

_COLON = regex(rf"{_SPACE}:")
_ASSIGNMENT = regex(r"=>?")
_NAME_AND_COLON = regex(r"([\w-]+)\s*:")
"""The text of a key without a closing quote, and the colon after it."""
_STRING_BODY = {
    '"': regex(r'((?:[^"\\\n\r]|\\[^\n\r])*)(")?'),
    "'": regex(r"((?:[^'\\\n\r]|\\[^\n\r])*)(')?"),
}
_DELIMITERS = " \t,]}\\"
_WORD = regex(r"""(?:(?!//|/\*)[^,:;\[\]{}"\n\r])+""")
_INTERLUDES = (
    (regex(rf",(?:{_SPACE},)*"), "surplus comma; remove it", ""),
    (regex(r"//[^\n\r]*|/\*(?:[^*]|\*(?!/))*(?:\*/)?|#[^\n\r]*"), "JSON does not support comments", ""),
    (regex(r"[^\S \t\n\r]+|\ufeff+"), "this character is not white space in JSON", " "),
    (regex(";"), "values must be separated by commas", ","),
)
"""Invalid text that is skipped: its pattern, the message of its finding, and the text that replaces it."""
_SLOPPY_NUMBER = regex(r"([+-]?)([0-9]*)(?:\.([0-9]*))?(?:[eE]([+-]?[0-9]+))?\Z")
_FOREIGN_LITERALS = {"True": "true", "TRUE": "true", "False": "false", "FALSE": "false", "None": "null", "NULL": "null"}
_NO_NUMBERS = {"nan", "infinity", "inf"}


class _HopelessError(Exception):
    """Ends the parsing of a text with too many errors; never leaves this module."""


class _Parser:
    """Reads one text.

    Attributes:
        ended: the text and the character after it, for `read_frequent`.
        words: names and strings that have been read, so that equal ones are one object.
        root: the value of the whole text, once it is complete.
        start, is_object, parts: the innermost open bracket and the values or members in it; outside of all brackets,
            the beginning of the text and the values in it.
        key: the name whose value follows.
        wants_comma: whether a complete value has been read, so that a comma must precede the next value.
        stack: the brackets around the innermost one.
        comma: the offset of a comma before an unusual token, or -1.
        hopeless: whether parsing has stopped; open brackets are then closed without further findings.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.ended = text + END
        self.words: dict[str, str] = {}
        self.findings: list[Finding] = []
        self.root: JsonValue | None = None
        self.start = 0
        self.is_object = False
        self.parts: list[Any] = []
        self.key: PendingName | None = None
        self.wants_comma = False
        self.stack: list[Bracket] = []
        self.comma = -1
        self.hopeless = False

    def run(self) -> JsonValue:
        try:
            end = self.read()
            if rest := self.text[end:].strip(" \t\n\r"):
                start = self.text.index(rest, end)
                span = Span(start, start + len(rest))
                self.report(span, "unexpected text after the value; a file contains one value", _removal(span))
        except _HopelessError:
            self.close_all()
        return self.root or JsonError(0, len(self.text))

    def read(self) -> int:
        """Read up to the end of one value; return the offset after it."""
        text, match = self.text, _TOKEN.match
        at = 0
        while self.root is None:
            if self.stack and self.key is None and self.comma < 0:
                at = self.frequent(at)
            token = match(text, at)
            assert token is not None
            kind, at, comma = token.lastindex, token.end(), token.start(1)
            if self.comma >= 0:
                comma, self.comma = max(comma, self.comma), -1
            if kind == _STRING:
                self.value(JsonString(token.start(2) - 1, at, token[2]), comma)
            elif kind == _KEY:
                self.name(token[2], token.start(2) - 1, token.end(2) + 1, comma)
            elif kind == _CLOSE:
                self.close(at - 1, comma)
            elif kind == _OPEN:
                self.open(at - 1, comma)
            elif kind == _NULLS:
                at = self.nulls(token.start(7), at, comma)
            elif kind == _INTEGER:
                self.value(self.integer(token[4], token.start(4), at), comma)
            elif kind == _BOOL:
                self.value(JsonBool(token.start(6), at, token[6] == "true"), comma)
            elif kind == _REAL:
                number = token[4] + token[5]
                self.value(JsonNumber(token.start(4), at, float(number), number), comma)
            else:
                at = self.unusual(at, comma)
        return at

    def frequent(self, at: int) -> int:
        """Read the text inside a bracket as far as it is valid and consists of frequent tokens; return the offset after
        it."""
        at, self.start, self.is_object, self.parts, self.key = read_frequent(
            self.ended, at, self.stack, self.start, self.is_object, self.parts, self.words
        )
        self.wants_comma = self.key is None and bool(self.parts)
        return at

    # ---------------------------------------------------------------- structure

    def value(self, value: JsonValue, comma: int) -> None:
        """Read `value`; `comma` is the offset of the comma before it, -1 if there is none."""
        if (comma >= 0) is not self.wants_comma:
            self.odd_comma(value.start, comma)
        key = self.key
        if key is not None:
            if not key.colon:
                # The colon after a key that is never closed is part of the key.
                closed = self.text[key.end - 1] == self.text[key.start]
                fix = _insertion(key.end, ":") if closed else None
                self.report(Span(key.start, key.end), f"`:` must follow `{key.text[:40]}`", fix)
            self.parts.append(key.member(value))
            self.key = None
            self.wants_comma = True
        elif self.is_object:
            self.value_without_name(value)
        elif self.stack:
            self.parts.append(value)
            self.wants_comma = True
        else:
            self.root = value

    def nulls(self, start: int, end: int, comma: int) -> int:
        """Read `null` or, in a list, `null,null,...`; return the offset after it."""
        first = JsonNull(start, start + 4)
        if self.is_object or not self.stack or end == first.end:
            self.value(first, comma)
            return first.end
        if (comma >= 0) is not self.wants_comma:
            self.odd_comma(start, comma)
        self.parts.append(Nulls(start, end))
        self.wants_comma = True
        return end

    def name(self, text: str, start: int, end: int, comma: int, quotes: tuple[int, int] = (1, 1)) -> None:
        """Read a name before a colon: a string, or text without quotes that is probably intended as a name."""
        if not self.is_object:
            self.report(Span(start, end), "a name with a value is only allowed in `{ }`")
            self.value(JsonString(start, end, text), comma)
            return
        if self.key is not None:
            self.key_without_value()
        elif (comma >= 0) is not self.wants_comma:
            self.odd_comma(start, comma)
        self.key = PendingName(text, start, end, quotes)
        self.wants_comma = False

    def open(self, at: int, comma: int) -> None:
        if (comma >= 0) is not self.wants_comma:
            self.odd_comma(at, comma)
        if self.key is None and self.is_object:
            self.report(Span(at, at + 1), "a name is missing before this bracket")
            self.key = PendingName("", at, at, (0, 0))
        if len(self.stack) >= MAX_DEPTH:
            self.report(Span(at, at + 1), f"nested too deeply: at most {MAX_DEPTH} brackets may be open")
            self.give_up()
        self.stack.append(Bracket(self.start, self.is_object, self.parts, self.key))
        self.start, self.is_object, self.parts = at, self.text[at] == "{", []
        self.key, self.wants_comma = None, False

    def close(self, at: int, comma: int) -> None:
        bracket = self.text[at]
        if self.key is not None:
            self.key_without_value()
        elif comma >= 0:
            self.report(
                Span(comma, comma + 1), f"unexpected comma before `{bracket}`", _removal(Span(comma, comma + 1))
            )
        is_object = bracket == "}"
        if not self.stack or (is_object is not self.is_object and is_object not in self.outer_kinds()):
            self.report(Span(at, at + 1), f"`{bracket}` closes no bracket; remove it", _removal(Span(at, at + 1)))
            return
        while is_object is not self.is_object:
            missing = "}" if self.is_object else "]"
            opened = Related(Span(self.start, self.start + 1), "opened here")
            fix = _insertion(self.end_before(at), missing)
            self.report(Span(at, at + 1), f"`{missing}` is missing before `{bracket}`", fix, opened)
            self.leave(at)
        self.leave(at + 1)

    def outer_kinds(self) -> Iterator[bool]:
        """Whether each bracket around the innermost one is an object. The first frame is the text, not a bracket."""
        return (bracket.is_object for bracket in self.stack[1:])

    def leave(self, end: int) -> None:
        """End the innermost bracket at `end`; it becomes a value in the bracket around it."""
        value: JsonValue
        if self.is_object:
            value = JsonObject(self.start, end, tuple(self.parts))
            if len({member.key for member in self.parts}) != len(self.parts):
                self.duplicate_names()
        else:
            value = JsonArray(self.start, end, tuple(self.parts))
        around = self.stack.pop()
        self.start, self.is_object, self.parts, self.key = around.start, around.is_object, around.parts, around.key
        self.wants_comma = False
        self.value(value, -1)

    def close_all(self) -> str:
        """Close all brackets that are open at the end of the text; return the missing brackets."""
        missing = ""
        while self.stack:
            if self.key is not None:
                self.parts.append(self.key.member(None))
            missing += "}" if self.is_object else "]"
            self.leave(len(self.text))
        return missing

    def end_before(self, at: int) -> int:
        """The end of the last token before `at`."""
        while at and self.text[at - 1] in " \t\n\r,":
            at -= 1
        return at

    # ---------------------------------------------------------------- errors in the structure

    def odd_comma(self, at: int, comma: int) -> None:
        """Report a missing or surplus comma before `at`."""
        if comma < 0:
            fix = _insertion(self.end_before(at), ",")
            self.report(Span(at, at + 1), "a comma is missing before this value", fix)
        elif self.key is not None:
            self.key_without_value()
        else:
            self.report(Span(comma, comma + 1), "unexpected comma; remove it", _removal(Span(comma, comma + 1)))

    def key_without_value(self) -> None:
        assert self.key is not None
        key = self.key
        self.parts.append(key.member(None))
        self.key, self.wants_comma = None, True
        missing = "a value" if key.colon else "`:` and a value"
        self.report(Span(key.start, key.end), f"{missing} must follow `{key.text[:40]}`")

    def value_without_name(self, value: JsonValue) -> None:
        """Read a value where an object requires a name; a string is read as a name without a colon."""
        if isinstance(value, JsonString):
            self.key, self.wants_comma = PendingName(value.value, value.start, value.end, value.quotes, False), False
            return
        self.parts.append(Member("", value.start, value.start, value, (0, 0)))
        self.wants_comma = True
        self.report(value.span, "a name is missing before this value")

    def duplicate_names(self) -> None:
        first: dict[str, Member] = {}
        for member in self.parts:
            known = first.setdefault(member.key, member)
            if known is not member and member.key and len(self.findings) < MAX_FINDINGS:
                message = f"duplicate key `{member.key[:40]}`; only the last value is used"
                related = (Related(known.key_span, "the other key"),)
                following = self.parts[self.parts.index(known) + 1]
                edit = TextEdit(Span(known.start, following.start), "")
                fix = Fix("Remove the ignored member", (edit,), safe=True)
                self.findings.append(Finding("duplicate-json-key", member.key_span, message, None, (fix,), related))

    # ---------------------------------------------------------------- unusual text

    def unusual(self, at: int, comma: int) -> int:
        """Read an unusual token at `at`; return the offset after it."""
        text = self.text
        if at == len(text):
            return self.end(at)
        character = text[at]
        if character in _STRING_BODY:
            return self.string(at, comma)
        if character == ":":
            return self.colon(Span(at, at + 1), comma)
        if (assignment := _ASSIGNMENT.match(text, at)) and self.key is not None and not self.key.colon:
            span = Span(*assignment.span())
            self.report(span, "a name must be followed by `:`", _replacement(span, ":"))
            return self.colon(span, comma)
        for pattern, message, replacement in _INTERLUDES:
            if match := pattern.match(text, at):
                span = Span(*match.span())
                self.comma = at if character == ";" else comma
                fix = _replacement(span, replacement) if replacement else _removal(span)
                self.report(span, message, fix)
                return span.end
        return self.word(at, comma)

    def end(self, at: int) -> int:
        """Report that the text ends at `at` without a complete value; return `at`."""
        if not self.stack:
            self.root = JsonError(0, at)
            self.report(Span(0, at), "a value is missing" if self.text.strip() else "the file is empty")
            return at
        bracket = Span(self.start, self.start + 1)
        end = self.end_before(at)
        missing = self.close_all()
        message = f"`{self.text[bracket.start]}` is never closed"
        if len(missing) > 1:
            message += f"; `{missing[:20]}` is missing at the end"
        self.report(bracket, message, _insertion(end, missing))
        return at

    def colon(self, span: Span, comma: int) -> int:
        """Read a colon that is not directly after its name."""
        self.comma = comma
        if self.key is not None and not self.key.colon:
            self.key = replace(self.key, colon=True)
        elif self.text[span.start] == ":":
            self.report(span, "unexpected colon; remove it", _removal(span))
        return span.end

    def string(self, at: int, comma: int) -> int:
        """Read a string with escapes, single quotes or invalid characters, or without an end."""
        mark = self.text[at]
        body = _STRING_BODY[mark].match(self.text, at + 1)
        assert body is not None
        raw, closed = body[1], body[2] is not None
        if not closed:
            raw = raw.rstrip(_DELIMITERS)
        span = Span(at, at + 1 + len(raw) + closed)
        value, problems = unescape(raw, at + 1)
        if not closed:
            name = _NAME_AND_COLON.match(raw) if self.is_object and self.key is None else None
            close = _insertion(at + 1 + name.end(1), mark) if name else _replacement(span, quote(value))
            self.report(span, 'the string has no closing `"`', close)
        elif mark == "'":
            self.report(span, "a string needs double quotes", _replacement(span, quote(value)))
        else:
            for message, edit in problems:
                self.report(edit.span, message, _replacement(*edit))
        return self.string_or_name(JsonString(*span, value, (1, int(closed))), comma)

    def word(self, at: int, comma: int) -> int:
        """Read characters without quotes: a misspelled number or literal, a string, or a name."""
        word = _WORD.match(self.text, at)
        assert word is not None
        text = word[0].rstrip()
        span = Span(at, at + len(text))
        if self.is_object and _COLON.match(self.text, span.end):
            self.report(span, "a name needs double quotes", _replacement(span, quote(text)))
            return self.string_or_name(JsonString(*span, text, (0, 0)), comma)
        self.value(self.bare(text, span), comma)
        return span.end

    def string_or_name(self, string: JsonString, comma: int) -> int:
        if self.is_object and (colon := _COLON.match(self.text, string.end)):
            self.name(string.value, string.start, string.end, comma, string.quotes)
            return colon.end()
        self.value(string, comma)
        return string.end

    def bare(self, text: str, span: Span) -> JsonValue:
        """The probable value of a word without quotes. A finding states how JSON writes this value."""
        if literal := _FOREIGN_LITERALS.get(text):
            self.report(span, f"`{text}` is not a JSON literal; write `{literal}`", _replacement(span, literal))
            return JsonNull(*span) if literal == "null" else JsonBool(*span, literal == "true")
        if text.lstrip("+-").lower() in _NO_NUMBERS:
            self.report(span, f"JSON does not support the number `{text[:40]}`")
            return JsonError(*span)
        if text[0] not in "+-.0123456789":
            self.report(span, f"`{text[:40]}` is a string and needs double quotes", _replacement(span, quote(text)))
            return JsonString(*span, text, (0, 0))
        number = _number(text)
        if number is None:
            self.report(span, f"`{text[:40]}` is not a number; write for example `1.5` or `-2`")
            return JsonError(*span)
        self.report(span, f"this number must be written as `{number[:40]}` in JSON", _replacement(span, number))
        if number.lstrip("-").isdigit():
            return self.integer(number, *span)
        return JsonNumber(*span, float(number), number)

    def integer(self, text: str, start: int, end: int) -> JsonValue:
        try:
            return JsonNumber(start, end, int(text), text)
        except ValueError:  # Python limits the number of digits
            self.report(Span(start, end), "this number has too many digits")
            return JsonError(start, end)

    def report(self, span: Span, message: str, fix: Fix | None = None, *related: Related) -> None:
        if self.hopeless:
            return
        self.findings.append(Finding("json-syntax", span, message, fixes=(fix,) if fix else (), related=related))
        if len(self.findings) >= MAX_FINDINGS:
            self.give_up()

    def give_up(self) -> NoReturn:
        self.hopeless = True
        raise _HopelessError


def _insertion(at: int, inserted: str) -> Fix:
    return Fix(f"Insert `{inserted[:20]}`", (TextEdit(Span(at, at), inserted),))


def _replacement(span: Span, new_text: str) -> Fix:
    return Fix(f"Write `{new_text[:40]}`", (TextEdit(span, new_text),))


def _removal(span: Span) -> Fix:
    return Fix("Remove it", (TextEdit(span, ""),))


def _number(text: str) -> str | None:
    """`text` in the form of a JSON number, for numbers of other languages such as `+1`, `007`, `.5` and `1.`; `None` if
    it is not a number."""
    match = _SLOPPY_NUMBER.match(text)
    if match is None or not (match[2] or match[3]):
        return None
    sign, integer, fraction, exponent = match.groups()
    number = ("-" if sign == "-" else "") + (integer.lstrip("0") or "0")
    if fraction is not None:
        number += "." + (fraction or "0")
    return number + (f"e{exponent}" if exponent else "")
