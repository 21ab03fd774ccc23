# SPDX-License-Identifier: Apache-2.0
"""Applies fixes: to one file, or repeatedly until none is left.

- Overlapping fixes are not applied together: the later one waits for the next pass, which sees the result of the first.
- Fixes that are applied without a review are not applied if they would cause an error, alone or together.
"""

from __future__ import annotations

import bisect
from collections.abc import Callable, Iterable

from roaml.diagnostics import Diagnostic, Fix, Severity
from roaml.project.workspace import Snapshot
from roaml.text import TextEdit, apply_edits

MAX_PASSES = 100

Choice = Callable[[Diagnostic], "Fix | None"]
"""Selects the fix of a diagnostic to apply, if any."""


def safe_fix(diagnostic: Diagnostic) -> Fix | None:
    """The fix that may be applied without a review."""
    return next((fix for fix in diagnostic.fixes if fix.safe), None)


def preferred_fix(diagnostic: Diagnostic) -> Fix | None:
    """The one obvious fix."""
    return next((fix for fix in diagnostic.fixes if fix.preferred), None)


def fix_edits(snapshot: Snapshot, path: str, choose: Choice) -> tuple[TextEdit, ...]:
    """The edits of all chosen fixes of a file that do not touch each other."""
    return tuple(edit for fix in _fixes(snapshot, path, choose) for edit in fix.edits)


def fix_all(snapshot: Snapshot, paths: Iterable[str], choose: Choice, *, careful: bool) -> dict[str, str]:
    """The texts of files after all selected fixes, applied until none is left. Unchanged files are left out.

    Args:
        snapshot: the state of the workspace.
        paths: the files.
        choose: selects the fix of a diagnostic to apply, if any.
        careful: apply no fix that causes an error in its file or in another file of its systems.
    """
    texts: dict[str, str] = {}
    for path in dict.fromkeys(paths):
        for _ in range(MAX_PASSES):
            mended = _pass(snapshot, path, choose, careful=careful)
            if mended is None:
                break
            texts[path], snapshot = mended
    return texts


def _pass(snapshot: Snapshot, path: str, choose: Choice, *, careful: bool) -> tuple[str, Snapshot] | None:
    """The text after as many compatible fixes as possible, and the new snapshot. `None` if there is no fix."""
    source, fixes = snapshot.analysis.source(path), _fixes(snapshot, path, choose)
    if source is None:
        return None
    together = [fixes, *([fix] for fix in fixes if len(fixes) > 1)] if careful else [fixes]
    for chosen in together:
        text = apply_edits(source.text, tuple(edit for fix in chosen for edit in fix.edits))
        if text != source.text:
            changed = snapshot.with_texts({path: text})
            if not careful or _errors(changed, path) <= _errors(snapshot, path):
                return text, changed
    return None


def _fixes(snapshot: Snapshot, path: str, choose: Choice) -> list[Fix]:
    fixes: list[Fix] = []
    made: list[TextEdit] = []  # sorted; none overlaps another one's fix
    for diagnostic in snapshot.checker.diagnostics(path):
        fix = choose(diagnostic)
        if fix is not None and not any(_touches_one_of(made, edit) for edit in fix.edits):
            fixes.append(fix)
            for edit in fix.edits:
                bisect.insort(made, edit)
    return fixes


def _errors(snapshot: Snapshot, path: str) -> int:
    """The number of errors in a file and in all files of its systems."""
    analysis = snapshot.analysis
    files = {path}.union(*(analysis.files_of(system) for system in analysis.memberships.get(path, ())))
    return sum(d.severity is Severity.ERROR for file in files for d in snapshot.checker.diagnostics(file))


def _touches_one_of(made: list[TextEdit], edit: TextEdit) -> bool:
    at = bisect.bisect(made, edit)
    near = made[max(0, at - 1) : at + 1]
    return any(other.span.start <= edit.span.end and edit.span.start <= other.span.end for other in near)
