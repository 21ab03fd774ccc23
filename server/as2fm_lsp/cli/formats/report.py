# SPDX-License-Identifier: Apache-2.0
"""Diagnostics with positions for readers: lines and columns from 1, in code points, the end exclusive."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import cached_property

from roaml.diagnostics import Diagnostic, Severity
from roaml.project.paths import slashed
from roaml.record import Record
from roaml.text import SourceFile, Span

_CONTEXT_CHARACTERS = 200
"""The maximum number of characters before a position, and after it, that are part of a fingerprint; generated files may
have everything on one line."""


class LineRange(Record, frozen=True):
    """Lines and columns from 1, in code points; the end is exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int


class RelatedEntry(Record, frozen=True):
    """A further place that explains a diagnostic."""

    file: str
    place: LineRange
    message: str


class Entry(Record, frozen=True, dict=True):
    """A diagnostic in the output. Its paths are as given by the user, or relative to the working directory."""

    diagnostic: Diagnostic
    file: str
    place: LineRange
    source: SourceFile
    related: tuple[RelatedEntry, ...] = ()

    @property
    def code(self) -> str:
        return self.diagnostic.code

    @property
    def severity(self) -> str:
        return self.diagnostic.severity.label

    @property
    def message(self) -> str:
        return self.diagnostic.message

    @cached_property
    def line(self) -> Span:
        """The first line of the place, without its line end."""
        lines, text = self.source.lines, self.source.text
        start, end = lines.line_start(self.place.line - 1), lines.line_end(self.place.line - 1)
        while end > start and text[end - 1] in "\r\n":
            end -= 1
        return Span(start, end)

    @cached_property
    def fingerprint(self) -> str:
        return self.fingerprint_as(self.file)

    def fingerprint_as(self, file: str) -> str:
        """An identifier that does not change when other lines are added or removed. It is computed from the file's
        name, code, message and the text on the line around the position."""
        at = self.line.start + self.place.column - 1
        around = self.source.text[
            max(self.line.start, at - _CONTEXT_CHARACTERS) : min(self.line.end, at + _CONTEXT_CHARACTERS)
        ]
        import hashlib  # noqa: PLC0415 - only formats with fingerprints need it

        parts = (slashed(file), self.code, self.message, around.strip())
        return hashlib.sha256("\0".join(parts).encode("utf-8", "surrogatepass")).hexdigest()[:32]


class CheckReport(Record, frozen=True):
    """The result of a check, for all formats.

    Attributes:
        checked: the number of checked files.
        ignored: the number of these files that are plain SCXML, in which only the syntax is checked.
        limit: the least severity that makes the check fail.
        color: whether the output goes to a terminal with colors.
        has_summary: whether text ends with the numbers of findings and files.
    """

    entries: Sequence[Entry]
    checked: int
    limit: Severity = Severity.ERROR
    color: bool = False
    has_summary: bool = True
    ignored: int = 0


def entry(diagnostic: Diagnostic, source_of: Callable[[str], SourceFile], shown: Callable[[str], str]) -> Entry:
    related = tuple(
        RelatedEntry(shown(r.location.path), place_of(source_of(r.location.path), r.location.span), r.message)
        for r in diagnostic.related
    )
    source = source_of(diagnostic.path)
    return Entry(diagnostic, shown(diagnostic.path), place_of(source, diagnostic.span), source, related)


def place_of(source: SourceFile, span: Span) -> LineRange:
    start, end = source.lines.position(span.start), source.lines.position(span.end)
    return LineRange(start.line + 1, start.column + 1, end.line + 1, end.column + 1)


def shown_path(path: str, folder: str = os.curdir) -> str:
    """`path` relative to a folder; unchanged if it is on another drive or more than two folders above."""
    try:
        relative = os.path.relpath(path, folder)
    except ValueError:  # on another drive
        return path
    return path if relative.count(os.pardir + os.sep) > 2 else relative
