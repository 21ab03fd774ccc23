# SPDX-License-Identifier: Apache-2.0
"""Every quick fix keeps its promise: made alone, it removes its diagnostic and adds no error."""

from __future__ import annotations

import itertools
import os
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from roaml.diagnostics import Diagnostic, Severity
from roaml.ide.code_actions import quick_fixes
from roaml.ide.code_actions.action import Action, Change
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.text import apply_edits


def workspace_of(folder: Path) -> Workspace:
    return Workspace((str(folder),), Settings())


def applied(snapshot: Snapshot, change: Change) -> dict[str, str]:
    """Path -> text of the files that a change makes or changes."""
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


def broken_promises(workspace: Workspace, code: str | None = None, *, errors_may_come: bool = False) -> Iterator[str]:
    """What is wrong with the fixes of all that is found in a folder, or of what one rule finds.

    Of several names that may be meant, those that are not preferred may be wrong. With `errors_may_come`, a fix need
    only remove its diagnostic.
    """
    snapshot = workspace.snapshot()
    before = found(snapshot)
    for diagnostic in before:
        if code in (None, diagnostic.code):
            for action in quick_fixes(snapshot, diagnostic.path, diagnostic):
                strict = not errors_may_come and (action.preferred or not action.title.startswith("Change to"))
                reason = _reason(snapshot, before, diagnostic, action, strict=strict)
                if reason:
                    name = os.path.basename(diagnostic.path)
                    yield f"{name}: {diagnostic.code}: {diagnostic.message}: {action.title}: {reason}"


def _reason(
    snapshot: Snapshot, before: list[Diagnostic], diagnostic: Diagnostic, action: Action, *, strict: bool
) -> str:
    texts = applied(snapshot, action.make())
    if not texts:
        return "does nothing"
    after = found(snapshot.with_texts(texts))
    if Counter(map(_key, after))[_key(diagnostic)] >= Counter(map(_key, before))[_key(diagnostic)]:
        return "the diagnostic stays"
    if any(each.code == "internal-error" for each in after):
        return "a rule fails"
    if action.preferred and _ill_formed(after) > _ill_formed(before):
        return "the text is less well-formed than before"
    new = Counter(map(_key, _errors(after))) - Counter(map(_key, _errors(before)))
    removes = diagnostic.severity is Severity.ERROR
    if strict and new and (action.preferred or len(_errors(after)) > len(_errors(before)) - removes):
        return f"new errors: {sorted(new)}"
    return ""


def found(snapshot: Snapshot) -> list[Diagnostic]:
    return [d for path in snapshot.files() for d in snapshot.checker.diagnostics(path)]


def _ill_formed(diagnostics: list[Diagnostic]) -> int:
    return sum(diagnostic.code in ("xml-syntax", "duplicate-attribute") for diagnostic in diagnostics)


def _errors(diagnostics: list[Diagnostic]) -> list[Diagnostic]:
    return [diagnostic for diagnostic in diagnostics if diagnostic.severity is Severity.ERROR]


def _key(diagnostic: Diagnostic) -> tuple[str, str, str]:
    return diagnostic.path, diagnostic.code, diagnostic.message
