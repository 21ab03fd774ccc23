# SPDX-License-Identifier: Apache-2.0
"""Hover texts in a property file in XML: a property as a sentence, and the names of compared numbers."""

from __future__ import annotations

from roaml.expr.tree import Number, walk
from roaml.ide.describe.markdown import code
from roaml.ide.describe.xml_property_file import described
from roaml.ide.hover.place import Place
from roaml.ide.property_values import named_numbers
from roaml.text import Span


def property_tag(place: Place) -> tuple[Span, str] | None:
    """The description of the property whose tag is at a place; `None` if there is none."""
    file = place.analysis.property_file(place.path)
    for written in file.properties if file is not None else ():
        for span in (written.element.name_span, written.element.close_name_span):
            if file is not None and span is not None and span.contains(place.offset):
                return span, described(file, written)
    return None


def compared_number(place: Place) -> tuple[Span, str] | None:
    """The name of the number at a place in a condition, if it represents the status of a node or the code of a result;
    otherwise `None`."""
    file = place.analysis.property_file(place.path)
    for written in file.properties if file is not None else ():
        for condition in written.expressions:
            for node in walk(condition.tree):
                if isinstance(node, Number) and node.span.contains(place.offset) and file is not None:
                    name = dict(named_numbers(file, condition.tree)).get(node)
                    return None if name is None else (node.span, code(f"{node.value} = {name}"))
    return None
