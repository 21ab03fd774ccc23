# SPDX-License-Identifier: Apache-2.0
"""Paths in a file that refer to another file: `src` in a system file, `path` of an `<include>` in a tree."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from roaml.disk import UnreadableReason
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.text import Span


class DocumentLink(NamedTuple):
    """A path at `span` that refers to the existing file `target`."""

    span: Span
    target: str


def links(analysis: Analysis, path: str) -> tuple[DocumentLink, ...]:
    """The links in a file, in the order of the text."""
    return tuple(link for link in _named(analysis, path) if _is_file(analysis, link.target))


def _named(analysis: Analysis, path: str) -> Iterator[DocumentLink]:
    kind = analysis.kind(path)
    if kind is FileKind.SYSTEM:
        for listed in analysis.listed(path):
            if listed.input.src is not None:
                yield DocumentLink(listed.input.src.span, listed.path)
    elif kind is FileKind.TREE and (tree := analysis.tree(path)):
        for include in tree.includes:
            target = analysis.include_path(path, include)
            if include.path is not None and target is not None:
                yield DocumentLink(include.path.span, target)


def _is_file(analysis: Analysis, path: str) -> bool:
    return analysis.files.read(path) not in (
        UnreadableReason.MISSING,
        UnreadableReason.FOLDER,
        UnreadableReason.SPECIAL,
    )
