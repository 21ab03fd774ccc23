# SPDX-License-Identifier: Apache-2.0
"""Pictures of models with the places that their parts stand for: to be drawn by an editor and clicked.

`roaml.views` has diagrams for documents, which know no places.
"""

from roaml.ide.pictures.lit import Lit, lit
from roaml.ide.pictures.machine import machine_picture
from roaml.ide.pictures.picture import Edge, EdgeKind, Node, NodeKind, Picture
from roaml.ide.pictures.ros import ros_picture
from roaml.ide.pictures.tree import tree_picture

__all__ = [
    "Edge",
    "EdgeKind",
    "Lit",
    "Node",
    "NodeKind",
    "Picture",
    "lit",
    "machine_picture",
    "ros_picture",
    "tree_picture",
]
