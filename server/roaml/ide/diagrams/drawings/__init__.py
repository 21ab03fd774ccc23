# SPDX-License-Identifier: Apache-2.0
"""Drawings of diagrams: the position and the style of each part.

The editor and the command line use the same drawings. A drawing has one of two directions: for an area that is wider
than it is high, or higher than it is wide. A tree also has a narrow and a wide outline.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from roaml.figures.drawing import Drawing
from roaml.figures.layout import LayoutDirection
from roaml.ide.diagrams.diagram import DiagramKind, Picture
from roaml.ide.diagrams.drawings.machine import draw_machine
from roaml.ide.diagrams.drawings.outline import OUTLINE_WIDTHS, draw_outline
from roaml.ide.diagrams.drawings.ros import draw_ros
from roaml.ide.diagrams.drawings.system import draw_system
from roaml.ide.diagrams.drawings.tree import draw_tree

_PAINTERS: Mapping[DiagramKind, Callable[[Picture, LayoutDirection], Drawing]] = {
    DiagramKind.MACHINE: draw_machine,
    DiagramKind.TREE: draw_tree,
    DiagramKind.ROS: draw_ros,
    DiagramKind.SYSTEM: draw_system,
}

__all__ = ["OUTLINE_WIDTHS", "PAGE", "draw", "draw_for", "draw_outline", "scale"]

PAGE = (1200.0, 900.0)
"""The width and height of the area for a drawing in a document, in pixels."""


def draw(kind: DiagramKind, picture: Picture, direction: LayoutDirection) -> Drawing:
    """The drawing of a diagram with a direction."""
    return _PAINTERS[kind](picture, direction)


def draw_for(kind: DiagramKind, picture: Picture, width: float, height: float) -> Drawing:
    """The drawing, in the direction that needs the smaller reduction, for an area of this size. If both directions need
    the same factor, the drawing with the smaller area is returned."""
    drawings = [draw(kind, picture, direction) for direction in LayoutDirection]
    return max(drawings, key=lambda drawing: (scale(drawing, width, height), -drawing.size.width * drawing.size.height))


def scale(drawing: Drawing, width: float, height: float) -> float:
    """The factor by which a drawing is reduced to fit into an area; 1 if it fits without a reduction."""
    return min(1.0, width / max(1.0, drawing.size.width), height / max(1.0, drawing.size.height))
