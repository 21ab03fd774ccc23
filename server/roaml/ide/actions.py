# SPDX-License-Identifier: Apache-2.0
"""What is offered at a place: quick fixes of what is wrong there, refactorings, and all fixes of a kind at once."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Diagnostic, Fix
from roaml.ide.change import FIX_ALL, QUICK_FIX, Action, Change, known, whole
from roaml.ide.repairs import repairs
from roaml.project.fixing import Choice, fix_all, preferred_fix, safe_fix
from roaml.project.workspace import Snapshot
from roaml.text import Span


def quick_fixes(snapshot: Snapshot, path: str, diagnostic: Diagnostic) -> Iterator[Action]:
    """All that mends a diagnostic: first what its rule offers, then what reaches further."""
    for fix in diagnostic.fixes:
        yield Action(fix.title, QUICK_FIX, known(Change({path: fix.edits})), diagnostic, fix.preferred)
    titles = {fix.title for fix in diagnostic.fixes}
    for action in repairs(snapshot, diagnostic):
        if action.title not in titles:
            yield action


def found_at(snapshot: Snapshot, path: str, place: Span) -> tuple[Diagnostic, ...]:
    """The diagnostics that a selection touches."""
    found = snapshot.checker.diagnostics(path)
    return tuple(d for d in found if d.span.start <= place.end and place.start <= d.span.end)


def fix_all_of(snapshot: Snapshot, path: str, code: str) -> Iterator[Action]:
    """All that a rule finds in the file, if there is more than one thing with an obvious mend."""
    mendable = [d for d in snapshot.checker.diagnostics(path) if d.code == code and preferred_fix(d)]
    if len(mendable) > 1:

        def choose(diagnostic: Diagnostic) -> Fix | None:
            return preferred_fix(diagnostic) if diagnostic.code == code else None

        yield Action(f"Fix all `{code}` in this file", QUICK_FIX, lambda: _all(snapshot, path, choose), mendable[0])


def fix_file(snapshot: Snapshot, path: str) -> Iterator[Action]:
    """All safe fixes of the file."""
    if any(safe_fix(diagnostic) for diagnostic in snapshot.checker.diagnostics(path)):
        title = "Make all safe fixes in this file"
        yield Action(title, FIX_ALL, lambda: _all(snapshot, path, safe_fix))


def _all(snapshot: Snapshot, path: str, choose: Choice) -> Change:
    source = snapshot.analysis.source(path)
    after = fix_all((path,), choose, snapshot.with_texts)
    return Change({path: whole(source.text, after[path])}) if source and path in after else Change()
