# SPDX-License-Identifier: Apache-2.0
"""Pictures of state machines, behavior trees and ROS graphs, as the editor shows them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence

from roaml.api.reading import read
from roaml.figures.layout import LayoutDirection
from roaml.figures.pdf import pdf_file
from roaml.figures.svg import svg_file
from roaml.ide.diagrams import (
    PAGE,
    DiagramKind,
    Picture,
    draw_for,
    draw_outline,
    picture_of,
    tree_picture,
    with_provided_interfaces,
)
from roaml.ide.diagrams import around as _around
from roaml.ide.diagrams import draw as _draw
from roaml.ide.diagrams import matching as _matching
from roaml.mocks.mock import Mock, named_mocks
from roaml.model.kinds import FileKind
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings
from roaml.record import Record
from roaml.suggest import close_names, did_you_mean, listing


class DrawingError(ValueError):
    """Raised if a file does not contain what is to be drawn. The message contains the reason."""


class DrawnPicture(Record, frozen=True):
    """A drawing. A notebook shows it as it is.

    Attributes:
        svg: the text of an SVG file.
        title: the name of the state machine, tree or system.
        kind: what is drawn.
        width, height: the size in pixels.
        files: the files that were read.
    """

    svg: str
    title: str
    kind: DiagramKind
    width: float
    height: float
    files: tuple[str, ...]

    def pdf(self) -> bytes:
        """The same drawing as a PDF file."""
        return pdf_file(self.svg)

    def _repr_svg_(self) -> str:
        return self.svg


def draw(
    path: str,
    kind: DiagramKind | str | None = None,
    *,
    machine: str | None = None,
    around: str | None = None,
    matching: str | None = None,
    mocks: Mapping[str, str] | Sequence[Mock] = (),
    theme: str = "light",
    direction: LayoutDirection | str | None = None,
    outline: bool = False,
    interfaces: bool = False,
    ros_paths: Iterable[str] = (),
    settings: Settings | None = None,
    texts: Mapping[str, str | bytes] | None = None,
) -> DrawnPicture:
    """Draw a state machine, all state machines of a system, a behavior tree, or a ROS graph. Models with errors are
    drawn as far as possible.

    Args:
        path: a system, a state machine, or a tree.
        kind: what is drawn, as a `DiagramKind` or its value (`machine`, `tree`, `ros`, `system`). By default, it fits
            the file: the ROS graph of a system.
        machine: draw the state machine of this name of the system.
        around: of a ROS graph, draw only the node, topic, service or action with this name, what is connected to it,
            and the nodes with which it communicates.
        matching: of a ROS graph, draw only what contains all words of this text in its kind, name or type, and what
            is connected to it.
        mocks: the mocks of the leaves of a tree, which are shown: node -> mock as for `target`, or as `read_mocks`
            returns them.
        theme: `light`, `dark`, `high-contrast` or `high-contrast-light`.
        direction: the direction of links, `down` or `right`. By default, the one in which the drawing fits a page of
            4:3 better.
        outline: draw a tree in a narrow column: a row for each node, with its children indented below it.
        interfaces: draw each topic, service and action of a large ROS graph as a node. By default, if the graph has
            more than 60 nodes, most of them are rows of the node that publishes or serves them.
        ros_paths, settings, texts: as for `check`.

    Raises:
        DrawingError: the file contains nothing of this kind, or nothing that matches.
        PathError: the path does not exist or cannot be read.
    """
    found = read([path], ros_paths, settings, texts)
    analysis, drawn = found.snapshot.analysis, os.path.abspath(path)
    if machine is not None:
        kind, drawn = DiagramKind.MACHINE, _file_of(analysis, machine, path)
    kind = _fitting(analysis, drawn) if kind is None else DiagramKind(kind)
    picture = _picture(analysis, kind, drawn, mocks, path)
    if around is not None or matching is not None:
        picture = _part(kind, picture, around, matching, path)
    elif kind is DiagramKind.ROS and not interfaces:
        picture = with_provided_interfaces(picture)
    if outline:
        if kind is not DiagramKind.TREE:
            raise DrawingError("only behavior trees can be drawn as an outline; draw the tree of the system")
        drawing = draw_outline(picture)
    else:
        drawing = _draw(kind, picture, LayoutDirection(direction)) if direction else draw_for(kind, picture, *PAGE)
    size, svg = drawing.size, svg_file(drawing, picture.title, theme)
    return DrawnPicture(svg, picture.title, kind, size.width, size.height, found.files)


def _picture(
    analysis: Analysis, kind: DiagramKind, drawn: str, mocks: Mapping[str, str] | Sequence[Mock], path: str
) -> Picture:
    """The picture of the file `drawn`. `path` is the file that the user names."""
    if mocks and kind is not DiagramKind.TREE:
        raise DrawingError("mocks are for the leaves of behavior trees; draw the tree of the system")
    declared = named_mocks(mocks) if isinstance(mocks, Mapping) else mocks
    picture = tree_picture(analysis, drawn, declared) if declared else picture_of(kind, analysis, drawn)
    if picture is None or not picture.nodes:
        raise DrawingError(f"{path}: {_NOTHING[kind]}")
    return picture


def _part(kind: DiagramKind, picture: Picture, around: str | None, matching: str | None, path: str) -> Picture:
    if kind is not DiagramKind.ROS:
        raise DrawingError("only a part of a ROS graph can be drawn; draw the ROS graph of the system")
    if matching is not None:
        picture = _matching(picture, matching)
        if not picture.nodes:
            raise DrawingError(f"{path}: nothing in the ROS graph matches `{matching}`")
    if around is None:
        return picture
    ids = {node.label: node.id for node in picture.nodes}
    if around not in ids:
        meant = close_names(around, ids, 1)
        hint = did_you_mean(meant) if meant else f"; it contains {listing(tuple(ids))}"
        raise DrawingError(f"{path}: the ROS graph contains no `{around}`{hint}")
    return _around(picture, ids[around])


_NOTHING = {
    DiagramKind.MACHINE: "the file contains no state machine",
    DiagramKind.TREE: "the file contains no behavior tree; name a tree file, or the system file of a tree",
    DiagramKind.ROS: "the file is not a system; name the system file",
    DiagramKind.SYSTEM: "the file is not a system with state machines; name the system file",
}


def _fitting(analysis: Analysis, path: str) -> DiagramKind:
    """The kind of diagram that fits a file."""
    if analysis.machine(path) is not None:
        return DiagramKind.MACHINE
    return DiagramKind.TREE if analysis.kind(path) is FileKind.TREE else DiagramKind.ROS


def _machines(analysis: Analysis, path: str) -> dict[str, str]:
    """The files of the machines of a system, or of a single machine, by the names of the machines and of their
    instances."""
    named = {
        machine.name.value: file
        for file in dict.fromkeys((path, *analysis.files_of(path)))
        if (machine := analysis.machine(file)) and machine.name
    }
    system = analysis.system(path)
    return named | {a.name: a.path for a in (system.automata if system else ()) if a.path and a.instance is None}


def _file_of(analysis: Analysis, name: str, path: str) -> str:
    """The file of a machine of the system or machine file `path`."""
    machines = _machines(analysis, os.path.abspath(path))
    if not machines:
        raise DrawingError(f"{path}: there are no state machines")
    if name not in machines:
        meant = close_names(name, machines, 1)
        hint = did_you_mean(meant) if meant else f"; the machines are {listing(tuple(machines))}"
        raise DrawingError(f"{path}: there is no state machine `{name}`{hint}")
    return machines[name]
