# SPDX-License-Identifier: Apache-2.0
"""Hover texts for mocks: the node of a library like which a node is executed."""

from __future__ import annotations

from roaml.ide.describe import forest as describe_forest
from roaml.mocks.likeness import library_parents
from roaml.mocks.mock import MockError, mock_spans, read_mock
from roaml.text import Span


def mock_at(text: str, offset: int) -> tuple[Span, str] | None:
    """The name of a node of a library, or of its port, at a place in a file of mocks, with its description; `None` if
    there is none."""
    for span in mock_spans(text):
        if not span.start <= offset <= span.end:
            continue
        line = text[span.start : span.end]
        try:
            like = read_mock(line).like
        except MockError:
            return None
        if like is None:
            return None
        known, at = library_parents()[like.type], line.index(like.type, line.rindex(" as ") + 1)
        type_span = Span(span.start + at, span.start + at + len(like.type))
        if type_span.start <= offset <= type_span.end:
            return type_span, describe_forest.node(known)
    return None
