# SPDX-License-Identifier: Apache-2.0
"""Adapts the edits of rules to the layout of a file. Rules write `\\n` as line end, and do not remove empty lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Fix
from roaml.regex import regex
from roaml.text import Edit, SourceFile, Span, TextEdit, computed

_LINE_END = regex(r"\r\n|\n|\r")


def line_end_of(source: SourceFile) -> str:
    """The line end of the first line of a text; `\\n` if it has only one line."""
    end = source.lines.line_end(0)
    last = source.text[max(0, end - 2) : end]
    return "\r\n" if last == "\r\n" else last[-1:] if last[-1:] in ("\n", "\r") else "\n"


def in_layout(source: SourceFile, edits: Iterable[Edit]) -> Iterator[TextEdit]:
    """The edits with the line end of the file. An edit that removes the whole content of a line also removes the line.

    The content of a line is determined after all edits.
    """
    edits = sorted(computed(edits))
    line_end = line_end_of(source) if any(_LINE_END.search(edit.new_text) for edit in edits) else "\n"
    for number, edit in enumerate(edits):
        if edit.new_text or edit.span.start == edit.span.end:
            yield TextEdit(edit.span, _LINE_END.sub(line_end, edit.new_text))
            continue
        lines = _blank_around(source, edit.span)
        if lines is None:
            yield edit
            continue
        before = any(other.span.end >= lines.start for other in edits[:number])
        after = number + 1 < len(edits) and edits[number + 1].span.start < lines.end
        yield edit if before or after else TextEdit(lines, "")


_BLANK = regex(r"\s*")


def _blank_around(source: SourceFile, span: Span) -> Span | None:
    """The whole lines that contain a span; `None` if they contain other text.

    Only the white space around the span is read, because a line may be long and have many edits.
    """
    start = source.lines.line_start(source.lines.position(span.start).line)
    end = source.lines.line_end(source.lines.position(span.end).line)
    first, last = _BLANK.match(source.text, start, span.start), _BLANK.match(source.text, span.end, end)
    assert first is not None
    assert last is not None
    return Span(start, end) if first.end() == span.start and last.end() == end else None


def laid_out(source: SourceFile, fix: Fix) -> Fix:
    """The fix with its edits adapted to the file, computed when they are read."""
    return Fix(fix.title, lambda: tuple(in_layout(source, fix.edits)), fix.preferred, fix.safe)
