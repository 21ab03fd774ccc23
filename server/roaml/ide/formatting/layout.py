# SPDX-License-Identifier: Apache-2.0
"""The interface of a formatter: a layout, and the white space between the parts of a text.

A formatter only returns the content of each *gap* between two tokens, so it cannot change anything but white space.
Gaps are written with `\\n`; `edits` converts them to the line ends of the file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from roaml.record import Record
from roaml.regex import regex
from roaml.text import Span, TextEdit

_LINE_END = regex(r"\r\n|\n|\r")


class FileLayout(Record, frozen=True):
    """The layout of a file.

    Attributes:
        width: the number of columns of one level of nesting.
        tabs: whether one level is indented with a tab character instead of spaces.
        line_length: the maximum length of a line, in columns. Longer lines are wrapped where possible.
    """

    width: int = 4
    tabs: bool = False
    line_length: int = 100

    def indent(self, depth: int) -> str:
        return "\t" * depth if self.tabs else " " * (self.width * depth)

    def column(self, depth: int) -> int:
        """The column at which text begins at a depth of nesting."""
        return self.width * depth


class Spacing(NamedTuple):
    """The white space between two tokens, which may be empty, and the text that replaces it."""

    span: Span
    text: str


def breaks(text: str) -> int:
    """The number of line ends in a text."""
    return len(_LINE_END.findall(text))


def new_line(before: str, indent: str) -> str:
    """The text that replaces the white space `before` by a line break and `indent`. It contains one blank line if
    `before` contains one or more."""
    return f"\n\n{indent}" if breaks(before) > 1 else f"\n{indent}"


def edits(text: str, gaps: Iterable[Spacing]) -> Iterator[TextEdit]:
    """The smallest edits that give the gaps their new texts."""
    gaps = list(gaps)
    line_end = next((match[0] for gap in gaps if (match := _LINE_END.search(text, *gap.span))), None)
    if line_end is None:
        first = _LINE_END.search(text)
        line_end = first[0] if first else "\n"
    for span, filling in gaps:
        new = filling.replace("\n", line_end)
        old = text[span.start : span.end]
        # Line breaks and indentation have separate edits, so that an edit of the indentation does not touch the line
        # before.
        old_breaks, new_breaks = _indent_start(old), _indent_start(new)
        if old_breaks and new_breaks:
            yield from _difference(span.start, old[:old_breaks], new[:new_breaks])
            yield from _difference(span.start + old_breaks, old[old_breaks:], new[new_breaks:])
        else:
            yield from _difference(span.start, old, new)


def _indent_start(text: str) -> int:
    """The index at which the last line of a white space begins; 0 if it has no line break."""
    return max(text.rfind("\n"), text.rfind("\r")) + 1


def _difference(at: int, old: str, new: str) -> Iterator[TextEdit]:
    """The edit that changes the text `old` at offset `at` to `new`; none if they are equal. The edit does not split a
    line end."""
    if old == new:
        return
    least = min(len(old), len(new))
    head = next((i for i in range(least) if old[i] != new[i]), least)
    if head and old[head - 1] == "\r":
        head -= 1
    least -= head
    tail = next((i for i in range(least) if old[-1 - i] != new[-1 - i]), least)
    while tail and old[len(old) - tail] == "\n" and len(old) > tail and old[len(old) - tail - 1] == "\r":
        tail -= 1
    yield TextEdit(Span(at + head, at + len(old) - tail), new[head : len(new) - tail])
