# SPDX-License-Identifier: Apache-2.0
"""What a formatter wants: a layout, and the white space between the parts of a text.

A formatter says nothing but what each *gap* between two tokens is to hold, so whatever it thinks, it changes white
space only. Gaps are written with `\\n`; `edits` gives them the line ends that the file has.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from roaml.text import Span, TextEdit

_LINE_END = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True, slots=True)
class FileLayout:
    """How a file is laid out.

    Attributes:
        width: columns of one level.
        tabs: whether a level is a tab character.
        line_length: lines longer than this many columns are broken where they can be.
    """

    width: int = 4
    tabs: bool = False
    line_length: int = 100

    def indent(self, depth: int) -> str:
        return "\t" * depth if self.tabs else " " * (self.width * depth)

    def column(self, depth: int) -> int:
        """The column at which text at a depth begins."""
        return self.width * depth


class Spacing(NamedTuple):
    """Between two tokens, where white space stands or none, `text` is to stand."""

    span: Span
    text: str


def breaks(text: str) -> int:
    """How many line ends there are in a text."""
    return len(_LINE_END.findall(text))


def new_line(before: str, indent: str) -> str:
    """A line break to `indent` in place of the white space `before`, of whose blank lines one is kept."""
    return f"\n\n{indent}" if breaks(before) > 1 else f"\n{indent}"


def edits(text: str, gaps: Iterable[Spacing]) -> Iterator[TextEdit]:
    """The smallest edits that fill the gaps."""
    gaps = list(gaps)
    line_end = next((found[0] for gap in gaps if (found := _LINE_END.search(text, *gap.span))), None)
    if line_end is None:
        first = _LINE_END.search(text)
        line_end = first[0] if first else "\n"
    for span, wanted in gaps:
        new = wanted.replace("\n", line_end)
        old = text[span.start : span.end]
        # Apart from the line breaks, so that the indentation of a line can be mended without the line before it.
        old_breaks, new_breaks = _indent_start(old), _indent_start(new)
        if old_breaks and new_breaks:
            yield from _difference(span.start, old[:old_breaks], new[:new_breaks])
            yield from _difference(span.start + old_breaks, old[old_breaks:], new[new_breaks:])
        else:
            yield from _difference(span.start, old, new)


def _indent_start(text: str) -> int:
    """Where the last line of white space begins; 0 if there is only one."""
    return max(text.rfind("\n"), text.rfind("\r")) + 1


def _difference(at: int, old: str, new: str) -> Iterator[TextEdit]:
    """What differs between two texts, the first of which stands at `at`. No line end is cut in two."""
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
