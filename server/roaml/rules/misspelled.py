# SPDX-License-Identifier: Apache-2.0
"""What seems to be missing may only be misspelled: the rule about the misspelling says so, and others keep quiet."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from roaml.language import HL_SCXML, Grammar
from roaml.model.machine import Machine
from roaml.rules.rule import close_names
from roaml.xml import Element


def attribute(element: Element, name: str, known: Iterable[str]) -> bool:
    """Whether an attribute of `element` that is none of `known` was probably meant to be `name`."""
    names = set(known)
    return any(a.name not in names and close_names(a.name, [name]) for a in element.attributes)


def declaration(root: Element, tag: str, key: str, name: str, grammar: Grammar, read: Collection[Element] = ()) -> bool:
    """Whether something below `root` is probably meant to be `<tag key="name">`, but cannot be read as that.

    It is a `<tag>` whose `key` is missing or misspelled, one that stands where it does not count, or another element in
    place of a `<tag>`. Those in `read` are what they say.
    """
    return any(
        _is_meant(element, parent, tag, key, name, grammar)
        for parent in root.walk()
        for element in parent.elements
        if not element.prefix and element not in read
    )


def _is_meant(element: Element, parent: Element, tag: str, key: str, name: str, grammar: Grammar) -> bool:
    values = {attribute.name: attribute.value.strip() for attribute in element.attributes}
    if element.name == tag:
        type_ = grammar.find(tag)
        known = type_.attributes if type_ else ()
        strange = [value for attribute, value in values.items() if attribute not in known]
        said = [values[key]] if values.get(key) else strange
        return name in said or not said
    place = grammar.find(parent.name)
    allowed = place.children if place else ()
    if element.name in allowed:
        return False
    if element.name in grammar.elements:
        return tag in allowed and values.get(key) == name
    return name in values.values() and (tag in allowed or among((element,), tag, grammar))


def data(machine: Machine, name: str) -> bool:
    """Whether a machine probably means to declare the variable `name`, but in a way that cannot be read."""
    read = {data.element for chart in machine.charts for data in chart.data if data.id}
    return declaration(machine.element, "data", "id", name, HL_SCXML, read)


def among(elements: Iterable[Element], name: str, grammar: Grammar) -> bool:
    """Whether one of `elements` that the language does not know was probably meant to be `<name>`."""
    return any(
        not element.prefix and grammar.find(element.name) is None and close_names(element.name, [name])
        for element in elements
    )
