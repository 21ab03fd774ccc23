# SPDX-License-Identifier: Apache-2.0
"""The edits of a fix are computed when the fix is applied, not when files are checked."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest

from fixture import Case, write_files
from mending import found, offered, workspace_of
from roaml.diagnostics import Diagnostic, Fix
from roaml.edit import elements
from roaml.project import edits
from roaml.rules.support import asynchronous
from roaml.text import Span, TextEdit
from rule_files import documents, examples

WITH_FIX = [code for code, text in documents().items() if "\n## Fix\n" in text]
CASES = [case for code in WITH_FIX for case in examples(code, "Bad")]
COMPUTE = {
    *((elements.__file__, name) for name in ("after", "first_in", "_last_in", "removal")),
    (edits.__file__, "in_layout"),
    (asynchronous.__file__, "_edits"),
}
"""The functions that compute edits."""


def computing(action: Callable[[], object]) -> set[str]:
    """The functions of `COMPUTE` that an action calls."""
    called = set()

    def profile(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and (frame.f_code.co_filename, frame.f_code.co_name) in COMPUTE:
            called.add(frame.f_code.co_name)

    sys.setprofile(profile)
    try:
        action()
    finally:
        sys.setprofile(None)
    return called


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.subject}: {case.title}")
def test_a_check_computes_no_edits(case: Case, tmp_path: Path) -> None:
    write_files(tmp_path, case.text)
    snapshot = workspace_of(tmp_path).snapshot()
    diagnostics: list[Diagnostic] = []
    assert computing(lambda: diagnostics.extend(found(snapshot))) == set()
    assert diagnostics


def test_a_fix_computes_its_edits(tmp_path: Path) -> None:
    """Without this, the test above would prove nothing."""
    called = set()
    for number, case in enumerate(CASES):
        folder = tmp_path / str(number)
        write_files(folder, case.text)
        snapshot = workspace_of(folder).snapshot()
        for _, action in offered(snapshot, case.subject):
            called |= computing(action.make)
    assert called == {name for _, name in COMPUTE}


def test_parts_of_a_fix_are_computed_when_they_are_read() -> None:
    read = []

    def edit() -> TextEdit:
        read.append(1)
        return TextEdit(Span(0, 1), "b")

    fix = Fix("Change", (TextEdit(Span(3, 4), "a"), edit))
    assert fix == Fix("Change", ())
    assert not read
    assert fix.edits == (TextEdit(Span(3, 4), "a"), TextEdit(Span(0, 1), "b"))
    assert read
