# SPDX-License-Identifier: Apache-2.0
"""The diagnostics of test input."""

from __future__ import annotations

from pathlib import Path

from fixture import Mark, write_files
from roaml import api
from roaml.diagnostics import Diagnostic, Severity
from roaml.project.settings import Settings
from roaml.rules import BY_CODE


def check_text(folder: Path, text: str, settings: Settings | None = None) -> tuple[list[Diagnostic], list[Mark]]:
    """Write the files of `text` into `folder` and check the folder. Return the actual and the expected findings."""
    result, marks = checked(folder, text, settings)
    return list(result.diagnostics), marks


def checked(folder: Path, text: str, settings: Settings | None = None) -> tuple[api.CheckResult, list[Mark]]:
    """As `check_text`, with everything that was found out about the files."""
    marks = write_files(folder, text)
    return api.check([str(folder)], settings=settings or Settings()), marks


def of_rule(diagnostics: list[Diagnostic], code: str) -> list[Diagnostic]:
    """The findings of a rule that are more than hints, unless the rule only gives hints."""
    least = min(Severity.INFORMATION, BY_CODE[code].severity)
    return [d for d in diagnostics if d.code == code and d.severity >= least]


def as_mark(diagnostic: Diagnostic, folder: Path) -> Mark:
    file = Path(diagnostic.path).relative_to(folder).as_posix()
    return Mark(file, *diagnostic.span, diagnostic.code)
