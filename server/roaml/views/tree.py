# SPDX-License-Identifier: Apache-2.0
"""A diagram of the executed tree of a system: every node with its name, plugin, ports and number."""

from __future__ import annotations

from roaml.model.expand import Instance, PortConstant
from roaml.model.system import System
from roaml.views.graph import Graph, GraphLink, GraphNode, Kind

_OWN = ("ID", "name")


def tree_graph(system: System) -> Graph:
    nodes = tuple(_node(instance) for instance in system.instances)
    links = tuple(
        GraphLink(str(instance.number), str(child)) for instance in system.instances for child in instance.children
    )
    title = system.tree_paths[0].replace("\\", "/").rpartition("/")[2] if system.tree_paths else "tree"
    return Graph(Kind.TREE, title, nodes, links)


def _node(instance: Instance) -> GraphNode:
    return GraphNode(
        str(instance.number), (title_of(instance), *(text for _, text in ports_of(instance)), str(instance.number))
    )


def title_of(instance: Instance) -> str:
    """The node's name, if it has one, and its plugin."""
    return instance.plugin if instance.name == instance.plugin else f"{instance.name} : {instance.plugin}"


def ports_of(instance: Instance) -> tuple[tuple[str, str], ...]:
    """The names of the ports, conditions and scripts that are set, each with a line of text that shows its value."""
    return tuple(
        (key, f"{key} = {value.text if isinstance(value, PortConstant) else f'{{{value.variable}}}'}")
        for key, value in instance.ports
        if key not in _OWN
    )
