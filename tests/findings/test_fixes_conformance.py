# SPDX-License-Identifier: Apache-2.0
"""The fixes of planted errors remove their diagnostics; a preferred one adds no error."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import conformance
from mending import broken_promises, found, offered, workspace_of
from roaml.diagnostics import Severity
from roaml.text import apply_edits

MISTAKES = conformance.mistakes()


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda mistake: mistake.id)
def test_fixes(mistake: conformance.Mistake) -> None:
    snapshot = workspace_of(mistake.folder).snapshot()
    assert not list(broken_promises(snapshot, offered(snapshot)))


SPELLING = ["01_misspelled_exec_tag", "02_misspelled_decl_tag"]


@pytest.mark.parametrize("id_", SPELLING)
def test_misspelled_elements_are_restored(id_: str, tmp_path: Path) -> None:
    """The file is then equal to the file without the error, byte by byte."""
    mistake = next(m for m in MISTAKES if m.id == id_)
    folder = tmp_path / "system"
    shutil.copytree(mistake.folder, folder)
    snapshot = workspace_of(folder).snapshot()
    errors = [d for d in found(snapshot) if d.severity is Severity.ERROR and d.code == "unknown-element"]
    fix = next(fix for fix in errors[0].fixes if fix.preferred)
    path = Path(errors[0].path)
    mended = apply_edits(path.read_bytes().decode("utf-8"), fix.edits)
    assert mended.encode("utf-8") == (mistake.base.parent / path.relative_to(folder)).read_bytes()
