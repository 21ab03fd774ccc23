# SPDX-License-Identifier: Apache-2.0
"""The edits of rules as a file takes them: a rule writes `\\n` and does not care what else stands on a line."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace

from roaml.diagnostics import Fix
from roaml.text import SourceFile, Span, TextEdit

_LINE_END = re.compile(r"\r\n|\n|\r")


def line_end_of(text: str) -> str:
    """How the lines of a text end."""
    first = _LINE_END.search(text)
    return first[0] if first else "\n"


def in_layout(source: SourceFile, edits: Iterable[TextEdit]) -> Iterator[TextEdit]:
    """New lines end as the file's lines do; an edit that takes away all that stands on a line takes the line with it.

    What stands on a line is seen with all the edits made.
    """
    text, edits = source.text, sorted(edits)
    line_end = line_end_of(text) if any(_LINE_END.search(edit.new_text) for edit in edits) else "\n"
    for edit in edits:
        if edit.new_text or edit.span.start == edit.span.end:
            yield TextEdit(edit.span, _LINE_END.sub(line_end, edit.new_text))
            continue
        start = source.lines.line_start(source.lines.position(edit.span.start).line)
        end = source.lines.line_end(source.lines.position(edit.span.end).line)
        around = text[start : edit.span.start] + text[edit.span.end : end]
        shared = any(other is not edit and other.span.end >= start and other.span.start < end for other in edits)
        yield edit if around.strip() or shared else TextEdit(Span(start, end), "")


def laid_out(source: SourceFile, fix: Fix) -> Fix:
    edits = tuple(in_layout(source, fix.edits))
    return fix if edits == fix.edits else replace(fix, edits=edits)
