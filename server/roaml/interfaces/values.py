# SPDX-License-Identifier: Apache-2.0
"""The values of constants and defaults: text -> Python value of the field's type.

- Never fails; an invalid value is `None` and reported with its span.
- Strings may be quoted, `"..."` or `'...'`, or unquoted up to the comment. Escapes are resolved only in quotes.
- Numbers are checked against the range of their type; floats must be finite.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from roaml.interfaces.report import FileFindings, shorten
from roaml.interfaces.types import FLOATS, INTEGER_RANGES, STRINGS, ArrayKind, FieldType, Scalar, Value
from roaml.regex import regex
from roaml.text import Span

_QUOTED = r'"[^"\\\r\n]*(?:\\.[^"\\\r\n]*)*"' + r"|'[^'\\\r\n]*(?:\\.[^'\\\r\n]*)*'"
_STRING = regex(_QUOTED)
_LIST = regex(rf"\[(?:[^\]\"'#]+|{_QUOTED})*\]?")
_INTEGER = regex(r"[+-]?(?:[0-9]+|0[xX][0-9a-fA-F]+|0[oO][0-7]+|0[bB][01]+)")
_FLOAT = regex(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_ESCAPE = regex(r"\\(?:x([0-9a-fA-F]{2})|u((?![dD][89a-fA-F])[0-9a-fA-F]{4})|([abfnrtv\\\"']))")
_SIMPLE_ESCAPES = dict(zip("abfnrtv\\\"'", "\a\b\f\n\r\t\v\\\"'", strict=True))
_BOOLS = {"true": True, "1": True, "false": False, "0": False}
_GREATEST_FLOAT = {"float32": 3.4028234663852886e38, "float64": 1.7976931348623157e308}
_MAX_DIGITS = 1000
"""The maximum number of characters of an integer; longer ones are outside of all ranges."""


def skip_blanks(text: str, start: int, end: int) -> int:
    """The offset of the first character between `start` and `end` that is not a blank or tab; `end` if there is
    none."""
    while start < end and text[start] in " \t":
        start += 1
    return start


def value_end(text: str, start: int, line_end: int) -> int:
    """The end of the value that begins at `start`: before the comment, if any, and the white space before it.

    A `#` inside the quotes of a string or of an element of a list does not begin a comment.
    """
    comment_from = start
    if opening := _STRING.match(text, start, line_end) or _LIST.match(text, start, line_end):
        comment_from = opening.end()
    comment = text.find("#", comment_from, line_end)
    end = line_end if comment < 0 else comment
    return start + len(text[start:end].rstrip())


def parse_value(text: str, span: Span, type_: FieldType, report: FileFindings) -> Value | None:
    """The value in `text[span]`, or `None` with a finding. The value of an array is a tuple.

    A nested message cannot be written as a literal, so any value for it is an error.
    """
    if not type_.is_primitive:
        report.add(
            span, f"a field of the message type `{shorten(type_.name)}` cannot have a default; only primitive types can"
        )
        return None
    if type_.is_array:
        return _array(text, span, type_, report)
    if text.startswith("[", span.start) and type_.name not in STRINGS:
        report.add(
            span, f"`{type_}` is not an array, so its value cannot be a list; use the type `{type_}[]` or `{type_}[N]`"
        )
        return None
    return parse_scalar(text, span, type_, report)


def parse_scalar(text: str, span: Span, type_: FieldType, report: FileFindings) -> Scalar | None:
    """The single value in `text[span]`, of a primitive type that is not an array, or `None` with a finding."""
    written = text[span.start : span.end]
    if type_.name in STRINGS:
        return _string(written, span, type_, report)
    if not written:
        report.add(span, f"a value of type `{type_}` is missing")
        return None
    if type_.name in INTEGER_RANGES:
        return _integer(written, span, type_.name, report)
    if type_.name in FLOATS:
        return _float(written, span, type_.name, report)
    value = _BOOLS.get(written.lower())
    if value is None:
        report.add(span, f"`{shorten(written)}` is not a bool; write `true` or `false`")
    return value


def _array(text: str, span: Span, type_: FieldType, report: FileFindings) -> tuple[Scalar, ...] | None:
    opening = _LIST.match(text, span.start, span.end)
    if not opening:
        report.add(
            span, f"the default of an array must be a list in brackets: `[{shorten(text[span.start : span.end])}]`"
        )
        return None
    if not opening[0].endswith("]"):
        report.add(span, "the list has no closing `]`")
        return None
    if opening.end() < span.end:
        report.add(Span(opening.end(), span.end), "unexpected text after the list; only a comment may follow")
        return None
    spans = list(_element_spans(text, span.start + 1, opening.end() - 1))
    if type_.array is ArrayKind.FIXED and len(spans) != type_.size:
        report.add(span, f"`{type_}` must have exactly {type_.size} elements, not {len(spans)}")
        return None
    if type_.array is ArrayKind.BOUNDED and len(spans) > (type_.size or 0):
        report.add(span, f"`{type_}` must have at most {type_.size} elements, not {len(spans)}")
        return None
    values: list[Scalar] = []
    for element in spans:
        value = parse_scalar(text, element, type_.element, report)
        if value is not None:
            values.append(value)
        elif report.is_full:
            break
    return tuple(values) if len(values) == len(spans) else None


def _element_spans(text: str, start: int, end: int) -> Iterator[Span]:
    """The elements between the brackets of a list; a comma inside quotes is not a separator."""
    at = skip_blanks(text, start, end)
    if at == end:
        return
    while True:
        quoted = _STRING.match(text, at, end)
        comma = text.find(",", quoted.end() if quoted else at, end)
        stop = end if comma < 0 else comma
        yield Span(at, at + len(text[at:stop].rstrip()))
        if comma < 0:
            return
        at = skip_blanks(text, comma + 1, end)


def _integer(written: str, span: Span, type_name: str, report: FileFindings) -> int | None:
    low, high = INTEGER_RANGES[type_name]
    if type_name == "char" and len(written) == 3 and written[0] == written[2] == "'" and ord(written[1]) <= high:
        code = str(ord(written[1]))
        report.add(span, f"in ROS 2, a `char` is a number from {low} to {high}; write `{code}`", instead=code)
        return None
    if not _INTEGER.fullmatch(written):
        report.add(span, f"`{shorten(written)}` is not an integer; a `{type_name}` is an integer from {low} to {high}")
        return None
    # Base 0 accepts the prefixes but rejects the leading zeros that ROS allows.
    digits = written.lstrip("+-")
    base = 10 if digits.isdecimal() else 0
    value = int(written, base) if len(written) <= _MAX_DIGITS else None
    if value is None or not low <= value <= high:
        report.add(span, f"`{shorten(written)}` does not fit into `{type_name}`, whose range is {low} to {high}")
        return None
    return value


def _float(written: str, span: Span, type_name: str, report: FileFindings) -> float | None:
    if not _FLOAT.fullmatch(written):
        report.add(span, f"`{shorten(written)}` is not a number; write for example `1.5`, `-2` or `1e-3`")
        return None
    value = float(written)
    if abs(value) > _GREATEST_FLOAT[type_name]:
        greatest = f"{_GREATEST_FLOAT[type_name]:.2g}"
        report.add(
            span, f"`{shorten(written)}` is out of the range of `{type_name}`, whose greatest value is {greatest}"
        )
        return None
    return value


def _string(written: str, span: Span, type_: FieldType, report: FileFindings) -> str | None:
    value = written
    if written.startswith(('"', "'")):
        quoted = _STRING.match(written)
        if not quoted:
            report.add(span, f"the string has no closing `{written[0]}`")
            return None
        if quoted.end() < len(written):
            rest = Span(span.start + quoted.end(), span.end)
            report.add(
                rest, f"the string ends before this text; inside a string, write `\\{written[0]}` for `{written[0]}`"
            )
            return None
        value = _ESCAPE.sub(_unescape, written[1:-1])
    if type_.string_bound is not None and len(value) > type_.string_bound:
        report.add(span, f"the string has {len(value)} characters, but `{type_}` allows at most {type_.string_bound}")
        return None
    return value


def _unescape(escape: re.Match[str]) -> str:
    if code := escape[1] or escape[2]:
        return chr(int(code, 16))
    return _SIMPLE_ESCAPES[escape[3]]
