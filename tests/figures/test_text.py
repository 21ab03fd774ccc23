# SPDX-License-Identifier: Apache-2.0
"""Widths of texts, and their lines."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from examples import examples
from roaml.figures.text import text_width, wrap


def test_widths() -> None:
    assert text_width("", 12) == 0
    assert text_width("i", 10) < text_width("m", 10) < text_width("m", 10, bold=True)
    assert text_width("ab", 20) == 2 * text_width("ab", 10)
    assert text_width("漢", 10) > text_width("m", 10)
    assert text_width("e\u0301", 10) == text_width("e", 10)
    assert text_width("Überprüfung é", 10) == pytest.approx(text_width("Uberprufung e", 10))


def test_lines() -> None:
    assert wrap("[level < 30 && charging]", 10, 80) == ("[level < 30 &&", "charging]")
    assert wrap("/navigation/GoToPosition", 10, 85) == ("/navigation/", "GoToPosition")
    assert wrap("PeopleDetectorFilter", 10, 80) == ("PeopleDetector", "Filter")
    assert wrap("one two three four five", 10, 60, limit=2) == ("one two", "three four…")
    assert wrap("short", 10, 100, limit=1) == ("short",)


@settings(max_examples=examples(100), deadline=None)
@given(st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc", "Zs", "Zl", "Zp")), min_size=1))
def test_no_character_is_lost(text: str) -> None:
    lines = wrap(text, 10, 60)
    assert "".join(lines) == text
    assert all(text_width(line, 10) <= 60 for line in lines)
