# SPDX-License-Identifier: Apache-2.0
"""What seems to be missing may only be misspelled: the rule about the misspelling says so, and others keep quiet."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.language import Grammar
from roaml.rules.rule import close_names
from roaml.xml import Element


def attribute(element: Element, name: str, known: Iterable[str]) -> bool:
    """Whether an attribute of `element` that is none of `known` was probably meant to be `name`."""
    names = set(known)
    return any(a.name not in names and close_names(a.name, [name]) for a in element.attributes)


def among(elements: Iterable[Element], name: str, grammar: Grammar) -> bool:
    """Whether one of `elements` that the language does not know was probably meant to be `<name>`."""
    return any(
        not element.prefix and grammar.find(element.name) is None and close_names(element.name, [name])
        for element in elements
    )
