# SPDX-License-Identifier: Apache-2.0
"""A drawing: groups of shapes, lines and texts with their places, in pixels.

- Every text is inside the box of its group's shape, and none is smaller than `text.SMALL`.
- A `role` names an element in the style sheet, and a `tone` its color there.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator, Mapping
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.text import text_width
from roaml.record import Record


class Tone(enum.Enum):
    """The meaning of a color."""

    PLAIN = "plain"
    EVENT = "event"
    ROS = "ros"
    TREE = "tree"
    CHANCE = "chance"
    BLACKBOARD = "blackboard"
    TOPIC = "topic"
    SERVICE = "service"
    ROS_ACTION = "ros-action"
    CONTROL = "control"
    DECORATOR = "decorator"
    ACTION = "action"
    CONDITION = "condition"
    SUBTREE = "subtree"
    IDLE = "idle"
    RUNNING = "running"
    SUCCESS = "success"
    FAILURE = "failure"
    ADDED = "added"
    REMOVED = "removed"
    CHANGED = "changed"
    SERIES_1 = "series-1"
    SERIES_2 = "series-2"
    SERIES_3 = "series-3"
    SERIES_4 = "series-4"
    SERIES_5 = "series-5"
    SERIES_6 = "series-6"


class Outline(enum.Enum):
    """The form of a shape within its box."""

    RECTANGLE = "rectangle"
    ROUNDED = "rounded"
    PILL = "pill"
    HEXAGON = "hexagon"
    CUT = "cut"
    DOUBLE = "double"


MAX_ROUNDING = 24.0
"""The maximum radius of the corners of a `PILL`, in pixels. The ends of lower pills are half circles."""


class Shape(Record, frozen=True):
    box: Box
    outline: Outline
    role: str

    @property
    def rounding(self) -> float:
        """The radius of the corners, in pixels; 0 for outlines with other corners."""
        match self.outline:
            case Outline.ROUNDED:
                return min(7.0, self.box.height / 2)
            case Outline.PILL:
                return min(self.box.width / 2, self.box.height / 2, MAX_ROUNDING)
            case Outline.RECTANGLE:
                return 2.0
            case Outline.DOUBLE:
                return 3.0
            case Outline.HEXAGON | Outline.CUT:
                return 0.0
            case _:
                return assert_never(self.outline)


class TextItem(Record, frozen=True):
    """One line of text; `x` is its left end, `y` its base line."""

    text: str
    x: float
    y: float
    size: float
    role: str
    bold: bool = False

    @property
    def box(self) -> Box:
        """The area of the letters of the text, in the widest font."""
        width = text_width(self.text, self.size, bold=self.bold)
        return Box(self.x, self.y - 0.8 * self.size, width, self.size)


class Polyline(Record, frozen=True):
    """A polyline, usually with round corners. With `has_arrow`, it has an arrow head at its end."""

    points: tuple[Point, ...]
    has_arrow: bool = False
    role: str = "line"
    is_round: bool = True


class Area(Record, frozen=True):
    """A filled area with straight borders; `points` are its corners."""

    points: tuple[Point, ...]
    role: str


class Glyph(Record, frozen=True):
    """A small symbol of strokes; `strokes` are polylines in the unit square."""

    box: Box
    strokes: tuple[tuple[Point, ...], ...]


class Group(Record, frozen=True):
    """Items that belong together.

    Attributes:
        role: the name of the group in the style sheet: `node`, `edge`, `link`, `label`, `frame`, ...
        kind: the kind of the node or edge, for the style sheet.
        node: the index of the node that the group shows, if it shows one.
        edges: the indexes of the edges that the group shows.
        hint: the whole text, if the items show only a part of it.
        step: the number of the step of a run that the group shows.
        key: what the group shows, for views in which it can be clicked; "" if nothing.
    """

    role: str
    tone: Tone
    items: tuple[Item, ...]
    kind: str = ""
    node: int | None = None
    edges: tuple[int, ...] = ()
    hint: str = ""
    step: int | None = None
    key: str = ""


Leaf: TypeAlias = Shape | TextItem | Polyline | Area | Glyph
Item: TypeAlias = Leaf | Group


class Drawing(Record, frozen=True):
    """All groups of a drawing, and its size. `nodes` are the boxes of the nodes by their indexes."""

    size: Extent
    groups: tuple[Group, ...]
    nodes: Mapping[int, Box]

    def walk(self) -> Iterator[tuple[tuple[Group, ...], Leaf]]:
        """Every item with the groups that contain it, the outermost first."""
        for group in self.groups:
            yield from _walk(group, ())


def _walk(group: Group, around: tuple[Group, ...]) -> Iterator[tuple[tuple[Group, ...], Leaf]]:
    inside = (*around, group)
    for item in group.items:
        if isinstance(item, Group):
            yield from _walk(item, inside)
        else:
            yield inside, item
