# SPDX-License-Identifier: Apache-2.0
"""A code action, and its changes to the files of a workspace."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from roaml.diagnostics import Diagnostic
from roaml.record import Record, field
from roaml.text import Span, TextEdit

QUICK_FIX = "quickfix"
EXTRACT = "refactor.extract"
REWRITE = "refactor.rewrite"
FIX_ALL = "source.fixAll.as2fm"
KINDS = (QUICK_FIX, EXTRACT, REWRITE, FIX_ALL)
"""The kinds of actions, with their names in LSP."""


class WorkspaceEdit(Record, frozen=True):
    """Changes to the files of a workspace.

    Attributes:
        edits: the edits of existing files, by path; the edits of one file do not overlap.
        created: the text of new files, by path.
        renamed: old path -> new path. Files are edited before they are renamed.
    """

    edits: Mapping[str, tuple[TextEdit, ...]] = field(default_factory=dict)
    created: Mapping[str, str] = field(default_factory=dict)
    renamed: Mapping[str, str] = field(default_factory=dict)

    def __bool__(self) -> bool:
        return bool(self.edits or self.created or self.renamed)


class CodeAction(Record, frozen=True):
    """A code action at a place.

    Attributes:
        title: a phrase in the imperative; unique among the actions of one kind at one place.
        kind: one of `KINDS`.
        make: computes the change when it is requested.
        diagnostic: the diagnostic that a quick fix removes.
        preferred: whether the action is the obvious one, as in LSP's `isPreferred`.
        resources: contains `create` if the action creates files, and `rename` if it renames files.
    """

    title: str
    kind: str
    make: Callable[[], WorkspaceEdit]
    diagnostic: Diagnostic | None = None
    preferred: bool = False
    resources: tuple[str, ...] = ()


def known(change: WorkspaceEdit) -> Callable[[], WorkspaceEdit]:
    """A function for `CodeAction.make` that returns a change that is already known."""
    return lambda: change


def text_edits(before: str, after: str) -> tuple[TextEdit, ...]:
    """One edit that changes `before` to `after` and keeps their common beginning and end; none if they are equal."""
    if before == after:
        return ()
    least = min(len(before), len(after))
    head = next((i for i in range(least) if before[i] != after[i]), least)
    least -= head
    tail = next((i for i in range(least) if before[-1 - i] != after[-1 - i]), least)
    return (TextEdit(Span(head, len(before) - tail), after[head : len(after) - tail]),)
