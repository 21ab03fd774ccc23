# SPDX-License-Identifier: Apache-2.0
"""Layouts: layered graphs with orthogonal lines, trees, and outlines of trees.

The layered layout has the classic steps (Sugiyama, Tagawa, Toda 1981): links that close cycles are reversed (`cycles`),
nodes are assigned to layers (`layers`), ordered within them (`order`), placed (`positions`), moved so that lines are
straight (`straight`), and connected by orthogonal lines on tracks between the layers (`tracks`). A label is treated as
a node on its link. So no line crosses a node or a label, and no label overlaps another one, by construction. Long lines
and rings are read like text (`lines`).
"""

from roaml.figures.layout.graph import Layout, LayoutDirection, Link, Route
from roaml.figures.layout.layered import layered
from roaml.figures.layout.nested import Boxes, nested
from roaml.figures.layout.outline import outline
from roaml.figures.layout.tidy import tidy_tree

__all__ = ["Boxes", "Layout", "LayoutDirection", "Link", "Route", "layered", "nested", "outline", "tidy_tree"]
