# SPDX-License-Identifier: Apache-2.0
"""The code actions at a place: quick fixes of its diagnostics, refactorings, and actions that apply several fixes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial

from roaml.diagnostics import Diagnostic, Fix
from roaml.ide.code_actions.action import EXTRACT, FIX_ALL, QUICK_FIX, REWRITE, CodeAction, WorkspaceEdit, text_edits
from roaml.ide.code_actions.harmless import harmless
from roaml.ide.code_actions.quick_fixes import repairs
from roaml.ide.code_actions.refactorings import refactorings
from roaml.project.fixing import Choice, fix_all, preferred_fix, safe_fix
from roaml.project.workspace import Snapshot
from roaml.text import Span


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
    """The fixes of a diagnostic that add no finding (`harmless`): those of its rule, and those of
    `code_actions.quick_fixes`, which a rule cannot offer. The preferred ones of the latter come first, because they
    know the other files of the workspace."""
    yield from harmless(snapshot, diagnostic.code, _all_fixes(snapshot, path, diagnostic))


def _all_fixes(snapshot: Snapshot, path: str, diagnostic: Diagnostic) -> Iterator[CodeAction]:
    titles = {fix.title for fix in diagnostic.fixes}
    across = [action for action in repairs(snapshot, diagnostic) if action.title not in titles]
    first = [action for action in across if action.preferred and not action.resources]
    yield from first
    for fix in diagnostic.fixes:
        yield CodeAction(fix.title, QUICK_FIX, partial(_made, path, fix), diagnostic, fix.preferred and not first)
    yield from (action for action in across if action not in first)


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
