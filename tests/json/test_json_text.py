# SPDX-License-Identifier: Apache-2.0
"""Writing JSON: strings and layout."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roaml.json_syntax import indented, parse, quote
from roaml.json_syntax.values import JsonString


@pytest.mark.parametrize(
    ("text", "quoted"),
    [
        ("plain", '"plain"'),
        ('a "b" \\ \n', '"a \\"b\\" \\\\ \\n"'),
        ("π ∧ ¬", '"π ∧ ¬"'),
        ("\x07\x7f", '"\\u0007\x7f"'),
        ("half \ud83d", '"half \\ud83d"'),
    ],
)
def test_quote(text: str, quoted: str) -> None:
    assert quote(text) == quoted
    assert json.loads(quoted) == text


@given(st.text())
def test_quoted_text_is_read_back(text: str) -> None:
    assert parse(quote(text)) == (JsonString(0, len(quote(text)), text), ())


DOCUMENTS = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(DOCUMENTS, st.integers(0, 4))
def test_layout_is_that_of_the_standard_library(document: Any, indent: int) -> None:
    compact = json.dumps(document, separators=(",", ":"), ensure_ascii=False)
    assert "".join(indented([compact], indent)) == json.dumps(document, indent=indent, ensure_ascii=False)


def test_layout_of_a_stream() -> None:
    chunks = ['{"a":[', '{"b":1}', ',{"c":[]}', "]", "}"]
    assert "".join(indented(chunks, 2)) == json.dumps({"a": [{"b": 1}, {"c": []}]}, indent=2)
