# SPDX-License-Identifier: Apache-2.0
"""Any text has a result, in a short time."""

from __future__ import annotations

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.interfaces import KINDS, SECTION_NAMES, Kind, Value, parse
from roaml.interfaces.parse import MAX_LENGTH
from roaml.interfaces.report import MAX_FINDINGS

SNIPPETS = [
    *(
        "int32",
        "string<=",
        "wstring",
        "Point",
        "std_msgs/Header",
        "time",
        "x",
        "my_name",
        "X",
        "=",
        "-",
        "---",
        "#",
        " ",
    ),
    *(
        "\n",
        "\r\n",
        "\r",
        "\t",
        "[",
        "]",
        "[<=",
        "[]",
        "5",
        "-1",
        "1.5",
        "true",
        '"',
        "'",
        "\\",
        ",",
        "\0",
        "é",
        "\ud800",
    ),
]
TEXTS = st.one_of(st.text(), st.lists(st.sampled_from(SNIPPETS), max_size=40).map("".join))


@given(TEXTS, st.sampled_from(KINDS))
def test_any_text(text: str, kind: Kind) -> None:
    definition, findings = parse(text, "p", "N", kind)
    assert len(definition.sections) == len(SECTION_NAMES[kind])
    assert hash(definition) == hash(parse(text, "p", "N", kind)[0])
    spans = [finding.span for finding in findings]
    for finding in findings:
        spans += [edit.span for fix in finding.fixes for edit in fix.edits]
    for section in definition.sections:
        names = [field.name for field in section.fields] + [constant.name for constant in section.constants]
        assert len(set(names)) == len(names)
        for field in section.fields:
            assert text[slice(*field.name_span)].startswith(field.name)
            spans += [field.type_span, field.name_span, field.default_span or field.name_span]
        for constant in section.constants:
            assert text[slice(*constant.name_span)] == constant.name
            spans += [constant.type_span, constant.name_span, constant.value_span]
    assert all(0 <= start <= end <= len(text) for start, end in spans)


@given(TEXTS, st.sampled_from(KINDS))
def test_comments_and_white_space_have_no_meaning(text: str, kind: Kind) -> None:
    definition, findings = parse(text, "p", "N", kind)
    if not findings:
        moved = "# a comment\n\n" + text.replace("\n", "\n\n# another\n")
        assert parse(moved, "p", "N", kind)[0] == definition


@given(st.lists(st.one_of(st.integers(-128, 127), st.sampled_from([True, "a", "", 'q"', "it's", "a, b]", "# \\"]))))
def test_written_values_are_read_again(values: list[Value]) -> None:
    for value in values:
        type_, written = _written(value)
        definition, findings = parse(
            f"{type_} x {written} # c\n{type_}[] y [{written}, {written}] # c", "p", "N", "msg"
        )
        assert not findings
        assert [field.default for field in definition.sections[0].fields] == [value, (value, value)]


def _written(value: Value) -> tuple[str, str]:
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return "string", f'"{escaped}"'
    return ("bool", str(value).lower()) if isinstance(value, bool) else ("int8", str(value))


MEGA = 10_000_000
LONG = {
    "empty lines": "\n" * MEGA,
    "blanks": " " * MEGA,
    "NUL": "\0" * MEGA,
    "a comment": "#" * MEGA,
    "comments": "# abc\n" * (MEGA // 6),
    "a word": "a" * MEGA,
    "an almost-name": "int32 " + "a_" * (MEGA // 2),
    "brackets": "int32[" * (MEGA // 6),
    "bounds": "string<=" * (MEGA // 8),
    "equal signs": "=" * MEGA,
    "dashes": "-" * MEGA,
    "separators": "---\n" * (MEGA // 4),
    "fields": "".join(f"int32 x{i}\n" for i in range(MEGA // 14)),
    "equal fields": "int32 x\n" * (MEGA // 8),
    "digits": "int32 x " + "9" * MEGA,
    "an open string": 'string x "' + '\\"' * (MEGA // 2),
    "an open list": "int32[] x [" + "1," * (MEGA // 2),
    "quotes in a list": "string[] x [" + "\"'," * (MEGA // 3),
}


@pytest.mark.parametrize("text", [text[:length] for text in LONG.values() for length in (MAX_LENGTH, MEGA)])
def test_long_texts_take_little_time(text: str) -> None:
    start = time.process_time()
    _, findings = parse(text, "p", "N", "msg")
    assert time.process_time() - start < 10  # a second at most; what grows with the square takes hours
    assert len(findings) <= MAX_FINDINGS + 10


def test_too_long_a_text_is_reported() -> None:
    text = "int32 x\n" + " \n" * MAX_LENGTH
    definition, findings = parse(text, "p", "N", "msg")
    assert [field.name for field in definition.sections[0].fields] == ["x"]
    assert [finding.message for finding in findings] == [
        "too long for an interface definition; only the first 1,000,000 characters are read"
    ]
