# SPDX-License-Identifier: Apache-2.0
"""Applies fixes to files, once or repeatedly until no fixes are left.

- Overlapping fixes are not applied together: the fix that is later in the text is applied in the next pass.
- If fixes are applied without a review, fixes that would cause an error, alone or together, are left out.
"""

from __future__ import annotations

import bisect
from collections.abc import Callable, Iterable

from roaml.diagnostics import Diagnostic, Fix, Severity
from roaml.project.workspace import Snapshot
from roaml.text import TextEdit, apply_edits

MAX_PASSES = 100
"""The maximum number of passes over a file."""


Choice = Callable[[Diagnostic], "Fix | None"]
"""Selects the fix of a diagnostic that is applied; `None` if none is."""


def safe_fix(diagnostic: Diagnostic) -> Fix | None:
    """The fix that may be applied without a review; `None` if there is none."""
    return next((fix for fix in diagnostic.fixes if fix.safe), None)


def preferred_fix(diagnostic: Diagnostic) -> Fix | None:
    """The fix that is marked as preferred; `None` if there is none."""
    return next((fix for fix in diagnostic.fixes if fix.preferred), None)


def fix_edits(snapshot: Snapshot, path: str, choose: Choice) -> tuple[TextEdit, ...]:
    """The edits of the fixes of a file that `choose` selects. A fix that touches or overlaps an earlier one is left
    out."""
    return tuple(edit for fix in _fixes(snapshot, path, choose) for edit in fix.edits)


def fix_all(snapshot: Snapshot, paths: Iterable[str], choose: Choice, *, careful: bool) -> dict[str, str]:
    """Path -> its text after the selected fixes have been applied until there are none left. Unchanged files are left
    out.

    Args:
        snapshot: the state of the workspace.
        paths: the files to fix.
        choose: selects the fix of a diagnostic.
        careful: whether fixes that cause an error in their file, or in another file of its systems, are left out.
    """
    texts: dict[str, str] = {}
    for path in dict.fromkeys(paths):
        for _ in range(MAX_PASSES):
            fixed = _pass(snapshot, path, choose, careful=careful)
            if fixed is None:
                break
            texts[path], snapshot = fixed
    return texts


def _pass(snapshot: Snapshot, path: str, choose: Choice, *, careful: bool) -> tuple[str, Snapshot] | None:
    """The text of a file after one pass of fixes, and the new snapshot; `None` if no fix can be applied.

    If all fixes together cause an error and `careful` is true, one fix that causes none is applied.
    """
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
    made: list[TextEdit] = []  # sorted edits, which do not overlap
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
