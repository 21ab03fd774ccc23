# SPDX-License-Identifier: Apache-2.0
"""Interactive diagrams of models, whose parts have positions in the files, and their drawings.

`roaml.views` contains diagrams for other tools, without positions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from roaml.ide.diagrams.collapse import collapsed
from roaml.ide.diagrams.diagram import (
    Detail,
    DetailKind,
    DiagramEdge,
    DiagramKind,
    DiagramNode,
    DiagramNodeKind,
    EdgeKind,
    Picture,
)
from roaml.ide.diagrams.drawings import OUTLINE_WIDTHS, PAGE, draw, draw_for, draw_outline
from roaml.ide.diagrams.highlight import DiagramHighlight, highlights
from roaml.ide.diagrams.machine import machine_picture
from roaml.ide.diagrams.part import around, matching
from roaml.ide.diagrams.provided import with_provided_interfaces
from roaml.ide.diagrams.ros import ros_picture
from roaml.ide.diagrams.system import system_picture
from roaml.ide.diagrams.tree import tree_picture
from roaml.project.analysis import Analysis

__all__ = [
    "OUTLINE_WIDTHS",
    "PAGE",
    "Detail",
    "DetailKind",
    "DiagramEdge",
    "DiagramHighlight",
    "DiagramKind",
    "DiagramNode",
    "DiagramNodeKind",
    "EdgeKind",
    "Picture",
    "around",
    "collapsed",
    "draw",
    "draw_for",
    "draw_outline",
    "highlights",
    "machine_picture",
    "matching",
    "picture_of",
    "ros_picture",
    "system_picture",
    "tree_picture",
    "with_provided_interfaces",
]

_MAKERS: Mapping[DiagramKind, Callable[[Analysis, str], Picture | None]] = {
    DiagramKind.MACHINE: machine_picture,
    DiagramKind.TREE: tree_picture,
    DiagramKind.ROS: ros_picture,
    DiagramKind.SYSTEM: system_picture,
}


def picture_of(kind: DiagramKind, analysis: Analysis, path: str) -> Picture | None:
    """The diagram of a file; `None` if the file has no diagram of this kind. A tree that belongs to no system shows the
    mocks in the file beside it."""
    return _MAKERS[kind](analysis, path)
