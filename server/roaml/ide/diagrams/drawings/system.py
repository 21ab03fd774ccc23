# SPDX-License-Identifier: Apache-2.0
"""The drawing of all machines of a system, each in a frame with its name. The module `machine` draws the machines."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.figures.assembly import moved
from roaml.figures.drawing import Drawing, Group, Outline, Shape, Tone
from roaml.figures.geometry import Box, Extent
from roaml.figures.layout import LayoutDirection
from roaml.figures.layout.packing import best_rows
from roaml.ide.diagrams.diagram import DiagramNode, DiagramNodeKind, Picture
from roaml.ide.diagrams.drawings.cards import Card, Row, paragraph, title
from roaml.ide.diagrams.drawings.machine import draw_machine
from roaml.record import replace

_MARGIN = 18.0
_DISTANCE = 24.0
"""The distance between the frames of machines, which have margins of their own, in pixels."""
_TITLE_WIDTH = 400.0
_ASPECT = {LayoutDirection.RIGHT: 1.8, LayoutDirection.DOWN: 0.8}


def draw_system(picture: Picture, direction: LayoutDirection) -> Drawing:
    drawings = [_framed(picture, index, direction) for index in _frames(picture)]
    places, size = best_rows([drawing.size for drawing in drawings], _ASPECT[direction], _DISTANCE)
    groups: list[Group] = []
    nodes: dict[int, Box] = {}
    for drawing, (dx, dy) in zip(drawings, places, strict=True):
        groups += [moved(group, dx, dy) for group in drawing.groups]
        nodes |= {index: box.moved(dx, dy) for index, box in drawing.nodes.items()}
    return Drawing(size, tuple(groups), nodes)


def _frames(picture: Picture) -> Iterator[int]:
    return (index for index, node in enumerate(picture.nodes) if node.kind is DiagramNodeKind.MACHINE)


def _framed(picture: Picture, frame: int, direction: LayoutDirection) -> Drawing:
    """A machine in its frame. In the picture, the nodes of the machine follow the node `frame`."""
    name = picture.nodes[frame]
    end = next((index for index in _frames(picture) if index > frame), len(picture.nodes))
    own = [_inside(node, name.id) for node in picture.nodes[frame + 1 : end]]
    ids = {node.id for node in own}
    edges = [index for index, edge in enumerate(picture.edges) if edge.source in ids]
    drawn = draw_machine(Picture(name.label, tuple(own), tuple(picture.edges[index] for index in edges)), direction)
    counts = (Row(paragraph(detail.text, _TITLE_WIDTH, "muted"), is_joined=True) for detail in name.details)
    heading = Card((Row(title(name.label, _TITLE_WIDTH)), *counts))
    top = heading.size.height
    size = Extent(max(drawn.size.width + 2 * _MARGIN, heading.size.width), drawn.size.height + top + _MARGIN)
    box = Box(0, 0, *size)
    items = (Shape(box, Outline.ROUNDED, "frame"), *heading.items(Box(0, 0, size.width, top)))
    outer = Group("node", Tone.PLAIN, items, "machine", node=frame)
    groups = [_renumbered(moved(group, _MARGIN, top), frame + 1, edges) for group in drawn.groups]
    boxes = {index + frame + 1: place.moved(_MARGIN, top) for index, place in drawn.nodes.items()}
    return Drawing(size, (outer, *groups), {frame: box, **boxes})


def _inside(node: DiagramNode, frame: str) -> DiagramNode:
    return replace(node, parent="") if node.parent == frame else node


def _renumbered(group: Group, first: int, edges: list[int]) -> Group:
    """A group of the drawing of one machine, with the indexes that its nodes and edges have in the whole picture.

    Args:
        first: the index of the first node of the machine.
        edges: the indexes of the edges of the machine.
    """
    items = tuple(_renumbered(item, first, edges) if isinstance(item, Group) else item for item in group.items)
    node = None if group.node is None else group.node + first
    return replace(group, items=items, node=node, edges=tuple(edges[index] for index in group.edges))
