# SPDX-License-Identifier: Apache-2.0
"""Every feature that depends only on syntax, used at many places of damaged models: no failure, and no place outside of
the text."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from random import Random

import pytest

from fuzz.strategies.files import make
from roaml import api
from roaml.diagnostics import Severity
from roaml.ide.code_actions import actions
from roaml.ide.code_actions.action import FIX_ALL, WorkspaceEdit
from roaml.ide.folding_range import folds
from roaml.ide.formatting import format_edits
from roaml.ide.linked_editing import linked_names
from roaml.ide.navigation.document_links import links
from roaml.ide.navigation.document_symbol import DocumentSymbol
from roaml.ide.navigation.document_symbols import document_symbols
from roaml.ide.on_type import close_tag
from roaml.ide.selection_range import selections
from roaml.ide.semantic_tokens import semantic_tokens
from roaml.project.explored_findings import CODES
from roaml.project.settings import Settings
from roaml.text import Span


@pytest.mark.parametrize("first", range(0, 100, 10))
def test_damaged_models(first: int) -> None:
    for seed in range(first, first + 10):
        case = make(seed)
        result = api.check([case.main], case.model.ros_paths, Settings(ignore=CODES), case.texts)
        analysis, random = result.snapshot.analysis, Random(seed)
        for path in result.files:
            text = result.source(path).text
            within(text, (token.span for token in semantic_tokens(analysis, path)))
            within(text, (link.span for link in links(analysis, path)))
            within(text, (edit.span for edit in format_edits(analysis, path)))
            within(text, spans_of(document_symbols(analysis, path)))
            lines = result.source(path).lines.line_count
            assert all(0 <= fold.first < fold.last < lines for fold in folds(analysis, path))
            for offset in {0, len(text), *(random.randint(0, len(text)) for _ in range(10))}:
                around = selections(analysis, path, offset)
                within(text, around)
                assert all(span.contains(offset) for span in around)
                assert all(o.start <= i.start and i.end <= o.end for i, o in pairwise(around))
                within(text, linked_names(analysis, path, offset))
                edit = close_tag(analysis, path, offset)
                assert edit is None or edit.span == (offset, offset)
                format_edits(analysis, path, within=Span(offset, min(len(text), offset + 50)))


@pytest.mark.parametrize("first", range(0, 60, 10))
def test_actions_on_damaged_models(first: int) -> None:
    """The edits are within the text and do not overlap."""
    for seed in range(first, first + 10):
        case = make(seed)
        result = api.check([case.main], case.model.ros_paths, Settings(ignore=CODES), case.texts)
        snapshot, random = result.snapshot, Random(seed)
        for path in result.files:
            text = result.source(path).text
            places = [random.randint(0, len(text)) for _ in range(5)]
            places += [diagnostic.span.start for diagnostic in snapshot.checker.diagnostics(path)[:5]]
            for offset in places:
                for action in actions(snapshot, path, Span(offset, offset), lambda kind: kind != FIX_ALL):
                    check_change(result, action.make())


@pytest.mark.parametrize("seed", range(100, 110))
def test_safe_fixes_of_damaged_models(seed: int) -> None:
    """The fixes add no error, and applying them once is enough."""
    case = make(seed)
    result = api.check([case.main], case.model.ros_paths, Settings(ignore=CODES), case.texts)
    fixed = {path: data.decode("utf-8") for path, data in api.fix(result).items()}
    again = api.check([case.main], case.model.ros_paths, Settings(ignore=CODES), {**case.texts, **fixed})
    for path in fixed:
        before, after = (
            sum(d.severity is Severity.ERROR for d in check_result.diagnostics if d.path == path)
            for check_result in (result, again)
        )
        assert after <= before
    assert api.fix(again) == {}


def check_change(result: api.CheckResult, change: WorkspaceEdit) -> None:
    for path, edits in change.edits.items():
        source = result.snapshot.analysis.source(path)
        assert source is not None
        within(source.text, (edit.span for edit in edits))
        assert all(one.span.end <= other.span.start for one, other in pairwise(sorted(edits)))


def within(text: str, spans: Iterable[Span]) -> None:
    assert all(0 <= span.start <= span.end <= len(text) for span in spans)


def spans_of(symbols: Iterable[DocumentSymbol]) -> Iterable[Span]:
    for symbol in symbols:
        assert symbol.name
        assert symbol.span.start <= symbol.name_span.start <= symbol.name_span.end <= symbol.span.end
        yield symbol.span
        yield from spans_of(symbol.children)
