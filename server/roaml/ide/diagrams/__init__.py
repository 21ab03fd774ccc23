# SPDX-License-Identifier: Apache-2.0
"""Interactive diagrams of models, whose parts have positions in the files: an editor draws them.

`roaml.views` contains diagrams for documents, without positions.
"""

from roaml.ide.diagrams.diagram import DiagramEdge, DiagramNode, DiagramNodeKind, EdgeKind, Picture
from roaml.ide.diagrams.highlight import DiagramHighlight, highlights
from roaml.ide.diagrams.machine import machine_picture
from roaml.ide.diagrams.ros import ros_picture
from roaml.ide.diagrams.tree import tree_picture

__all__ = [
    "DiagramEdge",
    "DiagramHighlight",
    "DiagramNode",
    "DiagramNodeKind",
    "EdgeKind",
    "Picture",
    "highlights",
    "machine_picture",
    "ros_picture",
    "tree_picture",
]
