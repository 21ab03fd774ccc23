# SPDX-License-Identifier: Apache-2.0
"""All machines of a system in one diagram, each in a frame. A plugin is drawn once, however often the tree uses it."""

from __future__ import annotations

from roaml.ide.diagrams.diagram import DiagramEdge, DiagramNode, DiagramNodeKind, Picture
from roaml.ide.diagrams.machine import machine_picture
from roaml.project.analysis import Analysis
from roaml.record import replace
from roaml.text import Location


def system_picture(analysis: Analysis, path: str) -> Picture | None:
    """The diagram; `None` if `path` is not a system file."""
    system = analysis.system(path)
    if system is None:
        return None
    nodes: list[DiagramNode] = []
    edges: list[DiagramEdge] = []
    for file in dict.fromkeys(automaton.path for automaton in system.automata if automaton.path):
        machine, drawn = analysis.machine(file), machine_picture(analysis, file)
        if machine is None or drawn is None:
            continue
        frame = id_in_system(file, "")
        place = Location(file, machine.element.span)
        nodes.append(DiagramNode(frame, DiagramNodeKind.MACHINE, drawn.title, place=place))
        nodes += (
            replace(node, id=id_in_system(file, node.id), parent=id_in_system(file, node.parent))
            for node in drawn.nodes
        )
        edges += (
            replace(edge, source=id_in_system(file, edge.source), target=id_in_system(file, edge.target))
            for edge in drawn.edges
        )
    return Picture(path.replace("\\", "/").rpartition("/")[2], tuple(nodes), tuple(edges))


def id_in_system(path: str, node: str) -> str:
    """The id that the node `node` of a machine has in the diagram of the system; the id of the frame of the machine if
    `node` is ""."""
    return f"{path}#{node}"
