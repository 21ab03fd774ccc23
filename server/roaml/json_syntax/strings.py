# SPDX-License-Identifier: Apache-2.0
"""JSON strings: resolving their escapes and writing them (RFC 8259, section 7)."""

from __future__ import annotations

import re
from json.encoder import encode_basestring
from typing import NamedTuple

from roaml.regex import regex
from roaml.text import Span, TextEdit

_SIMPLE_ESCAPES = {
    '"': '"',
    "\\": "\\",
    "/": "/",
    "b": "\b",
    "f": "\f",
    "n": "\n",
    "r": "\r",
    "t": "\t",
}
_SPECIAL = regex(
    r"\\u([dD][89abAB][0-9a-fA-F]{2})\\u([dD][c-fC-F][0-9a-fA-F]{2})"  # two halves of one character
    r"|\\u([0-9a-fA-F]{4})"
    r'|\\(["\\/bfnrt])'
    r"|(\\.?)"
    r"|([\x00-\x1f])",
    re.DOTALL,
)
_SURROGATE = regex("[\ud800-\udfff]")


class StringProblem(NamedTuple):
    """A character or an escape that is not allowed in a string, with the edit that replaces it."""

    message: str
    edit: TextEdit


def unescape(raw: str, start: int) -> tuple[str, list[StringProblem]]:
    """The value of `raw`, the text between the quotes, and the errors in it. `start` is its offset in the source.

    For an invalid escape, the character after the backslash is kept; a control character is unchanged.
    """
    problems: list[StringProblem] = []

    def resolve(match: re.Match[str]) -> str:
        high, low, code, simple, wrong, control = match.groups()
        if high:
            return chr(0x10000 + ((int(high, 16) & 0x3FF) << 10) + (int(low, 16) & 0x3FF))
        if code:
            return chr(int(code, 16))
        if simple:
            return _SIMPLE_ESCAPES[simple]
        span = Span(start + match.start(), start + match.end())
        if control:
            written = quote(control)[1:-1]
            problems.append(
                StringProblem(f"inside a string this character must be written as `{written}`", TextEdit(span, written))
            )
            return control
        message = (
            "`\\u` must be followed by four hexadecimal digits"
            if wrong == "\\u"
            else f"JSON has no escape `{wrong}`; a backslash itself is written `\\\\`"
        )
        problems.append(StringProblem(message, TextEdit(span, "\\" + wrong)))
        return wrong[1:]

    return _SPECIAL.sub(resolve, raw), problems


def quote(text: str) -> str:
    """`text` as a JSON string: only what must be escaped is escaped, including lone surrogates."""
    quoted: str = encode_basestring(text)
    if text.isascii():
        return quoted
    return _SURROGATE.sub(lambda match: f"\\u{ord(match[0]):04x}", quoted)
