# SPDX-License-Identifier: Apache-2.0
"""Removes targets whose probability is 0 with the values of the parameters (docs/spec/parameters.md#uses). AS2FM
rejects them."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal, InvalidOperation

from roaml.expansion.instances import removed
from roaml.text import TextEdit, apply_edits
from roaml.xml_syntax import Document, Element, parse

TARGET, PROBABILITY = "target", "prob"


def without_impossible_targets(text: str) -> str:
    """The text of an expanded machine without targets that are never chosen."""
    document = parse(text)
    if document.root is None:
        return text
    edits = [edit for element in document.root.walk() for edit in _edits(document, element)]
    return apply_edits(text, tuple(edits))


def _edits(document: Document, handler: Element) -> Iterator[TextEdit]:
    targets = [child for child in handler.elements if child.name == TARGET]
    given = [_probability(target) for target in targets]
    rest = 1 - sum((p for p in given if p is not None), Decimal(0))
    for target, probability in zip(targets, given, strict=True):
        if len(targets) > 1 and (rest if probability is None else probability) == 0:
            yield removed(document, target)


def _probability(target: Element) -> Decimal | None:
    attribute = target.get(PROBABILITY)
    try:
        return Decimal(attribute.value.strip()) if attribute is not None else None
    except InvalidOperation:
        return None
