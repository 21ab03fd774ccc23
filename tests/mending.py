# SPDX-License-Identifier: Apache-2.0
"""The invariants of quick fixes: each fix alone removes its diagnostic, and a preferred one adds no error."""

from __future__ import annotations

import itertools
import os
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

from roaml.diagnostics import Diagnostic, Severity
from roaml.ide.code_actions import quick_fixes
from roaml.ide.code_actions.action import CodeAction, WorkspaceEdit
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.text import apply_edits


def workspace_of(folder: Path) -> Workspace:
    return Workspace((str(folder),), Settings())


def applied(snapshot: Snapshot, change: WorkspaceEdit) -> dict[str, str]:
    """Path -> text of the files that an edit changes or creates."""
    texts = dict(change.created)
    for path, edits in change.edits.items():
        source = snapshot.analysis.source(path)
        assert source is not None
        assert all(one.span.end <= other.span.start for one, other in itertools.pairwise(sorted(edits))), (
            "edits overlap"
        )
        texts[path] = apply_edits(source.text, edits)
    for path, new in change.renamed.items():
        source = snapshot.analysis.source(path)
        texts[new] = texts.pop(path, source.text if source else "")
    return texts


def offered(snapshot: Snapshot, code: str | None = None) -> Iterator[tuple[Diagnostic, CodeAction]]:
    """The fixes of all findings in a folder, or of the findings of one rule."""
    for diagnostic in found(snapshot):
        if code in (None, diagnostic.code):
            for action in quick_fixes(snapshot, diagnostic.path, diagnostic):
                yield diagnostic, action


def broken_promises(
    snapshot: Snapshot, fixes: Iterable[tuple[Diagnostic, CodeAction]], *, may_add: Collection[str] = ()
) -> Iterator[str]:
    """The invariants that fixes violate.

    Args:
        snapshot: the folder.
        fixes: what is `offered` in it.
        may_add: the codes of errors that a preferred fix may add. If there are several errors at once, a fix of one
            may reveal another.
    """
    before = found(snapshot)
    for diagnostic, action in fixes:
        reason = _reason(snapshot, before, diagnostic, action, may_add)
        if reason:
            name = os.path.basename(diagnostic.path)
            yield f"{name}: {diagnostic.code}: {diagnostic.message}: {action.title}: {reason}"


def _reason(
    snapshot: Snapshot, before: list[Diagnostic], diagnostic: Diagnostic, action: CodeAction, may_add: Collection[str]
) -> str:
    texts = applied(snapshot, action.make())
    if not texts:
        return "does nothing"
    after = found(snapshot.with_texts(texts))
    if Counter(map(_key, after))[_key(diagnostic)] >= Counter(map(_key, before))[_key(diagnostic)]:
        return "the diagnostic stays"
    if any(d.code == "internal-error" for d in after):
        return "a rule fails"
    if action.preferred:
        new = _errors(after) - _errors(before)
        if any(code not in may_add for _, code in new):
            return f"new errors: {sorted(new)}"
    return ""


def found(snapshot: Snapshot) -> list[Diagnostic]:
    return [d for path in snapshot.files() for d in snapshot.checker.diagnostics(path)]


def _errors(diagnostics: list[Diagnostic]) -> Counter[tuple[str, str]]:
    """Path and code of each error. Messages are not compared, because they contain names that a fix may change."""
    return Counter((d.path, d.code) for d in diagnostics if d.severity is Severity.ERROR)


def _key(diagnostic: Diagnostic) -> tuple[str, str, str]:
    return diagnostic.path, diagnostic.code, diagnostic.message
