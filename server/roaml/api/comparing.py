# SPDX-License-Identifier: Apache-2.0
"""Two versions of a model: what changed in its pictures, its declarations and the values of its properties
(docs/comparison.md)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from roaml.api.reading import read
from roaml.figures.svg import CHANGE_STYLES, svg_file
from roaml.figures.themes import AUTOMATIC
from roaml.ide.diagrams import PAGE, DiagramKind, Picture, draw_for, picture_of, tree_picture
from roaml.ide.diagrams.changes import PartChange, changes_of, compared
from roaml.ide.diagrams.diagram import Change
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings
from roaml.record import Record, replace
from roaml.xml_syntax import CData, Element, Text

if TYPE_CHECKING:
    from roaml.experiments.changes import ValueChange
    from roaml.experiments.grid import ExperimentOptions
    from roaml.mocks.mock import Mock
    from roaml.verification.expectations import Expectation
    from roaml.verification.target import VerificationTarget


class ComparedPicture(Record, frozen=True):
    """A diagram of both versions.

    Attributes:
        title: what it shows, such as `state machine Arm`.
        changes: the parts that were added, removed or changed.
    """

    kind: DiagramKind
    title: str
    picture: Picture
    changes: tuple[PartChange, ...]

    def svg(self, theme: str = AUTOMATIC) -> str:
        """The text of an SVG file. By default, it is light, or dark if the reader prefers dark colors."""
        words = "; ".join(f"{change.change.value}: {change.text}" for change in self.changes)
        return svg_file(draw_for(self.kind, self.picture, *PAGE), self.title, theme, CHANGE_STYLES, words)


class ComparedVersion(Record, frozen=True):
    """A version of a model for a comparison of its structure.

    Attributes:
        path: the file of the system, machine or tree.
        settings: as for `check`.
        texts: path -> content that replaces that of the file.
        mocks: the mocks that the picture of a tree without a system shows; `None` for those beside it.
    """

    path: str
    settings: Settings | None = None
    texts: Mapping[str, str | bytes] | None = None
    mocks: Sequence[Mock] | None = None


class StructuralChanges(Record, frozen=True):
    """What changed between two versions of a model, except for values.

    Attributes:
        pictures: the diagrams with changes: the ROS graph, the tree, then the machines.
        declarations: parameters, variables, timers, ports and listed files, which pictures do not show.
        files: the files whose content changed, except for comments and layout.
        is_compared: whether there was anything to compare: JANI models have neither pictures nor these declarations.
    """

    pictures: tuple[ComparedPicture, ...] = ()
    declarations: tuple[PartChange, ...] = ()
    files: tuple[PartChange, ...] = ()
    is_compared: bool = True

    @property
    def is_empty(self) -> bool:
        return not (self.pictures or self.declarations or self.files)


def compare_structure(old: ComparedVersion, new: ComparedVersion, ros_paths: Iterable[str] = ()) -> StructuralChanges:
    """What changed in the pictures and declarations of a model. Models with errors are compared as far as possible.

    Args:
        old, new: the versions: two systems, two machines or two trees. JANI models have no pictures.
        ros_paths: as for `check`.

    Raises:
        PathError: a path does not exist or cannot be read.
    """
    sides = [_Side(version, ros_paths) for version in (old, new) if not version.path.endswith(".jani")]
    if len(sides) < 2:
        return StructuralChanges(is_compared=False)
    before, after = (side.pictures() for side in sides)
    pictures = []
    for key in [*after, *(key for key in before if key not in after)]:
        kind, title = key
        picture = compared(kind, before.get(key), after.get(key))
        changes = changes_of(picture)
        if changes:
            pictures.append(ComparedPicture(kind, title, picture, changes))
    declared = _text_changes(*(side.declarations() for side in sides), shows_texts=True)
    files = _text_changes(*(side.contents() for side in sides), shows_texts=False)
    return StructuralChanges(tuple(pictures), tuple(declared), tuple(files))


def compare_values(
    old: VerificationTarget | None,
    new: VerificationTarget,
    properties: Sequence[str] | None = None,
    options: ExperimentOptions | None = None,
) -> tuple[ValueChange, ...]:
    """How the values of properties changed. The intervals of all estimates are right together with the confidence of
    `options`, and so are therefore all differences.

    Args:
        old: the old version; `None` if it has errors: then each property of the new version has no value before.
        properties: the names of the properties; all if not given. Each must exist in one of the models.

    Raises:
        PropertyError: a property exists in none of the models.
    """
    from roaml.experiments.changes import value_changes  # noqa: PLC0415 - the structure needs no model checker
    from roaml.experiments.enough import together  # noqa: PLC0415
    from roaml.experiments.grid import ExperimentOptions, FixedModel, Grid  # noqa: PLC0415
    from roaml.experiments.points import unknown_point  # noqa: PLC0415
    from roaml.jani.selection import select  # noqa: PLC0415
    from roaml.verification.target import asking  # noqa: PLC0415

    before, after = None if old is None else asking(old, properties or ()), asking(new, properties or ())
    known, known_now = (set() if t is None else {p.name for p in t.properties} for t in (before, after))
    for name in properties or ():
        if name not in known:
            select(after.properties, [name], "model")
    asked, asked_now = (
        () if t is None else tuple(p.name for p in t.properties if properties is None or p.name in properties)
        for t in (before, after)
    )
    count = len(asked) + len(asked_now)
    shared = together(options or ExperimentOptions(), count)
    shared = replace(shared, max_transitions=shared.limits(count).transitions)
    now = tuple(Grid(FixedModel(after), (), asked_now, shared).points())
    if before is None:
        nothing = [unknown_point((), name, "") for name in asked_now]
        return value_changes(nothing, now, frozenset(), (), _expectations(after, asked_now))
    return value_changes(
        tuple(Grid(FixedModel(before), (), asked, shared).points()),
        now,
        frozenset(name for name in known & known_now if _definition(before, name) != _definition(after, name)),
        _expectations(before, asked),
        _expectations(after, asked_now),
    )


def _expectations(target: VerificationTarget, names: Sequence[str]) -> list[Expectation]:
    """What is expected of properties: by their own comparisons with a number, by their files, and by the
    configuration."""
    from roaml.smc.fault import FaultError  # noqa: PLC0415
    from roaml.verification.verifier import checker_of, expectations_of  # noqa: PLC0415

    try:
        compiled = checker_of(target, names).compiled_properties
    except FaultError:  # then the properties have no values either
        return []
    return [e for property_ in compiled for e in expectations_of(property_, target.expectations)]


def _definition(target: VerificationTarget, name: str) -> tuple[object, ...]:
    """What defines a property: its formula, and the edges of its observer, if it has one."""
    formula = next(property_.expression for property_ in target.properties if property_.name == name)
    observers = tuple(a for a in target.model.automata if a.name == f"{name}__observer")
    return (formula, observers)


class _Side:
    """One version of a model."""

    def __init__(self, version: ComparedVersion, ros_paths: Iterable[str]) -> None:
        self.analysis: Analysis = read([version.path], ros_paths, version.settings, version.texts).snapshot.analysis
        self.path = os.path.abspath(version.path)
        self.mocks = version.mocks
        self.files = self.analysis.files_of(self.path) or (self.path,)

    def pictures(self) -> dict[tuple[DiagramKind, str], Picture]:
        """The diagrams of the version, by kind and title."""
        pictures: dict[tuple[DiagramKind, str], Picture] = {}
        kind = self.analysis.kind(self.path)
        if kind is FileKind.SYSTEM:
            self._add(pictures, DiagramKind.ROS, "ROS graph", picture_of(DiagramKind.ROS, self.analysis, self.path))
        if kind in (FileKind.SYSTEM, FileKind.TREE):
            tree = tree_picture(self.analysis, self.path, self.mocks)
            self._add(pictures, DiagramKind.TREE, "behavior tree", tree)
        for file in dict.fromkeys((self.path, *self.files)):
            machine = picture_of(DiagramKind.MACHINE, self.analysis, file)
            if machine is not None:
                name = f"state machine {machine.title or os.path.basename(file)}"
                self._add(pictures, DiagramKind.MACHINE, name, machine)
        return pictures

    def _add(
        self,
        pictures: dict[tuple[DiagramKind, str], Picture],
        kind: DiagramKind,
        title: str,
        picture: Picture | None,
    ) -> None:
        if picture is not None and picture.nodes:
            number = sum(1 for known in pictures if known[0] is kind and known[1].split(" #")[0] == title)
            pictures[kind, title if not number else f"{title} #{number + 1}"] = picture

    def declarations(self) -> dict[str, str]:
        """What the files declare: a name for people -> the text of the element."""
        declared: dict[str, str] = {}
        for shown, file in self._shown_files():
            document = self.analysis.document(file)
            for element in _declaring(document.root) if document is not None and document.root is not None else ():
                declared[f"`{_name_of(element)}` in {shown}"] = _written(element)
        return declared

    def contents(self) -> dict[str, str]:
        """A name for people of each file -> its content without comments and layout."""
        contents: dict[str, str] = {}
        for shown, file in self._shown_files():
            document, source = self.analysis.document(file), self.analysis.source(file)
            if document is not None and document.root is not None:
                contents[shown] = _written(document.root)
            elif source is not None:
                contents[shown] = " ".join(source.text.split())
        return contents

    def _shown_files(self) -> Iterator[tuple[str, str]]:
        """The files, each with a noun phrase: its path relative to the folder of the model. The model itself may have
        different names in both versions."""
        folder = os.path.dirname(self.path)
        for file in dict.fromkeys((self.path, *self.files)):
            relative = os.path.relpath(file, folder).replace("\\", "/")
            yield ("the main file" if file == self.path else f"`{relative}`"), file


_DECLARING = frozenset({"data", "parameter", "instance", "input", "bt", "bt_declare_port_in", "bt_declare_port_out"})
_SECTIONS = frozenset({"parameters", "mocks", "environment"})
"""The elements whose children declare something."""
_NAMES = ("id", "name", "key", "src")


def _declaring(root: Element) -> Iterator[Element]:
    """The elements of a file that declare something that pictures do not show."""
    for element in root.walk():
        if element.name in _DECLARING or (element.name.startswith("ros_") and element in root.elements):
            yield element
        elif element.name in _SECTIONS:
            yield from (child for child in element.elements if child.name not in _DECLARING)


def _name_of(element: Element) -> str:
    named = next((a for key in _NAMES if (a := element.get(key)) is not None), None)
    return f"<{element.name}>" if named is None else f"{element.name} {named.value}"


def _written(element: Element) -> str:
    """The name, the attributes and the content of an element, without layout and comments."""
    parts = [element.name, *(f'{a.name}="{a.value}"' for a in element.attributes)]
    for node in element.nodes:
        if isinstance(node, Element):
            parts.append(_written(node))
        elif isinstance(node, (Text, CData)) and node.value.strip():
            parts.append(" ".join(node.value.split()))
    return f"<{' '.join(parts)}>"


def _text_changes(old: Mapping[str, str], new: Mapping[str, str], *, shows_texts: bool) -> Iterator[PartChange]:
    for name in [*new, *(name for name in old if name not in new)]:
        before, after = old.get(name), new.get(name)
        if before == after:
            continue
        if before is not None and after is not None:
            yield PartChange(Change.CHANGED, f"{name}: `{before}` → `{after}`" if shows_texts else name)
        else:
            text = f"{name}: `{before or after}`" if shows_texts else name
            yield PartChange(Change.ADDED if before is None else Change.REMOVED, text)
