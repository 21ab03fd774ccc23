# SPDX-License-Identifier: Apache-2.0
"""The system file as typed data (docs/spec/systems.md)."""

from __future__ import annotations

from dataclasses import dataclass

from roaml.disk import UnreadableReason
from roaml.language import SYSTEM
from roaml.model.kinds import FileKind
from roaml.model.parameters import (
    DEFAULT_MAX_ARRAY_SIZE,
    DEFAULT_RANDOM_VALUES,
    DEFAULT_TICK_RATE,
    MAX_RANDOM_VALUES,
    NANOSECONDS,
    NO_OVERRIDES,
    Overrides,
    Parameters,
    integer,
)
from roaml.model.spelling import meant
from roaml.model.syntax import Name, name_of
from roaml.suggest import close_names
from roaml.text import Span
from roaml.xml_syntax import Document, Element

SECTIONS = ("data_declarations", "behavior_tree", "node_models", "properties")

TREE_TYPES = ("bt.cpp-xml",)
PLUGIN_TYPES = ("bt-plugin-ascxml", "bt-plugin-ros-scxml")
NODE_TYPES = ("node-ascxml", "ros-scxml")


@dataclass(frozen=True, slots=True, eq=False)
class SystemInput:
    """An `<input>`: a file of the system. `section` is the name of the element around it."""

    element: Element
    section: str
    type: Name | None
    src: Name | None


@dataclass(frozen=True, slots=True, eq=False)
class ListedFile:
    """An `<input>` and the file it names.

    Attributes:
        path: "" if no file is named.
        problem: why the file cannot be read; None if it can, or if none is named.
        wanted: what the system takes it for, None if its type says nothing that is known.
        found: what it is.
    """

    input: SystemInput
    path: str
    problem: UnreadableReason | None
    wanted: FileKind | None
    found: FileKind

    @property
    def span(self) -> Span:
        """The position of the file name, or where it is missing."""
        return self.input.src.span if self.input.src else self.input.element.name_span

    @property
    def usable(self) -> bool:
        return bool(self.path) and self.problem is None and self.found is self.wanted


_WANTED = {
    **dict.fromkeys(TREE_TYPES, FileKind.TREE),
    **dict.fromkeys((*PLUGIN_TYPES, *NODE_TYPES), FileKind.MACHINE),
    "xml": FileKind.STRUCTS,
    "json": FileKind.JSON_STRUCTS,
    "jani": FileKind.PROPERTIES,
}


def wanted_kind(entry: SystemInput) -> FileKind | None:
    """The kind of file that a system expects; if its type is misspelled, that of the intended type."""
    if entry.type is None:
        return None
    if entry.type.value == "xml" and entry.section == "properties":
        return FileKind.XML_PROPERTIES
    close = close_names(entry.type.value, _WANTED, 1) if entry.type.value not in _WANTED else (entry.type.value,)
    return _WANTED[close[0]] if close else None


@dataclass(frozen=True, slots=True, eq=False)
class SystemFile:
    """One system file.

    Attributes:
        older: it has the older root (docs/spec/files.md#older-dialect).
        inputs: of all sections, in order; misspelled ones are there as what they are meant to be.
        unread: the sections that may list more than `inputs` says, because an element there has no place.
    """

    element: Element
    older: bool
    parameters: Parameters
    inputs: tuple[SystemInput, ...]
    unread: frozenset[str]

    def parameter(self, name: str) -> Element | None:
        """The element that sets a parameter; if there are several, the last one (docs/spec/systems.md#parameters)."""
        section = _parameter_section(self.element)
        return next((each for each in reversed(section.elements) if each.name == name), None) if section else None


def _parameter_section(root: Element) -> Element | None:
    return root.find("parameters") or root.find("mc_parameters")


def build_system_file(document: Document, overrides: Overrides = NO_OVERRIDES) -> SystemFile | None:
    """The system file in `document`; `None` if its root is not that of one."""
    root = document.root
    if root is None or root.name not in SYSTEM.roots:
        return None
    inputs = [
        SystemInput(child, name, meant(child, "type", _INPUT), meant(child, "src", _INPUT))
        for section in root.elements
        if (name := _section(section))
        for child in section.elements
        if _is_input(child)
    ]
    older = root.name == "convince_mc_tc"
    return SystemFile(root, older, overrides.applied(_parameters(root)), tuple(inputs), _unread(root))


_INPUT = ("type", "src")


def _section(element: Element) -> str:
    """The section that an element is, or is meant to be if its name is misspelled; "" if it is none."""
    if element.name in SECTIONS or element.prefix:
        return element.name if element.name in SECTIONS else ""
    if SYSTEM.find(element.name) is not None or not any(_is_input(child) for child in element.elements):
        return ""
    return next(iter(close_names(element.name, SECTIONS, 1)), "")


def _is_input(element: Element) -> bool:
    """Whether an element of a section is an `<input>`, or is meant to be one: only inputs have a source there."""
    if element.name == "input":
        return True
    return not element.prefix and SYSTEM.find(element.name) is None and meant(element, "src", _INPUT) is not None


def _unread(root: Element) -> frozenset[str]:
    found: set[str] = set()
    for child in root.elements:
        section = _section(child)
        hidden = [each for part in child.elements if not (section and _is_input(part)) for each in part.walk()]
        if any(each.get("src") for each in (hidden if section else (child, *hidden))):
            found |= {section} if section else set(SECTIONS)  # whatever element or parent was meant
    return frozenset(found)


def _parameters(root: Element) -> Parameters:
    section = _parameter_section(root)
    max_time = None
    size, rate, keep_ticking = DEFAULT_MAX_ARRAY_SIZE, DEFAULT_TICK_RATE, False
    random_values = DEFAULT_RANDOM_VALUES
    for element in section.elements if section else ():
        value = name_of(element.get("value"))
        text = value.value if value else ""
        if element.name == "max_time":
            unit = name_of(element.get("unit"))
            number = integer(text)
            if number is not None and unit and unit.value in NANOSECONDS:
                max_time = number * NANOSECONDS[unit.value]
        elif element.name == "max_array_size":
            size = integer(text) or size
        elif element.name == "bt_tick_rate":
            rate = _positive(text) or rate
        elif element.name == "bt_tick_if_not_running":
            keep_ticking = text == "true"
        elif element.name == "random_values":
            number = integer(text)
            if number is not None and 1 <= number <= MAX_RANDOM_VALUES:
                random_values = number
    return Parameters(max_time, size, rate, keep_ticking, random_values)


def _positive(text: str) -> float | None:
    """A positive finite number; `None` for other texts."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0 < value < float("inf") else None
