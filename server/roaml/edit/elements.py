# SPDX-License-Identifier: Apache-2.0
"""Edits that add, rename and remove elements.

A new element begins on a new line, with the indentation of its siblings. Callers pass its lines with four spaces for
each level of nesting; the edit replaces these spaces by the indentation of the file.

`after`, `first_in`, `last_in` and `removal` return a function that computes the edit, which is called when a fix is
applied.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache, partial, wraps
from typing import ParamSpec

from roaml.diagnostics import Fix
from roaml.regex import regex
from roaml.text import Edit, Span, TextEdit
from roaml.xml_syntax import Attribute, Comment, Document, Element, Node, Text

P = ParamSpec("P")

_LEVEL = "    "
_LINE_END = regex(r"\r\n|\n|\r")


def _lazy(function: Callable[P, TextEdit]) -> Callable[P, Callable[[], TextEdit]]:
    """A variant of `function` that postpones the computation: it returns a function without parameters, which computes
    the edit."""

    @wraps(function)
    def plan(*args: P.args, **kwargs: P.kwargs) -> Callable[[], TextEdit]:
        return partial(function, *args, **kwargs)

    return plan


def indent_of(text: str, element: Element) -> str:
    """The white space at the beginning of the line of an element."""
    start = max(text.rfind("\n", 0, element.span.start), text.rfind("\r", 0, element.span.start)) + 1
    line = text[start : element.span.start]
    return line[: len(line) - len(line.lstrip())]


@lru_cache(maxsize=1)
def level_of(document: Document) -> str:
    """The indentation of one level of nesting: that of the first indented element at the beginning of a line, relative
    to its parent; four spaces if there is none."""
    text = document.text
    for parent in document.root.walk() if document.root else ():
        for child in parent.elements:
            if not text[max(text.rfind("\n", 0, child.span.start), 0) : child.span.start].strip():
                outer, inner = indent_of(text, parent), indent_of(text, child)
                if inner.startswith(outer) and inner != outer:
                    return inner.removeprefix(outer)
    return _LEVEL


@_lazy
def after(document: Document, element: Element, *lines: str) -> TextEdit:
    """An edit that inserts lines after an element, as its next sibling."""
    at = element.span.end
    return TextEdit(Span(at, at), _block(document, indent_of(document.text, element), lines))


@_lazy
def first_in(document: Document, parent: Element, *lines: str) -> TextEdit:
    """An edit that inserts lines into an element, before all its content."""
    if parent.self_closing or not parent.elements:
        return _last_in(document, parent, *lines)
    at = parent.open_span.end
    return TextEdit(Span(at, at), _block(document, _inside(document, parent), lines))


@_lazy
def last_in(document: Document, parent: Element, *lines: str) -> TextEdit:
    """An edit that inserts lines into an element, after all its child elements."""
    return _last_in(document, parent, *lines)


def remove(
    document: Document, element: Element, title: str = "", *, preferred: bool = False, safe: bool = False
) -> Fix:
    """A fix that removes an element. Its default title names the element. A safe fix is also preferred."""
    plan = (removal(document.text, element.span),)
    return Fix(title or f"Remove this `<{element.name}>`", plan, preferred or safe, safe)


def without_tags(document: Document, element: Element, title: str) -> Fix:
    """A fix that replaces an element by its children, which get its indentation."""
    children, text = element.elements, document.text
    outer, inner = indent_of(text, element), indent_of(text, children[0]) if children else ""
    content = text[children[0].span.start : children[-1].span.end] if children else ""
    return Fix(title, (TextEdit(element.span, content.replace(f"\n{inner}", f"\n{outer}")),))


def _last_in(document: Document, parent: Element, *lines: str) -> TextEdit:
    text, outer = document.text, indent_of(document.text, parent)
    if parent.elements:
        at = parent.elements[-1].span.end
        return TextEdit(Span(at, at), _block(document, _inside(document, parent), lines))
    new = _block(document, outer + level_of(document), lines)
    if parent.self_closing:
        slash = parent.open_span.end - 2
        while text[slash - 1].isspace():
            slash -= 1
        return TextEdit(Span(slash, parent.open_span.end), f">{new}\n{outer}</{text[slice(*parent.name_span)]}>")
    inside = parent.content_span
    if parent.close_span is not None and not text[inside.start : inside.end].strip():
        return TextEdit(inside, f"{new}\n{outer}")
    return TextEdit(Span(inside.start, inside.start), new)


def _inside(document: Document, parent: Element) -> str:
    """The indentation of the content of an element with children."""
    child = parent.elements[-1]
    text = document.text
    own_line = not text[max(text.rfind("\n", 0, child.span.start), 0) : child.span.start].strip()
    return indent_of(text, child) if own_line else indent_of(text, parent) + level_of(document)


def _block(document: Document, indent: str, lines: tuple[str, ...]) -> str:
    """The lines as text: each begins with `indent`, followed by the indentation of the document for its level of
    nesting."""
    level = level_of(document)
    new = []
    for line in lines:
        depth = (len(line) - len(line.lstrip(" "))) // len(_LEVEL)
        new.append(f"\n{indent}{level * depth}{line.lstrip(' ')}" if line else "\n")
    return "".join(new)


@_lazy
def removal(text: str, span: Span) -> TextEdit:
    """An edit that removes the text at `span`, the blanks before it, and the line break before these blanks."""
    start = span.start
    while start > 0 and text[start - 1] in " \t":
        start -= 1
    if text[start - 1 : start] == "\n":
        start -= 2 if text[start - 2 : start - 1] == "\r" else 1
    return TextEdit(Span(start, span.end), "")


def removals(document: Document, elements: Iterable[Element]) -> Iterator[Edit]:
    """Edits that remove elements, which do not contain each other, with the comments directly above them. A parent that
    becomes empty becomes self-closing. The root of the document is never removed."""
    unwanted = set(map(id, elements))
    for parent in document.root.walk() if document.root else ():
        children = [child for child in parent.elements if id(child) in unwanted]
        spans = [with_comments(parent, child) for child in children]
        if not children:
            continue
        if parent.complete and all(
            _is_blank(node) or any(s.encloses(node.span) for s in spans) for node in parent.nodes
        ):
            end_of_tag = parent.open_span.end - 1
            yield TextEdit(Span(end_of_tag, parent.span.end), " />")
        else:
            yield from (removal(document.text, span) for span in spans)


def with_comments(parent: Element, child: Element) -> Span:
    """The span of a child element with the comments directly above it, each on a separate line."""
    start = child.span.start
    index = parent.nodes.index(child)
    while index >= 2:
        between, comment = parent.nodes[index - 1], parent.nodes[index - 2]
        before = parent.nodes[index - 3] if index >= 3 else None
        starts_line = before is None or (isinstance(before, Text) and _LINE_END.search(before.value) is not None)
        is_adjacent = _is_blank(between) and isinstance(between, Text) and len(_LINE_END.findall(between.value)) == 1
        if not isinstance(comment, Comment) or not starts_line or not is_adjacent:
            break
        start = comment.span.start
        index -= 2
    return Span(start, child.span.end)


def _is_blank(node: Node) -> bool:
    return isinstance(node, Text) and not node.value.strip()


def set_attribute(element: Element, name: str, value: str) -> TextEdit:
    """An edit that sets an attribute. `value` must not contain special characters of XML. A new attribute is inserted
    before the others."""
    attribute = element.get(name)
    if attribute is not None and attribute.has_value:
        return TextEdit(attribute.value_span, value)
    if attribute is not None:
        return TextEdit(attribute.span, f'{name}="{value}"')
    at = element.name_span.end
    return TextEdit(Span(at, at), f' {name}="{value}"')


def without_attribute(text: str, attribute: Attribute) -> TextEdit:
    """An edit that removes an attribute and the white space before it."""
    start = attribute.span.start
    while text[start - 1].isspace():
        start -= 1
    return TextEdit(Span(start, attribute.span.end), "")


def rename_tag(element: Element, name: str, *, preferred: bool = True) -> Fix:
    """A fix that changes the name of an element in its start tag and its end tag."""
    spans: list[Span] = [element.name_span, *([element.close_name_span] if element.close_name_span else [])]
    return Fix(f"Change to `<{name}>`", tuple(TextEdit(span, name) for span in spans), preferred)


def halts(document: Document, root: Element, states: Iterable[Element]) -> tuple[Edit, ...]:
    """Edits that add a `<bt_halt>`, whose target is the initial state, to each `<state>` of `states` that handles ticks
    but not halts; empty if `root` has no attribute `initial`."""
    initial = root.get("initial")
    edits: list[Edit] = []
    for state in states:
        ticks = [child for child in state.elements if child.name == "bt_tick"]
        if state.name == "state" and ticks and initial and state.find("bt_halt") is None:
            halt = (f'<bt_halt target="{initial.value}">', "    <bt_return_halted />", "</bt_halt>")
            edits.append(after(document, ticks[-1], *halt))
    return tuple(edits)
