# SPDX-License-Identifier: Apache-2.0
"""The vertices of a layered graph: nodes, labels, and the points where a line passes a layer."""

from __future__ import annotations

import enum

from roaml.figures.geometry import Extent
from roaml.record import Record


class VertexKind(enum.Enum):
    NODE = "node"
    LABEL = "label"
    PASSING = "passing"


class Vertex(Record, frozen=True):
    """A vertex. `size.width` is its extent along the layer, `size.height` across it."""

    kind: VertexKind
    size: Extent


NODE_DISTANCE = 18.0
LABEL_DISTANCE = 12.0
LINE_DISTANCE = 14.0
"""Distances between neighbours in a layer, in pixels: of two nodes, of a label from a node or line or of a node from a
line, of two lines."""


def distance(left: Vertex, right: Vertex) -> float:
    """The minimum distance between the borders of two neighbours in a layer, in pixels."""
    kinds = {left.kind, right.kind}
    if kinds == {VertexKind.PASSING}:
        return LINE_DISTANCE
    return NODE_DISTANCE if kinds == {VertexKind.NODE} else LABEL_DISTANCE
