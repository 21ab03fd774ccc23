# SPDX-License-Identifier: Apache-2.0
"""A text with edits that remember where they were made."""

from __future__ import annotations

import bisect
from collections.abc import Iterable
from functools import cached_property

from roaml.record import Record
from roaml.text import Span, TextEdit, apply_edits


class CopiedText(Record, frozen=True):
    """A part of an expanded text that comes from another place than where the edit is that inserts it.

    Attributes:
        start, end: the part.
        source: the text that it comes from, before the edits.
        is_exact: whether it is a copy of that text, so that each character has its own origin.
    """

    start: int
    end: int
    source: Span
    is_exact: bool


class ExpandedText(Record, frozen=True, dict=True):
    """A file of a system after the expansion.

    Attributes:
        path: the path under which the expanded text is analysed; that of another file of the user never.
        source: the path of the file of the user.
        text: the expanded text.
        edits: the edits that make the expanded text from that of the file, or from `before`, sorted, not overlapping.
        copies: the parts of the new texts of edits that come from other places, sorted.
        before: the result of an earlier expansion, which `edits` change; `None` if they change the text of the user.
    """

    path: str
    source: str
    text: str
    edits: tuple[TextEdit, ...]
    copies: tuple[CopiedText, ...] = ()
    before: ExpandedText | None = None

    @property
    def expansions(self) -> tuple[ExpandedText, ...]:
        """The expansions that made this text, the first one first."""
        return (self,) if self.before is None else (*self.before.expansions, self)

    @cached_property
    def _pieces(self) -> tuple[list[int], list[tuple[int, int, int]]]:
        """For each edit, the offset of its new text in the expanded text; and its old span with the length of the new
        text."""
        starts, pieces, shift = [], [], 0
        for span, new in self.edits:
            starts.append(span.start + shift)
            pieces.append((span.start, span.end, len(new)))
            shift += len(new) - (span.end - span.start)
        return starts, pieces

    def origin(self, span: Span) -> Span:
        """The span in the file of the user that became `span`. A part of a new text becomes the whole text that it
        replaces."""
        origin = self._own_origin(span)
        return origin if self.before is None else self.before.origin(origin)

    def _own_origin(self, span: Span) -> Span:
        start, end = self._offset(span.start, at_end=False), self._offset(span.end, at_end=span.end > span.start)
        return Span(start, max(start, end))

    def written(self, span: Span) -> str:
        """The text of the user in `span`, a span of the file of the user that no edit touches; "" if one touches it."""
        place = self._place_of(span)
        return "" if place is None else self.text[place.start : place.end]

    def _place_of(self, span: Span) -> Span | None:
        """The place of a text of the user; `None` if an edit touches it."""
        if self.before is not None:
            known = self.before._place_of(span)
            if known is None:
                return None
            span = known
        shift = 0
        for edit, new in self.edits:
            if edit.end <= span.start:
                shift += len(new) - (edit.end - edit.start)
            elif edit.start < span.end:
                return None
        return Span(span.start + shift, span.end + shift)

    def is_written(self, span: Span) -> bool:
        """Whether the text in `span` is that of the user: no edit touches it."""
        original = self._own_origin(span)
        is_own = not any(edit.start < original.end and original.start < edit.end for edit, _ in self.edits) and (
            original.end - original.start == span.end - span.start
        )
        return is_own and (self.before is None or self.before.is_written(original))

    def places(self, span: Span) -> int:
        """How often the expanded text contains the text from which the begin of `span` comes."""
        begin = self._own_origin(span).start
        copied = sum(copy.source.start <= begin < copy.source.end for copy in self.copies)
        is_replaced = any(edit.start <= begin < edit.end for edit, _ in self.edits)
        return copied + (not is_replaced)

    def _offset(self, offset: int, *, at_end: bool) -> int:
        number = bisect.bisect_right(self.copies, offset - at_end, key=lambda copy: copy.start) - 1
        if number >= 0 and offset - at_end < self.copies[number].end:
            copy = self.copies[number]
            if copy.is_exact:
                return copy.source.start + offset - copy.start
            return copy.source.end if at_end else copy.source.start
        starts, pieces = self._pieces
        number = (bisect.bisect_left if at_end else bisect.bisect_right)(starts, offset) - 1
        if number < 0:
            return offset
        start, end, length = pieces[number]
        into = offset - starts[number]
        if into < length or (at_end and into == length and length > 0):
            return end if at_end else start
        return end + into - length


def expanded_text(path: str, source: str, text: str, edits: Iterable[TextEdit]) -> ExpandedText:
    """The text `text` of the file `source` with edits. Of overlapping edits, the one that begins first is made."""
    kept: list[TextEdit] = []
    for edit in sorted(edits, key=lambda edit: (edit.span.start, -edit.span.end)):
        if not kept or edit.span.start >= kept[-1].span.end:
            kept.append(edit)
    return ExpandedText(path, source, apply_edits(text, tuple(kept)), tuple(kept))


def edited_again(before: ExpandedText, edits: Iterable[TextEdit]) -> ExpandedText:
    """An expanded text with further edits, which do not overlap."""
    ordered = tuple(sorted(edits, key=lambda edit: edit.span))
    earlier = before if before.edits else None
    return ExpandedText(before.path, before.source, apply_edits(before.text, ordered), ordered, (), earlier)
