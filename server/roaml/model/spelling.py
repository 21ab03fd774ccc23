# SPDX-License-Identifier: Apache-2.0
"""Finds attributes whose names are misspelled."""

from __future__ import annotations

from collections.abc import Container

from roaml.model.syntax import Name, name_of
from roaml.suggest import are_similar
from roaml.xml_syntax import Element


def meant(element: Element, name: str, known: Container[str]) -> Name | None:
    """The value of the attribute `name`, or of an attribute with a similar name; `None` if there is neither, or if the
    value is empty.

    Args:
        known: the valid names of attributes, which are not regarded as misspelled.
    """
    if element.get(name) is not None:
        return name_of(element.get(name))
    strange = [a for a in element.attributes if a.name not in known and are_similar(a.name, name)]
    return name_of(strange[0]) if strange else None
