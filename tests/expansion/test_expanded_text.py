# SPDX-License-Identifier: Apache-2.0
"""Every place in an expanded text leads back to the text of the user."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from roaml.expansion.text import ExpandedText, expanded_text
from roaml.text import Span, TextEdit


@st.composite
def texts(draw: st.DrawFn) -> tuple[str, ExpandedText]:
    """A text of different characters, and its expansion. New texts have other characters."""
    length = draw(st.integers(0, 30))
    text = "".join(chr(ord("a") + number) if number < 26 else chr(ord("A") + number - 26) for number in range(length))
    ends = draw(st.lists(st.integers(0, length), max_size=8).filter(lambda ends: len(ends) % 2 == 0))
    ordered = sorted(ends)
    edits = [
        TextEdit(Span(start, end), draw(st.text("01", max_size=4)))
        for start, end in zip(ordered[::2], ordered[1::2], strict=True)
        if start < end
    ]
    return text, expanded_text("new", "old", text, edits)


@given(texts())
def test_a_kept_character_leads_to_itself(case: tuple[str, ExpandedText]) -> None:
    text, expanded = case
    for offset, character in enumerate(expanded.text):
        span = Span(offset, offset + 1)
        origin = expanded.origin(span)
        if character in "01":
            assert any(edit == origin for edit, _ in expanded.edits)
            assert not expanded.is_written(span)
        else:
            assert text[origin.start : origin.end] == character
            assert expanded.is_written(span)


@given(texts(), st.data())
def test_a_span_leads_to_a_span_around_its_characters(case: tuple[str, ExpandedText], data: st.DataObject) -> None:
    text, expanded = case
    start = data.draw(st.integers(0, len(expanded.text)))
    end = data.draw(st.integers(start, len(expanded.text)))
    origin = expanded.origin(Span(start, end))
    assert 0 <= origin.start <= origin.end <= len(text)
    kept = [c for c in expanded.text[start:end] if c not in "01"]
    assert set(kept) <= set(text[origin.start : origin.end])


def test_of_overlapping_edits_the_first_is_made() -> None:
    edits = [TextEdit(Span(2, 4), "X"), TextEdit(Span(0, 3), "Y")]
    assert expanded_text("new", "old", "abcdef", edits).text == "Ydef"
