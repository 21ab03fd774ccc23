# SPDX-License-Identifier: Apache-2.0
"""Finds parts that are probably only misspelled. The rule about the misspelling reports them; other rules do not report
that they are missing."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from functools import cache, lru_cache, partial
from itertools import islice

from roaml.language import HL_SCXML, ElementType, Grammar
from roaml.model.machine import Machine
from roaml.suggest import are_similar
from roaml.xml_syntax import Element


def only_missing(element: Element, type_: ElementType, name: str) -> tuple[str, ...]:
    """The required attribute of which `name` is probably a misspelling: the only missing one, if `name` is the only
    unknown attribute of the element. Otherwise empty."""
    names = (a.name for a in element.attributes if ":" not in a.name and a.name != "xmlns")
    unknown = list(islice((attribute for attribute in names if attribute not in type_.attributes), 2))
    if unknown != [name]:
        return ()
    missing = [a.name for a in type_.attributes.values() if a.required and element.get(a.name) is None]
    return tuple(missing) if len(missing) == 1 and not type_.any_attribute else ()


def declaration(machine: Machine, tag: str, name: str) -> bool:
    """Whether an element of a machine is probably intended to declare `name` with a `<tag>`, but cannot be read as a
    declaration.

    This is true for a `<tag>` whose name is missing or misspelled, for a `<tag>` in a place where it is ignored, and
    for an unknown element in the place of a `<tag>`.
    """
    names = _intended_names_of(machine)(tag)
    return "" in names or name in names


@lru_cache(maxsize=1)
def _intended_names_of(machine: Machine) -> Callable[[str], frozenset[str]]:
    """`_intended_names` for one machine, cached for each tag, because an unreadable declaration leads to a finding at
    each of its uses. Only the last machine is kept: its elements need much memory."""
    return cache(partial(_intended_names, machine))


def _intended_names(machine: Machine, tag: str) -> frozenset[str]:
    """The names that unreadable elements are probably intended to declare with a `<tag>`. An empty string in the result
    means that the name could be any."""
    read = {data.element for chart in machine.charts for data in chart.data if data.id}
    read |= {state.element for chart in machine.charts for state in chart.states if state.id}
    key = "key" if tag.startswith("bt_") else "id"
    return frozenset(
        name
        for parent in machine.element.walk()
        for element in parent.elements
        if not element.is_foreign and element not in read
        for name in _names(element, parent, tag, key)
    )


def _names(element: Element, parent: Element, tag: str, key: str) -> Collection[str]:
    """The names that an element is probably intended to declare as `<tag key="…">`; an empty string means any name."""
    values = {attribute.name: attribute.value.strip() for attribute in element.attributes}
    key_value = values.get(key, "")
    if element.name == tag:
        known = HL_SCXML.elements[tag].attributes
        return [key_value] if key_value else [value for name, value in values.items() if name not in known] or [""]
    place = HL_SCXML.find(parent.name)
    allowed = place.children if place else ()
    if element.name in allowed:
        return ()
    if element.name in HL_SCXML.elements:
        return [key_value] if key_value and tag in allowed else ()
    in_place = tag in allowed or among((element,), tag, HL_SCXML)
    return [value for value in values.values() if value] if in_place else ()


def among(elements: Iterable[Element], name: str, grammar: Grammar) -> bool:
    """Whether one of the unknown elements in `elements` is probably a misspelling of `<name>`."""
    return any(
        not element.is_foreign and grammar.find(element.name) is None and are_similar(element.name, name)
        for element in elements
    )


def is_hidden(root: Element, name: str, grammar: Grammar) -> bool:
    """Whether there may be a `<name>` below `root` that is not read, because its own name or the name of an element
    around it is misspelled."""
    unknown = [element for element in root.walk() if not element.is_foreign and grammar.find(element.name) is None]
    return among(unknown, name, grammar) or any(inner.name == name for element in unknown for inner in element.walk())
