# SPDX-License-Identifier: Apache-2.0
"""The tolerant JSON parser: its results, its messages, and that it accepts any text."""

from __future__ import annotations

import json
import shutil
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from roaml.explicit.plain import plain_module
from roaml.json_syntax import (
    MAX_DEPTH,
    JsonArray,
    JsonBool,
    JsonError,
    JsonNull,
    JsonNumber,
    JsonObject,
    JsonString,
    JsonValue,
    Member,
    frequent,
    parse,
)
from roaml.json_syntax.brackets import Bracket
from roaml.json_syntax.parse import _Parser
from roaml.text import Span, apply_edits


def plain(value: JsonValue) -> Any:
    """The result of `json.loads`."""
    match value:
        case JsonObject():
            return {member.key: plain(member.value) for member in value.members if member.value is not None}
        case JsonArray():
            return [plain(item) for item in value.items]
        case JsonString() | JsonNumber() | JsonBool():
            return value.value
        case JsonNull():
            return None
        case JsonError():
            return "?"


def spans(value: JsonValue) -> Iterator[Span]:
    stack: list[JsonValue] = [value]
    while stack:
        item = stack.pop()
        yield item.span
        match item:
            case JsonObject():
                for member in item.members:
                    yield from (member.key_span, member.key_content_span, member.span)
                    if member.value is not None:
                        stack.append(member.value)
            case JsonArray():
                stack.extend(item.items)
            case JsonString():
                yield item.content_span


# Text, markers under what is reported, the messages, what was understood, and the text after all fixes were made.
MISTAKES = [
    (
        """
        {"a": 1 "b": 2}
                ^ a comma is missing before this value
        """,
        {"a": 1, "b": 2},
        '{"a": 1, "b": 2}',
    ),
    (
        """
        [1, 2, ]
             ^ unexpected comma before `]`
        """,
        [1, 2],
        "[1, 2 ]",
    ),
    (
        """
        [1,, ,2, 3]
           ^^^ surplus comma; remove it
        """,
        [1, 2, 3],
        "[1,2, 3]",
    ),
    (
        """
        [,1]
         ^ unexpected comma; remove it
        """,
        [1],
        "[1]",
    ),
    (
        """
        {"a" 1}
         ^^^ `:` must follow `a`
        """,
        {"a": 1},
        '{"a": 1}',
    ),
    (
        """
        {"a" = 1, "b" => 2}
             ^ a name must be followed by `:`
                      ^^ a name must be followed by `:`
        """,
        {"a": 1, "b": 2},
        '{"a" : 1, "b" : 2}',
    ),
    (
        """
        {"a": , "b": 2, "c":}
         ^^^ a value must follow `a`
                        ^^^ a value must follow `c`
        """,
        {"b": 2},
        None,
    ),
    (
        """
        {"fu
         ^^^ the string has no closing `"`
         ^^^ `:` and a value must follow `fu`
        "b": 2}
        """,
        {"b": 2},
        None,
    ),
    (
        """
        {'a': 'it''s'}
         ^^^ a string needs double quotes
              ^^^^ a string needs double quotes
                  ^ a comma is missing before this value
                  ^^^ a string needs double quotes
                  ^^^ `:` and a value must follow `s`
        """,
        {"a": "it"},
        None,
    ),
    (
        """
        {'say "hi"': 'it\\'s'}
         ^^^^^^^^^^ a string needs double quotes
                     ^^^^^^^ a string needs double quotes
        """,
        {'say "hi"': "it's"},
        '{"say \\"hi\\"": "it\'s"}',
    ),
    (
        """
        {name: a < b, seen: true}
         ^^^^ a name needs double quotes
               ^^^^^ `a < b` is a string and needs double quotes
                      ^^^^ a name needs double quotes
        """,
        {"name": "a < b", "seen": True},
        '{"name": "a < b", "seen": true}',
    ),
    (
        """
        [1, // one
            ^^^^^^ JSON does not support comments
        2, /* two */ 3 # three
           ^^^^^^^^^ JSON does not support comments
                       ^^^^^^^ JSON does not support comments
        ]
        """,
        [1, 2, 3],
        "[1, \n2,  3 \n]",
    ),
    (
        """
        {"a": "open,
              ^^^^^ the string has no closing `"`
         "b": 1}
        """,
        {"a": "open", "b": 1},
        '{"a": "open",\n "b": 1}',
    ),
    (
        """
        ["\\d", "\\u12", "\\u12x4", "c:\\temp"]
          ^^ JSON has no escape `\\d`; a backslash itself is written `\\\\`
                ^^ `\\u` must be followed by four hexadecimal digits
                        ^^ `\\u` must be followed by four hexadecimal digits
        """,
        ["d", "u12", "u12x4", "c:\temp"],
        '["\\\\d", "\\\\u12", "\\\\u12x4", "c:\\temp"]',
    ),
    (
        """
        ["a\tb"]
           ^ inside a string this character must be written as `\\t`
        """,
        ["a\tb"],
        '["a\\tb"]',
    ),
    (
        """
        [NaN, -Infinity, 007, .5, 1., +2, -.5e3, 0x10, 1-2]
         ^^^ JSON does not support the number `NaN`
              ^^^^^^^^^ JSON does not support the number `-Infinity`
                         ^^^ this number must be written as `7` in JSON
                              ^^ this number must be written as `0.5` in JSON
                                  ^^ this number must be written as `1.0` in JSON
                                      ^^ this number must be written as `2` in JSON
                                          ^^^^^ this number must be written as `-0.5e3` in JSON
                                                 ^^^^ `0x10` is not a number; write for example `1.5` or `-2`
                                                       ^^^ `1-2` is not a number; write for example `1.5` or `-2`
        """,
        ["?", "?", 7, 0.5, 1.0, 2, -500.0, "?", "?"],
        "[NaN, -Infinity, 7, 0.5, 1.0, 2, -0.5e3, 0x10, 1-2]",
    ),
    (
        """
        [True, None, undefined]
         ^^^^ `True` is not a JSON literal; write `true`
               ^^^^ `None` is not a JSON literal; write `null`
                     ^^^^^^^^^ `undefined` is a string and needs double quotes
        """,
        [True, None, "undefined"],
        '[true, null, "undefined"]',
    ),
    (
        """
        {"a": 1} and more
                 ^^^^^^^^ unexpected text after the value; a file contains one value
        """,
        {"a": 1},
        '{"a": 1} ',
    ),
    (
        """
        {"a": [1, 2}
                   ^ `]` is missing before `}`
        """,
        {"a": [1, 2]},
        '{"a": [1, 2]}',
    ),
    (
        """
        [1, 2}]
             ^ `}` closes no bracket; remove it
        """,
        [1, 2],
        "[1, 2]",
    ),
    (
        """
        {"a": [1, {"b": 2
                  ^ `{` is never closed; `}]}` is missing at the end
        """,
        {"a": [1, {"b": 2}]},
        '{"a": [1, {"b": 2}]}',
    ),
    (
        """
        ["a": 1]
         ^^^ a name with a value is only allowed in `{ }`
              ^ a comma is missing before this value
        """,
        ["a", 1],
        None,
    ),
    (
        """
        {1, [2], {"a": 3}}
         ^ a name is missing before this value
            ^ a name is missing before this bracket
                 ^ a name is missing before this bracket
        """,
        None,
        None,
    ),
    (
        """
        [1; 2]
          ^ values must be separated by commas
        """,
        [1, 2],
        "[1, 2]",
    ),
    (
        """
        [1,\u00a02 :]
           ^ this character is not white space in JSON
              ^ unexpected colon; remove it
        """,
        [1, 2],
        "[1, 2 ]",
    ),
    (
        """
        {"a": 1, "a": 2}
                 ^^^ duplicate key `a`; only the last value is used
        """,
        {"a": 2},
        None,
    ),
]


@pytest.mark.parametrize(("marked", "understood", "mended"), MISTAKES, ids=lambda value: str(value).strip()[:24])
def test_mistakes(marked: str, understood: Any, mended: str | None) -> None:
    lines = textwrap.dedent(marked).strip("\n").split("\n")
    text, expected = "", []
    line_start = 0
    for line in lines:
        if line.lstrip().startswith("^"):
            column = line.index("^")
            carets, message = line.strip().split(" ", 1)
            expected.append((Span(line_start + column, line_start + column + len(carets)), message))
        else:
            line_start = len(text) + 1 if text else 0
            text += ("\n" if text else "") + line
    value, findings = parse(text)
    assert sorted((finding.span, finding.message) for finding in findings) == sorted(expected)
    if understood is not None:
        assert plain(value) == understood
    if mended is not None:
        edits = tuple(edit for finding in findings for fix in finding.fixes for edit in fix.edits)
        assert apply_edits(text, edits) == mended


def test_values_know_their_place() -> None:
    value, findings = parse(' {"a" : [1, -2.50, "x\\n"], "b":null}')
    assert findings == ()
    assert value == JsonObject(
        1,
        36,
        (
            Member(
                "a",
                2,
                5,
                JsonArray(
                    8,
                    25,
                    (
                        JsonNumber(9, 10, 1, "1"),
                        JsonNumber(12, 17, -2.5, "-2.50"),
                        JsonString(19, 24, "x\n"),
                    ),
                ),
            ),
            Member("b", 27, 30, JsonNull(31, 35)),
        ),
    )
    assert isinstance(value, JsonObject)
    assert value.members[0].span == (2, 25)
    assert value.members[0].key_span == (2, 5)
    assert value.get("b") == JsonNull(31, 35)
    assert value.get("c") is None


def test_the_last_of_two_members_with_equal_names_is_used() -> None:
    value, findings = parse('{"a": 1, "a": 2}')
    assert isinstance(value, JsonObject)
    assert value.get("a") == JsonNumber(14, 15, 2, "2")
    assert [finding.code for finding in findings] == ["duplicate-json-key"]
    assert findings[0].related[0].place == (1, 4)


@pytest.mark.parametrize(("text", "message"), [("", "the file is empty"), (" \n\t", "the file is empty")])
def test_nothing(text: str, message: str) -> None:
    value, findings = parse(text)
    assert value == JsonError(0, len(text))
    assert [(finding.span, finding.message) for finding in findings] == [((0, len(text)), message)]


@pytest.mark.parametrize("brackets", ["[" * 100_000, '{"a":' * 100_000, "[" * 50_000 + "]" * 50_000])
def test_deep_nesting_is_one_finding(brackets: str) -> None:
    _, findings = parse(brackets)
    assert [finding.message for finding in findings] == [
        f"nested too deeply: at most {MAX_DEPTH} brackets may be open",
    ]


def test_nesting_up_to_the_limit() -> None:
    value, findings = parse("[" * MAX_DEPTH + "]" * MAX_DEPTH)
    assert findings == ()
    for _ in range(MAX_DEPTH - 1):
        assert isinstance(value, JsonArray)
        (value,) = value.items
    assert value == JsonArray(MAX_DEPTH - 1, MAX_DEPTH + 1, ())


def test_huge_numbers() -> None:
    value, findings = parse("1e400")
    assert (plain(value), findings) == (float("inf"), ())
    value, findings = parse("1" * 5000)
    assert isinstance(value, JsonError)
    assert [finding.message for finding in findings] == ["this number has too many digits"]


def test_nulls_in_lists_and_elsewhere() -> None:
    value, findings = parse('[null,null,null,"a",null]')
    assert (plain(value), findings) == ([None, None, None, "a", None], ())
    assert isinstance(value, JsonArray)
    assert [item.span for item in value.items] == [(1, 5), (6, 10), (11, 15), (16, 19), (20, 24)]
    assert (value.length, list(value.items_but_nulls)) == (5, [(3, JsonString(16, 19, "a"))])
    value, findings = parse("[1 null,null,null , null,null]")
    assert isinstance(value, JsonArray)
    assert (plain(value), value.length) == ([1, None, None, None, None, None], 6)
    assert [finding.message for finding in findings] == ["a comma is missing before this value"]
    value, findings = parse('{"a":null,null}')
    assert plain(value) == {"a": None, "": None}
    assert [finding.span for finding in findings] == [(10, 14)]


@pytest.mark.parametrize(
    "text",
    [
        '"' + "\\" * 200_001,
        "'" * 200_000,
        "[" + "1 " * 200_000,
        "{" + "a:" * 200_000,
        " " * 400_000 + "x",
        "/*" * 200_000,
        "[1" + "," * 400_000,
        "[" + "\n" * 400_000 + "x y",
        "1" * 4000 + "x" * 400_000,
        "[" + '"\\x" ' * 100_000,
        "null," * 100_000 + "nul",
        "[" + "null," * 100_000 + "nul",
    ],
    ids=lambda text: text[:4],
)
def test_long_mistakes(text: str) -> None:
    """If an error took quadratic time, this test would take very long."""
    _, findings = parse(text)
    assert findings


SCRAPS = st.sampled_from(
    [*"{}[]:,\"'\\/#* \t\n\u00a0-+.0123456789eE", '"a"', "null", "true", "NaN", '"b":', "//", "\\u", "x"]
)
TEXTS = st.one_of(st.text(max_size=60), st.lists(SCRAPS, max_size=40).map("".join))


def refuse(text: str) -> Any:
    raise ValueError(text)


@given(TEXTS)
@example("\ufeff{}")
@example("-")
@example('{"a":null,null}')
@example("[\x00]")
@example("'")
@example('{"a" [' + "1 " * 200)
def test_any_text(text: str) -> None:
    """The parser never raises, keeps all spans in the text, and reports findings exactly for texts that are not
    JSON."""
    value, findings = parse(text)
    places = [*spans(value), *(finding.span for finding in findings)]
    places += [edit.span for finding in findings for fix in finding.fixes for edit in fix.edits]
    places += [related.place for finding in findings for related in finding.related if isinstance(related.place, Span)]
    assert all(0 <= start <= end <= len(text) for start, end in places)
    try:
        expected = json.loads(text, parse_constant=refuse)
    except ValueError:
        assert any(finding.code == "json-syntax" for finding in findings)
    else:
        assert not any(finding.code == "json-syntax" for finding in findings)
        assert plain(value) == expected


DOCUMENTS = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(DOCUMENTS, st.sampled_from([None, 1, 2]), st.booleans(), st.sampled_from([None, (",", ":")]))
def test_agrees_with_the_standard_library(
    document: Any, indent: int | None, ascii_only: bool, separators: tuple[str, str] | None
) -> None:
    text = json.dumps(document, indent=indent, ensure_ascii=ascii_only, separators=separators)
    value, findings = parse(text)
    assert findings == ()
    assert plain(value) == document


@given(DOCUMENTS, st.data())
def test_half_typed_documents(document: Any, data: st.DataObject) -> None:
    """A document that is cut off, or lacks a character, still has its spans in order."""
    text = json.dumps(document)
    cut = data.draw(st.integers(0, len(text)))
    for damaged in (text[:cut], text[:cut] + text[cut + 1 :]):
        value, findings = parse(damaged)
        assert all(0 <= start <= end <= len(damaged) for start, end in spans(value))
        assert list(findings) == sorted(findings, key=lambda finding: finding.span)


PIECES = (
    *("{", "}", "[", "]", ",", ":", " ", "\n", ";", "=", "//c\n", "'q'", '"', "x", "+1", "\ufeff"),
    *('"a"', '"a":', '"b" :', "null", "null,null", "1", "-2.5", "true", "123456789012345678901", '"a":1,', '"\\n"'),
)
FRAGMENTS = st.lists(st.sampled_from(PIECES), max_size=8).map("".join)
BRACKETS = st.recursive(
    FRAGMENTS,
    lambda inner: st.tuples(st.sampled_from(("[{}]", '{{"k":{}}}')), st.lists(inner, max_size=3)).map(
        lambda parts: parts[0].format(",".join(parts[1]))
    ),
)


class _WithoutFastForm(_Parser):
    def frequent(self, at: int) -> int:
        return at


@given(BRACKETS)
@example("][null,nullnull;1{")
@example('{"a" {"b":1}}')
@example('[[1,,{"a":1 "b":true}]')
def test_the_fast_form_agrees_with_the_general_one(text: str) -> None:
    general = _WithoutFastForm(text)
    value = general.run()
    assert parse(text) == (value, tuple(sorted(general.findings, key=lambda finding: finding.span)))


def test_is_compiled_where_there_is_a_compiler() -> None:
    assert frequent.compiled() or shutil.which("cc") is None, "pip install -e . compiles it"
    assert not PLAIN.compiled()


PLAIN = plain_module("plain_frequent", Path(frequent.__file__).with_name("frequent.py"))


@given(BRACKETS)
@example("null,null,null,nullx")
@example('{"a":-0,"b":1.50,"c":01')
@example('"a","b":1')
@example("1.")
@example("[-")
@example("1234567890123456789")
@example('{"a":1,"b":{"a":2,"a":3}}')
@example('{"a\\n":1}')  # an escape
@example('{"a":"\u2028","a":tru,"b":false}')
@example("[" * 1200)
def test_the_compiled_form_agrees_with_plain_python(text: str) -> None:
    ended, results = f"[{text}{frequent.END}", []
    for read in (frequent.read_frequent, PLAIN.read_frequent):
        stack = [Bracket(0, False, [], None)]
        results.append((read(ended, 1, stack, 0, False, [], {}), stack))
    assert results[0] == results[1]
