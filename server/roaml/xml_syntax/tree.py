# SPDX-License-Identifier: Apache-2.0
"""The XML tree.

- Lossless: the spans of a node's children and tags cover the node's text, including comments and white space. (Only
  elements nested too deeply are left out.)
- The parser creates it, and it is never changed afterwards.
- Elements have no links to their parents. A function that needs ancestors records them while it traverses the tree;
  `Document.path_at` returns the elements around a position.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple, TypeAlias

from roaml.diagnostics import Finding
from roaml.record import Record
from roaml.text import Decoded, Span, joined
from roaml.xml_syntax.escapes import decoded


class Attribute(NamedTuple):
    """An attribute. `name` is as written, including the prefix. `value` has its references resolved; it is empty if the
    attribute has no value.

    `value_span` is between the quotes; `span` is the whole attribute. `has_value` is false in `<a name>`.
    """

    name: str
    value: str
    name_span: Span
    value_span: Span
    span: Span
    has_value: bool = True


class Text(NamedTuple):
    """Character data between tags. `value` has its references resolved; it is empty for an end tag that closes
    nothing, which the tree also represents as text."""

    value: str
    span: Span


class CData(NamedTuple):
    value: str
    span: Span


class Comment(NamedTuple):
    """A comment. `value` is the text between `<!--` and `-->`."""

    value: str
    span: Span


class Instruction(NamedTuple):
    """A processing instruction, XML declaration or document type declaration. `value` is the text after `<?` or `<!`,
    without a closing `?>`."""

    value: str
    span: Span


class Element:
    """An element.

    Attributes:
        name: local name, without prefix.
        prefix: namespace prefix, often empty.
        is_foreign: whether the prefix denotes another namespace than that of the root and that of SCXML.
        is_undeclared: whether no namespace is declared for the prefix, which the parser reports.
        name_span: the whole name in the start tag.
        attributes: in document order; attributes with equal names are all kept.
        nodes: all children, in document order.
        elements: only the child elements.
        span: the whole element. If it has no end tag, it ends with its last child.
        open_span: the start tag. If it has no `>`, it ends before the next `<`.
        close_span: the end tag; `None` if the element is self-closing or was never closed.
        close_name_span: the name in the end tag; `None` if there is no end tag.
        self_closing: written as `<a/>`.
        complete: whether the start tag has its `>` and the element is self-closing or has its end tag.
    """

    __slots__ = (
        "attributes",
        "close_name_span",
        "close_span",
        "complete",
        "elements",
        "is_foreign",
        "is_undeclared",
        "name",
        "name_span",
        "nodes",
        "open_span",
        "prefix",
        "self_closing",
        "span",
    )

    def __init__(self, name: str, prefix: str, name_span: Span, attributes: list[Attribute], open_span: Span) -> None:
        self.name = name
        self.prefix = prefix
        self.is_foreign = False
        self.is_undeclared = False
        self.name_span = name_span
        self.attributes = attributes
        self.open_span = open_span
        self.span = open_span
        self.nodes: list[Node] = []
        self.elements: list[Element] = []
        self.close_span: Span | None = None
        self.close_name_span: Span | None = None
        self.self_closing = False
        self.complete = True

    def get(self, name: str) -> Attribute | None:
        """The first attribute with this name; `None` if there is none."""
        for attribute in self.attributes:
            if attribute.name == name:
                return attribute
        return None

    def find(self, name: str) -> Element | None:
        """The first child element with this local name; `None` if there is none."""
        for child in self.elements:
            if child.name == name:
                return child
        return None

    def walk(self) -> Iterator[Element]:
        """This element and all its descendants, in document order."""
        stack = [self]
        while stack:
            element = stack.pop()
            yield element
            stack.extend(reversed(element.elements))

    @property
    def content_span(self) -> Span:
        """The span between the start tag and the end tag, or the end of the element if it has no end tag."""
        return Span(self.open_span.end, self.close_span.start if self.close_span else self.span.end)

    def __repr__(self) -> str:
        return f"<{self.name} {self.span.start}..{self.span.end}>"


Node: TypeAlias = Element | Text | CData | Comment | Instruction


def children_text(element: Element) -> str:
    """The character data directly inside `element`, without comments."""
    return "".join(node.value for node in element.nodes if isinstance(node, (Text, CData)))


class Document(Record, frozen=True, eq=False):
    """A parsed text. `root` is the first element outside of all others, or `None` if there is no element. An invalid
    file may have several; `nodes` contains all of them."""

    text: str
    root: Element | None
    nodes: tuple[Node, ...]
    findings: tuple[Finding, ...]

    def decoded(self, span: Span) -> Decoded:
        """The text in `span` with its references resolved, and the mapping back to the source."""
        return decoded(self.text, span)

    def content(self, element: Element) -> Decoded | None:
        """The character data directly inside an element, without surrounding white space and comments, and the mapping
        back to the source; `None` if there is none."""
        pieces = []
        for node in element.nodes:
            match node:
                case Text() if node.value:
                    pieces.append(self.decoded(node.span))
                case CData():
                    pieces.append(Decoded(node.value, node.span.start + len("<![CDATA[")))
        content = joined(pieces).stripped() if pieces else None
        return content if content is not None and content.text else None

    def path_at(self, offset: int) -> list[Element]:
        """The elements around `offset`, outermost first; a caret at the end of an unfinished element is inside it."""
        path: list[Element] = []
        level = [node for node in self.nodes if isinstance(node, Element)]
        while level:
            inside = [e for e in level if e.span.start < offset < e.span.end]
            if not inside:
                inside = [e for e in level if e.span.end == offset and not e.complete]
            if not inside:
                break
            path.append(inside[0])
            level = inside[0].elements
        return path
