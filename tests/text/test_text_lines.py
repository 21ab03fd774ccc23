# SPDX-License-Identifier: Apache-2.0
"""Offsets and positions: `LineIndex` against a count by hand."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.text import LineIndex, Position, Span

LINES = [
    # text, the lines with their end marks
    ("", [""]),
    ("a", ["a"]),
    ("a\n", ["a\n", ""]),
    ("\n", ["\n", ""]),
    ("a\nb", ["a\n", "b"]),
    ("a\r\nb", ["a\r\n", "b"]),
    ("a\rb", ["a\r", "b"]),
    ("a\n\rb", ["a\n", "\r", "b"]),
    ("a\r\r\nb\n\n", ["a\r", "\r\n", "b\n", "\n", ""]),
    ("a\u2028b\x0bc\x0cd\x85e", ["a\u2028b\x0bc\x0cd\x85e"]),
    ("\U0001f600\né", ["\U0001f600\n", "é"]),
]


@pytest.mark.parametrize(("text", "lines"), LINES, ids=repr)
def test_lines(text: str, lines: list[str]) -> None:
    index = LineIndex(text)
    assert index.line_count == len(lines)
    assert [text[index.line_start(i) : index.line_end(i)] for i in range(len(lines))] == lines


POSITIONS = [
    # text, offset, position
    ("ab\ncd", 0, (0, 0)),
    ("ab\ncd", 2, (0, 2)),
    ("ab\ncd", 3, (1, 0)),
    ("ab\ncd", 5, (1, 2)),
    ("ab\r\ncd", 4, (1, 0)),
    ("ab\rcd", 3, (1, 0)),
    ("\U0001f600x\ny", 2, (0, 2)),
    ("a\n", 2, (1, 0)),
]


@pytest.mark.parametrize(("text", "offset", "position"), POSITIONS)
def test_position_and_back(text: str, offset: int, position: tuple[int, int]) -> None:
    index = LineIndex(text)
    assert index.position(offset) == position
    assert index.offset(Position(*position)) == offset


OUTSIDE = [
    # text, position, offset
    ("ab\ncd", (0, 99), 2),
    ("ab\r\ncd", (0, 99), 2),
    ("ab\rcd", (0, 99), 2),
    ("ab\ncd", (1, 99), 5),
    ("ab\n", (1, 99), 3),
    ("ab\ncd", (9, 0), 5),
    ("ab\ncd", (-1, 5), 0),
    ("ab\ncd", (1, -5), 3),
    ("", (0, 1), 0),
    ("", (7, 7), 0),
]


@pytest.mark.parametrize(("text", "position", "offset"), OUTSIDE)
def test_positions_outside_the_text(text: str, position: tuple[int, int], offset: int) -> None:
    assert LineIndex(text).offset(Position(*position)) == offset


@pytest.mark.parametrize(("offset", "position"), [(-3, (0, 0)), (99, (1, 2))])
def test_offsets_outside_the_text(offset: int, position: tuple[int, int]) -> None:
    assert LineIndex("ab\ncd").position(offset) == position


@given(st.text(alphabet="a\r\né\U0001f600\u2028", max_size=40))
def test_every_offset(text: str) -> None:
    index = LineIndex(text)
    line = column = 0
    for offset in range(len(text) + 1):
        assert index.position(offset) == (line, column)
        between = text[offset - 1 : offset + 1] == "\r\n"
        assert index.offset(Position(line, column)) == offset - between
        character, following = text[offset : offset + 1], text[offset + 1 : offset + 2]
        if character == "\n" or (character == "\r" and following != "\n"):
            line, column = line + 1, 0
        else:
            column += 1


@pytest.mark.parametrize(("offset", "touches"), [(1, False), (2, True), (3, True), (4, True), (5, False)])
def test_caret_touches_span(offset: int, touches: bool) -> None:
    assert Span(2, 4).contains(offset) is touches


@pytest.mark.parametrize(
    ("one", "other", "cover"), [((1, 2), (5, 6), (1, 6)), ((5, 6), (1, 2), (1, 6)), ((1, 9), (3, 4), (1, 9))]
)
def test_cover(one: tuple[int, int], other: tuple[int, int], cover: tuple[int, int]) -> None:
    assert Span(*one).cover(Span(*other)) == cover
