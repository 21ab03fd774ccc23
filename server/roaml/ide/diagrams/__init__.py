# SPDX-License-Identifier: Apache-2.0
"""Pictures of models with the places that their parts stand for: to be drawn by an editor and clicked.

`roaml.views` has diagrams for documents, which know no places.
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
