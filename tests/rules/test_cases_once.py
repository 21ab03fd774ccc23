# SPDX-License-Identifier: Apache-2.0
"""One mistake, one report: what only follows from a mistake is kept quiet. One file `cases_once/<subject>.txt` each.

A case is a line `## title` and files as in `fixture`. Files before the first case belong to every case, unless it has
one of that name itself. The carets show all that is said about the system, but for hints and information.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fixture import check_text, split_cases, split_files
from roaml.diagnostics import Severity

FOLDER = Path(__file__).parent / "cases_once"


def cases() -> list[tuple[str, str, str]]:
    """Subject, title and text of every case."""
    found = []
    for path in sorted(FOLDER.glob("*.txt")):
        common, titled = split_cases(path)
        for title, text in titled:
            files = split_files(common) | split_files(text)
            found.append((path.stem, title, "".join(f"-- {name} --\n{content}" for name, content in files.items())))
    return found


@pytest.mark.parametrize("text", [pytest.param(text, id=f"{stem}: {title}") for stem, title, text in cases()])
def test_case(text: str, tmp_path: Path) -> None:
    diagnostics, marks = check_text(tmp_path, text)
    found = sorted(
        (Path(d.path).relative_to(tmp_path).as_posix(), d.span.start, d.code)
        for d in diagnostics
        if d.severity >= Severity.WARNING
    )
    assert found == sorted((mark.file, mark.start, mark.code) for mark in marks)
