# SPDX-License-Identifier: Apache-2.0
"""Hover, hints, lenses and signatures at places all over the conformance models."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

import conformance
from roaml import api
from roaml.expr.operators import FUNCTIONS
from roaml.ide.code_lens import counted, lenses
from roaml.ide.describe.markdown import plain
from roaml.ide.hover import hover
from roaml.ide.inlay_hints import explain, inlay_hints
from roaml.ide.signature_help import signature_help
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings
from roaml.text import Span

MARKS = ("``", "**")
"""What is left where marks of Markdown do not match."""


@pytest.mark.parametrize("main", conformance.systems(), ids=conformance.label)
def test_places(main: Path) -> None:
    result = api.check([str(main)], (str(conformance.INTERFACES),), Settings(ignore=CODES))
    analysis = result.snapshot.analysis
    descriptions = set()
    for path in result.files:
        text = result.source(path).text
        for offset in range(0, len(text) + 1, 7):
            actual_hover = hover(analysis, path, offset)
            if actual_hover is not None:
                assert 0 <= actual_hover.span.start <= offset <= actual_hover.span.end <= len(text)
                descriptions.add(actual_hover.text)
            called = signature_help(analysis, path, offset)
            assert called is None or called.label.split("(")[0].removeprefix("Math.") in FUNCTIONS
        hints = inlay_hints(analysis, path, Span(0, len(text)))
        assert all(0 <= one.offset <= other.offset <= len(text) for one, other in pairwise(hints))
        for hint in hints:
            assert hint.text.strip()
            for part in hint.parts:
                assert part.symbol is None or explain(analysis, part.symbol).text, part
        for lens in lenses(analysis, path):
            assert counted(analysis, lens.symbol, path).title
    assert len(descriptions) > 20
    for description in descriptions:
        shown = plain(description)
        assert shown
        assert not any(mark in shown for mark in MARKS), description
        assert max(map(len, shown.splitlines())) < 800, description
        assert len(shown.splitlines()) < 80, description


@pytest.mark.parametrize("main", conformance.systems(), ids=conformance.label)
def test_every_variable_event_and_handle_is_known(main: Path) -> None:
    """In correct models, no symbol is described as unknown, undefined or unused."""
    result = api.check([str(main)], (str(conformance.INTERFACES),), Settings(ignore=CODES))
    for path in result.files:
        text = result.source(path).text
        for word in ("<data id=", "<state id=", " target=", ' location="', ' event="', " key="):
            at = text.find(word)
            while at >= 0:
                actual_hover = hover(result.snapshot.analysis, path, at + len(word) + 1)
                shown = plain(actual_hover.text) if actual_hover else ""
                assert not any(bad in shown for bad in ("unknown", "Not defined", "Not declared")), (path, shown)
                at = text.find(word, at + 1)
