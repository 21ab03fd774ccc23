# SPDX-License-Identifier: Apache-2.0
"""The hover text for a place in a file, as Markdown.

- `place` looks up the place once. Each of the other modules describes one kind of place, and none calls another.
- The hover text of a name describes its symbol. At other places, elements, attributes, values, functions and operators
  have the documentation of their language.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.describe import describe
from roaml.ide.describe.markdown import paragraphs
from roaml.ide.hover.experiment_key import experiment_key_at
from roaml.ide.hover.expression import in_expression
from roaml.ide.hover.library_node import of_library
from roaml.ide.hover.listed_file import listed_file
from roaml.ide.hover.markup import in_markup
from roaml.ide.hover.mock import mock_at
from roaml.ide.hover.place import Place, place_at
from roaml.ide.hover.possible_values import possible_values
from roaml.ide.hover.property_file import global_variable, in_json
from roaml.ide.hover.setting import setting_at
from roaml.ide.hover.tree import tree_node
from roaml.ide.hover.xml_property_file import compared_number, property_tag
from roaml.model.config_files import CONFIG_FILES
from roaml.model.kinds import EXPERIMENT_SUFFIX, MOCKS_EXTENSION, FileKind
from roaml.project.analysis import Analysis
from roaml.project.paths import name_of
from roaml.record import Record
from roaml.text import Span

SEPARATOR = "\n\n---\n\n"
"""The separator between the descriptions of a name in several systems."""

_JSON = (FileKind.PROPERTIES, FileKind.JANI_MODEL)


class Hover(Record, frozen=True):
    """`span` is the part of the file that `text` describes."""

    span: Span
    text: str


def hover(analysis: Analysis, path: str, offset: int) -> Hover | None:
    """The hover at a place; `None` if there is none."""
    if name_of(path) in CONFIG_FILES:
        source = analysis.source(path)
        setting = None if source is None else setting_at(path, source.text, offset)
        return None if setting is None else Hover(*setting)
    if path.endswith(EXPERIMENT_SUFFIX):
        source = analysis.source(path)
        key = None if source is None else experiment_key_at(analysis, source, offset)
        return None if key is None else Hover(*key)
    if path.endswith(MOCKS_EXTENSION):
        source = analysis.source(path)
        mock = None if source is None else mock_at(source.text, offset)
        return None if mock is None else Hover(*mock)
    place = place_at(analysis, path, offset)
    if place is None:
        return None
    if (node := of_library(place)) is not None:
        place_in_system = tree_node(place)
        return Hover(node[0], paragraphs(node[1], place_in_system[1] if place_in_system is not None else ""))
    span, text = None, ""
    for described, more in _descriptions(place):
        if more and more not in text:
            span = span or described
            is_second = place.kind is FileKind.PROPERTIES and text
            text = f"{more}{SEPARATOR}{text}" if is_second else paragraphs(text, more)
    return Hover(span, paragraphs(text, possible_values(place))) if span is not None else None


def _descriptions(place: Place) -> Iterator[tuple[Span, str]]:
    """The descriptions for a place. At a name, the description of its symbol comes first; other descriptions follow
    only if they add information."""
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
    """The description of the name at a place in each system of the file; `None` if there is none."""
    texts = dict.fromkeys(
        describe(place.analysis, name.symbol, place.text[name.span.start : name.span.end]) for name in place.names
    )
    texts.pop("", None)
    return (place.names[0].span, SEPARATOR.join(texts)) if texts else None
