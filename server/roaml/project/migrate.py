# SPDX-License-Identifier: Apache-2.0
"""Migrates a system from an older dialect to the current one (docs/spec/files.md#dialects), and trees without a
system from version 3 of BehaviorTree.CPP to version 4.

- The fixes of the rules are applied until there are none left. So a migration changes only what the rules report, and
  keeps comments and layout.
- Machine files get the extension and the root element of the current dialect, and system files use the new names.
- A file keeps its encoding.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping

from roaml.diagnostics import Diagnostic, Fix
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.fixing import MAX_PASSES, fix_edits
from roaml.project.workspace import Snapshot
from roaml.record import Record
from roaml.text import SourceFile, Span, TextEdit, apply_edits

CODES = frozenset(
    (
        "deprecated-spelling",
        "foreign-namespace",
        "ignored-attribute",
        "ignored-element",
        "missing-field",
        "removed-bt-event",
    )
)
"""The rules whose fixes are part of the migration of a system."""
TREE_CODES = frozenset(("tree-format",))
"""The rules whose fixes are the migration of a tree."""

_OLD_EXTENSION, _EXTENSION = ".scxml", ".ascxml"


class Migration(Record, frozen=True):
    """The migration of a file. `new_path` differs from `path` if the file is renamed; `data` is the text `after` in the
    encoding of the file."""

    path: str
    new_path: str
    before: str
    after: str
    data: bytes


def migrate(
    systems: Iterable[str], trees: Iterable[str], snapshot_of: Callable[[Mapping[str, str]], Snapshot]
) -> tuple[Migration, ...]:
    """The migrations of `trees` and of the files of `systems`. Unchanged files are left out.

    Args:
        systems: the paths of the system files.
        trees: the paths of trees.
        snapshot_of: returns a snapshot of both in which some files have other texts: path -> text.
    """
    systems = tuple(systems)
    first = snapshot_of({}).analysis
    codes = {path: CODES for system in systems for path in first.files_of(system) if first.source(path)}
    for path in trees:
        codes[path] = codes.get(path, frozenset()) | TREE_CODES
    files = list(codes)
    before = {path: _source(first, path) for path in files}
    texts: dict[str, str] = {path: _with_current_root(first, path) for path in files}
    for _ in range(MAX_PASSES):
        snapshot = snapshot_of(texts)
        changed = {path: _fixed(snapshot, path, codes[path]) for path in files}
        if changed == texts:
            break
        texts = changed
    names = {path: _current_name(first, path) for path in files}
    final = snapshot_of(texts).analysis
    for system in systems:
        if system in texts:
            texts[system] = _renamed(final, system, names)
    return tuple(
        Migration(path, names[path], before[path].text, texts[path], before[path].encode(texts[path]))
        for path in files
        if texts[path] != before[path].text or names[path] != path
    )


def _source(analysis: Analysis, path: str) -> SourceFile:
    source = analysis.source(path)
    assert source is not None
    return source


def _text(analysis: Analysis, path: str) -> str:
    return _source(analysis, path).text


def _with_current_root(analysis: Analysis, path: str) -> str:
    machine = analysis.machine(path) if analysis.kind(path) is FileKind.MACHINE else None
    text = _text(analysis, path)
    if machine is None or machine.root == "ascxml":
        return text
    root = machine.element
    spans = [root.name_span, *([root.close_name_span] if root.close_name_span else [])]
    return apply_edits(text, tuple(TextEdit(span, "ascxml") for span in spans))


def _fixed(snapshot: Snapshot, path: str, codes: frozenset[str]) -> str:
    """The text after the first fix of each finding of the migration. Overlapping fixes are applied in the next pass."""

    def step(diagnostic: Diagnostic) -> Fix | None:
        return diagnostic.fixes[0] if diagnostic.code in codes and diagnostic.fixes else None

    return apply_edits(_text(snapshot.analysis, path), fix_edits(snapshot, path, step))


def _current_name(analysis: Analysis, path: str) -> str:
    stem, extension = os.path.splitext(path)
    is_machine = analysis.kind(path) is FileKind.MACHINE and analysis.machine(path) is not None
    return stem + _EXTENSION if is_machine and extension == _OLD_EXTENSION else path


def _renamed(analysis: Analysis, system: str, names: Mapping[str, str]) -> str:
    """The text of a system file with the new names of the files that it lists."""
    edits = []
    for listed in analysis.listed(system):
        src = listed.input.src
        if src is not None and names.get(listed.path, listed.path) != listed.path:
            edits.append(TextEdit(Span(src.span.end - len(_OLD_EXTENSION), src.span.end), _EXTENSION))
    return apply_edits(_text(analysis, system), tuple(edits))
