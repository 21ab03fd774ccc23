# SPDX-License-Identifier: Apache-2.0
"""The code actions at a place: quick fixes of its diagnostics, refactorings, and actions that apply several fixes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from functools import partial

from roaml.diagnostics import Diagnostic, Fix, Severity
from roaml.ide.code_actions.action import EXTRACT, FIX_ALL, QUICK_FIX, REWRITE, CodeAction, WorkspaceEdit, text_edits
from roaml.ide.code_actions.quick_fixes import repairs
from roaml.ide.code_actions.refactorings import refactorings
from roaml.project.fixing import Choice, fix_all, preferred_fix, safe_fix
from roaml.project.workspace import Snapshot
from roaml.text import Span, apply_edits


def actions(snapshot: Snapshot, path: str, place: Span, is_requested: Callable[[str], bool]) -> Iterator[CodeAction]:
    """All code actions at a place, of the requested kinds.

    Args:
        snapshot: the state of the workspace.
        path: the file.
        place: the selection, or the caret as an empty span.
        is_requested: whether a kind of action is requested.
    """
    if is_requested(QUICK_FIX):
        everything = snapshot.checker.diagnostics(path)
        diagnostics = [d for d in everything if d.span.start <= place.end and place.start <= d.span.end]
        for diagnostic in diagnostics:
            yield from quick_fixes(snapshot, path, diagnostic)
        for code in dict.fromkeys(diagnostic.code for diagnostic in diagnostics):
            yield from _fix_all_of(snapshot, path, everything, code)
    if is_requested(EXTRACT) or is_requested(REWRITE):
        yield from (action for action in refactorings(snapshot, path, place) if is_requested(action.kind))
    if is_requested(FIX_ALL):
        yield from _fix_file(snapshot, path)


def quick_fixes(snapshot: Snapshot, path: str, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    """All fixes of a diagnostic: first those of its rule, then those of `code_actions.quick_fixes`, which a rule cannot
    offer."""
    for fix in diagnostic.fixes:
        if diagnostic.code in _CHECKED_BEFORE and _adds_findings(snapshot, path, fix):
            continue
        yield CodeAction(fix.title, QUICK_FIX, partial(_made, path, fix), diagnostic, fix.preferred)
    titles = {fix.title for fix in diagnostic.fixes}
    for action in repairs(snapshot, diagnostic):
        if action.title not in titles:
            yield action


_CHECKED_BEFORE = frozenset(
    (
        *("unanswered-goal", "unanswered-halt", "unanswered-request", "unanswered-tick", "silent-client"),
        *("discarded-answer", "silent-server", "undeclared-handle", "undeclared-variable", "unreachable-state"),
        *("inexact-max-time", "self-assignment", "shadowed-transition"),
    )
)
"""The rules whose fixes depend on other paths or other parts of the machine: a fix is offered if it adds no finding."""


def _adds_findings(snapshot: Snapshot, path: str, fix: Fix) -> bool:
    """Whether a file, or another one of its systems, has an additional error or warning after a fix."""
    source = snapshot.analysis.source(path)
    if source is None:
        return False
    after = snapshot.with_texts({path: apply_edits(source.text, tuple(sorted(fix.edits)))})
    systems = snapshot.analysis.memberships.get(path, ())
    paths = dict.fromkeys((path, *(member for system in systems for member in snapshot.analysis.files_of(system))))
    return bool(_problems(after, paths) - _problems(snapshot, paths))


def _problems(snapshot: Snapshot, paths: Iterable[str]) -> Counter[tuple[str, str]]:
    found = ((path, d) for path in paths for d in snapshot.checker.diagnostics(path))
    return Counter((path, d.code) for path, d in found if d.severity >= Severity.WARNING)


def _made(path: str, fix: Fix) -> WorkspaceEdit:
    return WorkspaceEdit({path: fix.edits})


def _fix_all_of(snapshot: Snapshot, path: str, diagnostics: Iterable[Diagnostic], code: str) -> Iterator[CodeAction]:
    """An action that applies the preferred fixes of all findings of a rule in the file; none if fewer than two findings
    have a preferred fix."""
    fixable = [diagnostic for diagnostic in diagnostics if diagnostic.code == code and preferred_fix(diagnostic)]
    if len(fixable) > 1:

        def choose(diagnostic: Diagnostic) -> Fix | None:
            return preferred_fix(diagnostic) if diagnostic.code == code else None

        yield CodeAction(
            f"Fix all `{code}` in this file",
            QUICK_FIX,
            lambda: _all(snapshot, path, choose, careful=False),
            fixable[0],
        )


def _fix_file(snapshot: Snapshot, path: str) -> Iterator[CodeAction]:
    """An action that applies all safe fixes of the file, if there are any."""
    if any(safe_fix(diagnostic) for diagnostic in snapshot.checker.diagnostics(path)):
        title = "Apply all safe fixes in this file"
        yield CodeAction(title, FIX_ALL, lambda: _all(snapshot, path, safe_fix, careful=True))


def _all(snapshot: Snapshot, path: str, choose: Choice, *, careful: bool) -> WorkspaceEdit:
    source = snapshot.analysis.source(path)
    after = fix_all(snapshot, (path,), choose, careful=careful)
    return WorkspaceEdit({path: text_edits(source.text, after[path])}) if source and path in after else WorkspaceEdit()
