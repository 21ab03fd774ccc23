# SPDX-License-Identifier: Apache-2.0
"""The layout of XML.

- Comments, instructions and CDATA sections are not changed. In an element with character data or with
  `xml:space="preserve"`, only the tags are formatted, not the content.
- Each child has its own line, with two exceptions: an element that is written on one line and has one child stays on
  one line, and a comment at the end of a line stays there. Several blank lines become one.
- Attributes on several lines get one line each, below the first one or one level deeper, as in the file. A tag that is
  too long is wrapped one level deeper.
- `<else />` and `<elseif />` are aligned with their `<if>` or with its other children, as in the file.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from roaml.ide.formatting.layout import FileLayout, Spacing, breaks, new_line
from roaml.text import Span
from roaml.xml_syntax import CData, Comment, Document, Element, Instruction, Node, Text
from roaml.xml_syntax.names import SPACE

_HARMLESS = {"duplicate-attribute", "undefined-entity", "document-type"}
"""The codes of findings that do not prevent formatting, besides those about what BehaviorTree.CPP tolerates."""
_MARKERS = {"else", "elseif"}


def gaps(document: Document, layout: FileLayout) -> Iterator[Spacing]:
    """The new white space of a document; empty if the document has syntax errors."""
    if document.root is not None and all(
        finding.tolerated or finding.code in _HARMLESS for finding in document.findings
    ):
        yield from _Formatter(document.text, layout).document(document)


class _Formatter:
    def __init__(self, text: str, layout: FileLayout) -> None:
        self.text = text
        self.layout = layout

    def document(self, document: Document) -> Iterator[Spacing]:
        items = _items(document.nodes)
        yield Spacing(Span(0, items[0].span.start), "")
        yield from self.lines(items, 0)
        yield Spacing(Span(items[-1].span.end, len(self.text)), "\n")

    def lines(self, items: Sequence[Node], depth: int, markers: int | None = None) -> Iterator[Spacing]:
        """The gaps between siblings and inside of them. `markers` is the depth of `<else />` and `<elseif />` if it is
        not that of the other siblings."""
        last = items[0]
        for item in items:
            here = depth if markers is None or not _is_marker(item) else markers
            if item is not last:
                yield self.before(last.span.end, item, here)
            if isinstance(item, Element):
                yield from self.element(item, here)
            last = item

    def before(self, end: int, item: Node, depth: int) -> Spacing:
        """The gap between the offset `end`, at which the previous sibling or tag ends, and `item`."""
        space = Span(end, item.span.start)
        written = self.text[space.start : space.end]
        if isinstance(item, Comment) and not breaks(written):
            return Spacing(space, " ")
        return Spacing(space, new_line(written, self.layout.indent(depth)))

    # -------------------------------------------------------------- elements

    def element(self, element: Element, depth: int) -> Iterator[Spacing]:
        flat = self.flat_length(element)
        if flat is not None and self.layout.column(depth) + flat <= self.layout.line_length:
            yield from self.flat(element)
            return
        yield from self.tag(element, depth)
        if element.close_span is not None:
            yield from self.end_tag(element)
            if not self.is_verbatim(element):
                yield from self.content(element, depth, element.close_span)

    def content(self, element: Element, depth: int, close: Span) -> Iterator[Spacing]:
        items = _items(element.nodes)
        inside = element.content_span
        indent = self.layout.indent(depth)
        if not items:
            yield Spacing(inside, f"\n{indent}" if breaks(self.raw(inside)) else "")
            return
        markers = depth if element.name == "if" and self.is_level(element) else None
        first = depth if markers is not None and _is_marker(items[0]) else depth + 1
        yield self.before(inside.start, items[0], first)
        yield from self.lines(items, depth + 1, markers)
        end = Span(items[-1].span.end, close.start)
        yield Spacing(end, new_line(self.raw(end), indent))

    def is_verbatim(self, element: Element) -> bool:
        """Whether white space inside an element is significant."""
        space = element.get("xml:space")
        if space is not None and space.value == "preserve":
            return True
        return any(
            isinstance(node, CData) or (isinstance(node, Text) and self.raw(node.span).strip(SPACE))
            for node in element.nodes
        )

    def is_level(self, element: Element) -> bool:
        """Whether the first `<else />` or `<elseif />` in an `<if>` is aligned with the `<if>`."""
        marker = next((child for child in element.elements if _is_marker(child)), None)
        if marker is None:
            return False
        before, indent = self.line_before(marker.span.start)
        return bool(before.strip()) or indent <= self.line_before(element.span.start)[1]

    def line_before(self, offset: int) -> tuple[str, int]:
        """The text between the beginning of a line and an offset, and the indentation of the line in columns."""
        start = max(self.text.rfind("\n", 0, offset), self.text.rfind("\r", 0, offset)) + 1
        before = self.text[start:offset].expandtabs(self.layout.width)
        return before, len(before) - len(before.lstrip(SPACE))

    # ------------------------------------------------------------------ tags

    def tag(self, element: Element, depth: int) -> Iterator[Spacing]:
        """The gaps in a start tag."""
        attributes = element.attributes
        between = self.between(element)
        written = [self.raw(space) for space in between]
        if any(map(breaks, written)):
            below = len(self.raw(Span(element.open_span.start, element.name_span.end))) + 1
            aligned = not breaks(written[0])
        elif len(attributes) > 1 and self.layout.column(depth) + self.tag_length(element) > self.layout.line_length:
            below, aligned = 0, False
        else:
            yield from self.flat_tag(element)
            return
        indent = self.layout.indent(depth) + " " * below if aligned else self.layout.indent(depth + 1)
        for number, space in enumerate(between):
            yield Spacing(space, " " if aligned and number == 0 else f"\n{indent}")
        yield from self.tag_rest(element)

    def flat_tag(self, element: Element) -> Iterator[Spacing]:
        for space in self.between(element):
            yield Spacing(space, " ")
        yield from self.tag_rest(element)

    def tag_rest(self, element: Element) -> Iterator[Spacing]:
        """The gaps around `=` and at the end of a start tag."""
        for attribute in element.attributes:
            equals = self.text.index("=", attribute.name_span.end)
            yield Spacing(Span(attribute.name_span.end, equals), "")
            yield Spacing(Span(equals + 1, attribute.value_span.start - 1), "")
        last = element.attributes[-1].span.end if element.attributes else element.name_span.end
        slash = " " if element.self_closing else ""
        yield Spacing(Span(last, element.open_span.end - (2 if element.self_closing else 1)), slash)

    def end_tag(self, element: Element) -> Iterator[Spacing]:
        if element.close_span is not None and element.close_name_span is not None:
            yield Spacing(Span(element.close_name_span.end, element.close_span.end - 1), "")

    def between(self, element: Element) -> list[Span]:
        """The spans of the white space before the attributes."""
        ends = [element.name_span.end, *(attribute.span.end for attribute in element.attributes)]
        return [Span(end, attribute.span.start) for end, attribute in zip(ends, element.attributes, strict=False)]

    # ----------------------------------------------------------- on one line

    def flat(self, element: Element) -> Iterator[Spacing]:
        """The gaps of an element on one line."""
        yield from self.flat_tag(element)
        yield from self.end_tag(element)
        if element.close_span is None or self.is_verbatim(element):
            return
        at = element.open_span.end
        for item in _items(element.nodes):
            yield Spacing(Span(at, item.span.start), "")
            if isinstance(item, Element):
                yield from self.flat(item)
            at = item.span.end
        yield Spacing(Span(at, element.close_span.start), "")

    def flat_length(self, element: Element) -> int | None:
        """The length of an element on one line, in columns; `None` if it is not on one line or has several children."""
        if any(end in self.raw(element.span) for end in "\r\n"):
            return None
        length = self.tag_length(element)
        if element.close_span is None or element.close_name_span is None:
            return length
        length += len(self.raw(element.close_name_span)) + 3
        if self.is_verbatim(element):
            inside = element.content_span
            return length + inside.end - inside.start
        items = _items(element.nodes)
        if len(items) > 1:
            return None
        for item in items:
            inner = self.flat_length(item) if isinstance(item, Element) else item.span.end - item.span.start
            if inner is None:
                return None
            length += inner
        return length

    def tag_length(self, element: Element) -> int:
        """The length of a start tag with all its attributes on one line, in columns."""
        length = element.name_span.end - element.open_span.start + (3 if element.self_closing else 1)
        for attribute in element.attributes:
            name, value = attribute.name_span, attribute.value_span
            length += name.end - name.start + value.end - value.start + 4
        return length

    def raw(self, span: Span) -> str:
        return self.text[span.start : span.end]


def _items(nodes: Sequence[Node]) -> list[Element | CData | Comment | Instruction]:
    """All nodes except text."""
    return [node for node in nodes if not isinstance(node, Text)]


def _is_marker(node: Node) -> bool:
    return isinstance(node, Element) and node.name in _MARKERS
