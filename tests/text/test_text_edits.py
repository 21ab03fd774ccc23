# SPDX-License-Identifier: Apache-2.0
"""Edits of a text, and the way back from text whose escapes were resolved."""

from __future__ import annotations

import pytest

from roaml.text import Decoded, Span, TextEdit, apply_edits

EDITS = [
    # edits of "abcdef", result
    ([], "abcdef"),
    ([(0, 0, "x")], "xabcdef"),
    ([(6, 6, "x")], "abcdefx"),
    ([(1, 3, "")], "adef"),
    ([(1, 3, "xyz")], "axyzdef"),
    ([(0, 6, "")], ""),
    ([(3, 4, "y"), (0, 1, "x")], "xbcyef"),
    ([(2, 2, "x"), (2, 2, "y")], "abxycdef"),
    ([(1, 3, "x"), (3, 5, "y")], "axyf"),
    ([(3, 3, "x"), (1, 3, "y")], "ayxdef"),
    # Of two that overlap the earlier one wins.
    ([(1, 4, "x"), (3, 5, "y")], "axef"),
    ([(3, 5, "y"), (1, 4, "x")], "axef"),
]


@pytest.mark.parametrize(("edits", "result"), EDITS)
def test_apply_edits(edits: list[tuple[int, int, str]], result: str) -> None:
    assert apply_edits("abcdef", tuple(TextEdit(Span(a, b), text) for a, b, text in edits)) == result


def test_decoded_without_escapes() -> None:
    decoded = Decoded("abc", 10)
    assert [decoded.offset(i) for i in range(4)] == [10, 11, 12, 13]
    assert decoded.span(1, 3) == (11, 13)


def test_decoded_with_escapes() -> None:
    decoded = Decoded("a<b", 10, (10, 11, 15, 16))
    assert [decoded.offset(i) for i in range(4)] == [10, 11, 15, 16]
    assert decoded.span(0, 1) == (10, 11)
    assert decoded.span(1, 2) == (11, 15)
    assert decoded.span(1, 3) == (11, 16)
