# SPDX-License-Identifier: Apache-2.0
"""What is known of the thing at a place, as Markdown.

- `place` looks up what is there, once; each module beside it describes one kind of thing, and none calls another.
- A name says what it denotes; where there is none, elements, attributes, values, functions and operators say what their
  language says of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from roaml.ide.describe import describe
from roaml.ide.describe.markdown import paragraphs
from roaml.ide.hover.expression import in_expression
from roaml.ide.hover.listed_file import listed_file
from roaml.ide.hover.lone_tree import of_library
from roaml.ide.hover.markup import in_markup
from roaml.ide.hover.place import Place, place_at
from roaml.ide.hover.property_file import global_variable, in_json
from roaml.ide.hover.tree import tree_node
from roaml.ide.hover.xml_property_file import compared_number, property_tag
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.text import Span

SEPARATOR = "\n\n---\n\n"
"""Between the things that a name denotes in several systems."""

_JSON = (FileKind.PROPERTIES, FileKind.JANI_MODEL)


@dataclass(frozen=True, slots=True)
class Hover:
    """`span` is what `text` is about."""

    span: Span
    text: str


def hover(analysis: Analysis, path: str, offset: int) -> Hover | None:
    """The hover at a place; `None` if there is none."""
    place = place_at(analysis, path, offset)
    if place is None:
        return None
    if (node := of_library(place)) is not None:
        return Hover(*node)
    span, text = None, ""
    for described, more in _descriptions(place):
        if more and more not in text:
            span = span or described
            is_second = place.kind is FileKind.PROPERTIES and text
            text = f"{more}{SEPARATOR}{text}" if is_second else paragraphs(text, more)
    return Hover(span, text) if span is not None else None


def _descriptions(place: Place) -> Iterator[tuple[Span, str]]:
    """What is known: with a name there, only what adds to what the name says."""
    if (name := _named(place)) is not None:
        yield name
    if place.kind in _JSON:
        described = global_variable(place) or (None if name else in_json(place))
    else:
        in_file = property_tag(place) or compared_number(place) if place.kind is FileKind.XML_PROPERTIES else None
        described = None if name else in_file or in_expression(place) or listed_file(place) or in_markup(place)
    if described is not None:
        yield described
    if place.kind is FileKind.TREE and (node := tree_node(place)):
        yield node


def _named(place: Place) -> tuple[Span, str] | None:
    """What the name at a place denotes, in each system of the file; None if nothing is known of it."""
    texts = dict.fromkeys(
        describe(place.analysis, name.symbol, place.text[name.span.start : name.span.end]) for name in place.names
    )
    texts.pop("", None)
    return (place.names[0].span, SEPARATOR.join(texts)) if texts else None
