# SPDX-License-Identifier: Apache-2.0
"""Making fixes: one file at a time, or all of a kind until none is left.

- Fixes that touch each other are not made together: the later one waits for the next pass, which sees what the first
  has done.
- A pass that makes errors is not made, whatever its fixes promise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from roaml.diagnostics import Diagnostic, Fix, Severity
from roaml.project.workspace import Snapshot
from roaml.text import TextEdit, apply_edits

MAX_PASSES = 20

Choice = Callable[[Diagnostic], "Fix | None"]
"""Which fix of a diagnostic is to be made, if any."""


def safe_fix(diagnostic: Diagnostic) -> Fix | None:
    """The fix that may be made without a look."""
    return next((fix for fix in diagnostic.fixes if fix.safe), None)


def preferred_fix(diagnostic: Diagnostic) -> Fix | None:
    """The one obvious fix."""
    return next((fix for fix in diagnostic.fixes if fix.preferred), None)


def fix_edits(snapshot: Snapshot, path: str, choose: Choice) -> tuple[TextEdit, ...]:
    """The edits of all chosen fixes of a file that do not touch each other."""
    edits: list[TextEdit] = []
    for diagnostic in snapshot.checker.diagnostics(path):
        fix = choose(diagnostic)
        if fix is not None and not any(_touch(new, made) for new in fix.edits for made in edits):
            edits += fix.edits
    return tuple(edits)


def fix_all(
    paths: Iterable[str], choose: Choice, snapshot_of: Callable[[Mapping[str, str]], Snapshot]
) -> dict[str, str]:
    """The texts of files after all chosen fixes, made until none is left. Files that stay as they are are left out.

    `snapshot_of` gives the files with some texts in place of what they hold.
    """
    texts: dict[str, str] = {}
    snapshot = snapshot_of(texts)
    for path in dict.fromkeys(paths):
        if snapshot.analysis.source(path) is None:
            continue
        for _ in range(MAX_PASSES):
            source = snapshot.analysis.source(path)
            assert source is not None
            text = apply_edits(source.text, fix_edits(snapshot, path, choose))
            if text == source.text:
                break
            changed = snapshot_of({**texts, path: text})
            if _errors(changed, path) > _errors(snapshot, path):
                break
            texts[path], snapshot = text, changed
    return texts


def _errors(snapshot: Snapshot, path: str) -> int:
    return sum(diagnostic.severity is Severity.ERROR for diagnostic in snapshot.checker.diagnostics(path))


def _touch(one: TextEdit, other: TextEdit) -> bool:
    return one.span.start <= other.span.end and other.span.start <= one.span.end
