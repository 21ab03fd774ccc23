# SPDX-License-Identifier: Apache-2.0
"""The system file as typed data (docs/spec/systems.md)."""

from __future__ import annotations

from collections.abc import Iterable

from roaml.disk import UnreadableReason
from roaml.durations import NANOSECONDS, integer, reaction_time
from roaml.exhaustive import Vocabulary
from roaml.language import SYSTEM
from roaml.model.kinds import FileKind
from roaml.model.parameters import (
    DEFAULT_MAX_ARRAY_SIZE,
    DEFAULT_RANDOM_VALUES,
    DEFAULT_TICK_RATE,
    MAX_RANDOM_VALUES,
    NO_OVERRIDES,
    SEMANTICS,
    Overrides,
    Parameters,
)
from roaml.model.spelling import meant
from roaml.model.syntax import Name, name_of
from roaml.record import Record
from roaml.suggest import close_names
from roaml.text import Span
from roaml.xml_syntax import Document, Element


class SystemSection(Vocabulary):
    """The sections of a system file that list files, by the names of their elements, in the order of the file."""

    DATA_DECLARATIONS = "data_declarations"
    BEHAVIOR_TREE = "behavior_tree"
    NODE_MODELS = "node_models"
    PROPERTIES = "properties"


TREE_ATTRIBUTE = "tree"
"""The attribute of the input of a plugin that names its tree."""
TICK_RATE = "tick_rate"
"""The attribute of the input of a tree with its own rate."""

SECTION_NAMES = tuple(section.value for section in SystemSection)


TREE_TYPES = ("bt.cpp-xml",)
PLUGIN_TYPES = ("bt-plugin-ascxml", "bt-plugin-ros-scxml")
NODE_TYPES = ("node-ascxml", "ros-scxml")


class SystemInput(Record, frozen=True, eq=False):
    """An `<input>`: a file of the system.

    Attributes:
        section: the section that contains it.
        tree: the name that a tree has in the system, or the name of the tree to which a plugin belongs; "" if it has
            none, or if the plugin belongs to all trees (docs/spec/trees.md#several-trees).
    """

    element: Element
    section: SystemSection
    type: Name | None
    src: Name | None

    @property
    def tree(self) -> str:
        if self.section is not SystemSection.BEHAVIOR_TREE:
            return ""
        is_plugin = required_kind(self) is FileKind.MACHINE
        name = name_of(self.element.get(TREE_ATTRIBUTE if is_plugin else "name"))
        return name.value if name is not None else ""

    @property
    def tick_rate(self) -> float | None:
        """The rate at which a tree is ticked, in Hz; `None` if it is that of the system."""
        rate = name_of(self.element.get(TICK_RATE)) if required_kind(self) is FileKind.TREE else None
        return _positive(rate.value) if rate is not None else None


class ListedFile(Record, frozen=True, eq=False):
    """An `<input>` and the file it names.

    Attributes:
        path: the path of the file; "" if none is named.
        problem: the reason why the file cannot be read; `None` if it can be read, or if none is named.
        required_kind: the kind that the section and the type of the `<input>` require; `None` if the type is unknown.
        kind: the kind of the file itself.
    """

    input: SystemInput
    path: str
    problem: UnreadableReason | None
    required_kind: FileKind | None
    kind: FileKind

    @property
    def span(self) -> Span:
        """The position of the file name; the position of the element name if the file name is missing."""
        return self.input.src.span if self.input.src else self.input.element.name_span

    @property
    def usable(self) -> bool:
        return bool(self.path) and self.problem is None and self.kind is self.required_kind


_REQUIRED_KINDS = {
    **dict.fromkeys(TREE_TYPES, FileKind.TREE),
    **dict.fromkeys((*PLUGIN_TYPES, *NODE_TYPES), FileKind.MACHINE),
    "xml": FileKind.STRUCTS,
    "json": FileKind.JSON_STRUCTS,
    "jani": FileKind.PROPERTIES,
}


def are_named(files: Iterable[ListedFile]) -> bool:
    """Whether each tree of a system has a name of its own, which only a single tree does not need."""
    names = [file.input.tree for file in files if file.required_kind is FileKind.TREE]
    return len(names) < 2 or (len(set(names)) == len(names) and "" not in names)


def required_kind(entry: SystemInput) -> FileKind | None:
    """The kind of file that the section and the type of an `<input>` require; `None` if the type is missing or unknown.
    A misspelled type is read as the most similar one."""
    if entry.type is None:
        return None
    if entry.type.value == "xml" and entry.section is SystemSection.PROPERTIES:
        return FileKind.XML_PROPERTIES
    close = (
        close_names(entry.type.value, _REQUIRED_KINDS, 1)
        if entry.type.value not in _REQUIRED_KINDS
        else (entry.type.value,)
    )
    return _REQUIRED_KINDS[close[0]] if close else None


class SystemFile(Record, frozen=True, eq=False):
    """One system file.

    Attributes:
        older: whether it has the root element of the older dialect (docs/spec/files.md#older-dialect).
        inputs: the inputs of all sections, in order, including inputs with misspelled names.
        unread: the sections that contain a misplaced element, so that they may list files that are not in `inputs`.
    """

    element: Element
    older: bool
    parameters: Parameters
    inputs: tuple[SystemInput, ...]
    unread: frozenset[SystemSection]

    def parameter(self, name: str) -> Element | None:
        """The element that sets the parameter `name`; `None` if there is none. If there are several, it is the last one
        (docs/spec/systems.md#parameters)."""
        section = _parameter_section(self.element)
        return (
            next((element for element in reversed(section.elements) if element.name == name), None) if section else None
        )


def _parameter_section(root: Element) -> Element | None:
    return root.find("parameters") or root.find("mc_parameters")


def build_system_file(document: Document, overrides: Overrides = NO_OVERRIDES) -> SystemFile | None:
    """The system file in `document`; `None` if its root is not that of a system file."""
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


SEMANTICS_ATTRIBUTE = "tree-semantics"
"""The attribute of `<behavior_tree>` that states whose meaning the nodes have. The reference translator ignores it."""

_INPUT = ("type", "src")


def section_named(name: str) -> SystemSection | None:
    """The section whose element has the name `name`; `None` for other elements."""
    return SystemSection(name) if name in SECTION_NAMES else None


def _section(element: Element) -> SystemSection | None:
    """The section that an element represents; `None` if it is not a section. A misspelled name is corrected."""
    if element.name in SECTION_NAMES or element.is_foreign:
        return section_named(element.name)
    if SYSTEM.find(element.name) is not None or not any(_is_input(child) for child in element.elements):
        return None
    return section_named(next(iter(close_names(element.name, SECTION_NAMES, 1)), ""))


def _is_input(element: Element) -> bool:
    """Whether an element of a section is an `<input>`, or an unknown element with the attribute `src`."""
    if element.name == "input":
        return True
    return not element.is_foreign and SYSTEM.find(element.name) is None and meant(element, "src", _INPUT) is not None


def _unread(root: Element) -> frozenset[SystemSection]:
    sections: set[SystemSection] = set()
    for child in root.elements:
        section = _section(child)
        hidden = [element for part in child.elements if not (section and _is_input(part)) for element in part.walk()]
        parameters = {id(part) for part in child.elements if _is_parameter(child, part)}
        candidates = hidden if section else (child, *hidden)
        if any(element.get("src") and id(element) not in parameters for element in candidates):
            sections |= {section} if section else set(SystemSection)  # the intended parent may be any section
    return frozenset(sections)


def _is_parameter(section: Element, element: Element) -> bool:
    """Whether an element is a parameter in the section of parameters. Such an element lists no file: an attribute `src`
    of it is only an unknown attribute."""
    known = SYSTEM.find(section.name)
    return known is not None and section_named(section.name) is None and element.name in known.children


def _parameters(root: Element) -> Parameters:
    section = _parameter_section(root)
    max_time = None
    size, rate, keep_ticking = DEFAULT_MAX_ARRAY_SIZE, DEFAULT_TICK_RATE, False
    random_values, reaction = DEFAULT_RANDOM_VALUES, None
    for element in section.elements if section else ():
        value = name_of(element.get("value"))
        text = value.value if value else ""
        if element.name == "max_time":
            unit = name_of(element.get("unit"))
            number = integer(text)
            if number is not None and unit and unit.value in NANOSECONDS:
                max_time = number * NANOSECONDS[unit.value]
            given = name_of(element.get("reaction_time"))
            reaction = reaction_time(given.value) if given else None
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
    tree = root.find(SystemSection.BEHAVIOR_TREE.value)
    stated = tree.get(SEMANTICS_ATTRIBUTE) if tree is not None else None
    semantics = SEMANTICS.get(stated.value.strip()) if stated is not None else None
    return Parameters(max_time, size, rate, keep_ticking, random_values, reaction, semantics)


def _positive(text: str) -> float | None:
    """A positive finite number; `None` for other texts."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0 < value < float("inf") else None
