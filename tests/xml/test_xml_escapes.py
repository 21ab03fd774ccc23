# SPDX-License-Identifier: Apache-2.0
"""References: what they mean, and the way back to the source."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lxml import etree

from roaml.text import Span
from roaml.xml_syntax.escapes import decoded, escape, unescape

REFERENCES = [
    # written, meant
    ("a &lt; b", "a < b"),
    ("&amp;&amp;", "&&"),
    ("&quot;&apos;&gt;", "\"'>"),
    ("&#65;&#x41;&#X41;", "AAA"),
    ("&#128512;&#x1F600;", "\U0001f600\U0001f600"),
    ("&amp;lt;", "&lt;"),
    ("&amp", "&amp"),
    ("& amp;", "& amp;"),
    ("&nbsp;", "&nbsp;"),
    ("&LT;", "&LT;"),
    ("&#;&#x;&;", "&#;&#x;&;"),
    ("&#0;&#xFFFE;&#xD800;", "&#0;&#xFFFE;&#xD800;"),
    ("&#1114112;&#99999999;", "&#1114112;&#99999999;"),
    ("&#9;&#10;&#13;", "\t\n\r"),
]


@pytest.mark.parametrize(("written", "meant"), REFERENCES)
def test_unescape(written: str, meant: str) -> None:
    assert unescape(written) == meant


MAPPED = [
    # written; meant, and which part of what is written each of its characters is
    ("ab", "ab", ["a", "b"]),
    ("a&lt;b", "a<b", ["a", "&lt;", "b"]),
    ("&amp;&amp;", "&&", ["&amp;", "&amp;"]),
    ("&lt;", "<", ["&lt;"]),
    ("x&#65;", "xA", ["x", "&#65;"]),
    ("&no;x", "&no;x", ["&", "n", "o", ";", "x"]),
    ("&lt;&", "<&", ["&lt;", "&"]),
    ("", "", []),
]


@pytest.mark.parametrize(("written", "meant", "parts"), MAPPED)
def test_way_back(written: str, meant: str, parts: list[str]) -> None:
    text = f"__{written}__"
    actual_decoded = decoded(text, Span(2, 2 + len(written)))
    assert actual_decoded.text == meant
    spans = [actual_decoded.span(i, i + 1) for i in range(len(meant))]
    assert [text[s.start : s.end] for s in spans] == parts
    assert actual_decoded.span(0, len(meant)) == (2, 2 + len(written))


PIECES = st.lists(st.sampled_from(["a", "<", ">", "&", "&lt;", "&amp;", "&#65;", "&x;", "&#0;", ";", "é"]), max_size=12)


@given(PIECES)
def test_way_back_in_order(pieces: list[str]) -> None:
    text = "".join(pieces)
    actual_decoded = decoded(text, Span(0, len(text)))
    assert actual_decoded.text == unescape(text)
    offsets = [actual_decoded.offset(i) for i in range(len(actual_decoded.text) + 1)]
    assert offsets == sorted(set(offsets))
    assert offsets[-1] == len(text)
    for i, character in enumerate(actual_decoded.text):
        assert unescape(text[offsets[i] : offsets[i + 1]]) == character or character == "&"


VALUES = st.text(st.characters(exclude_categories=["Cs", "Cc"], exclude_characters="\ufffe\uffff"))


@given(VALUES, st.sampled_from("\"'"))
def test_escaped_values_come_back(value: str, quote: str) -> None:
    written = escape(value, quote)
    assert unescape(written) == value
    assert etree.fromstring(f"<a b={quote}{written}{quote}/>").get("b") == value
