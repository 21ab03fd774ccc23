# SPDX-License-Identifier: Apache-2.0
"""Diagrams of models for documents: a machine, the tree, the network of automata, as DOT, Mermaid or PlantUML."""

from roaml.views.graph import Graph, GraphLink, GraphNode, Kind
from roaml.views.machine import machine_graph
from roaml.views.network import network_graph
from roaml.views.notations import NOTATIONS, Notation
from roaml.views.tree import tree_graph

__all__ = [
    "NOTATIONS",
    "Graph",
    "GraphLink",
    "GraphNode",
    "Kind",
    "Notation",
    "machine_graph",
    "network_graph",
    "tree_graph",
]
