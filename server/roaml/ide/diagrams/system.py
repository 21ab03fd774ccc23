# SPDX-License-Identifier: Apache-2.0
"""All machines of a system in one diagram, each in a frame. A machine is drawn once, however often the system lists it
or its trees use it; the frame states how often that is."""

from __future__ import annotations

from collections.abc import Sequence

from roaml.ide.diagrams.diagram import Detail, DetailKind, DiagramEdge, DiagramNode, DiagramNodeKind, Picture
from roaml.ide.diagrams.machine import machine_picture
from roaml.model.system import SystemAutomaton
from roaml.project.analysis import Analysis
from roaml.record import replace
from roaml.text import Location

MAX_NAMES = 5
"""The maximum number of names of copies of a machine that a frame states."""


def system_picture(analysis: Analysis, path: str) -> Picture | None:
    """The diagram; `None` if `path` is not a system file."""
    system = analysis.system(path)
    if system is None:
        return None
    nodes: list[DiagramNode] = []
    edges: list[DiagramEdge] = []
    copies: dict[str, list[SystemAutomaton]] = {}
    for automaton in system.automata:
        if automaton.path:
            copies.setdefault(automaton.path, []).append(automaton)
    for file, automata in copies.items():
        machine, drawn = analysis.machine(file), machine_picture(analysis, file)
        if machine is None or drawn is None:
            continue
        frame = id_in_system(file, "")
        place = Location(file, machine.element.span)
        nodes.append(DiagramNode(frame, DiagramNodeKind.MACHINE, drawn.title, _count(automata), place=place))
        nodes += (
            replace(node, id=id_in_system(file, node.id), parent=id_in_system(file, node.parent))
            for node in drawn.nodes
        )
        edges += (
            replace(edge, source=id_in_system(file, edge.source), target=id_in_system(file, edge.target))
            for edge in drawn.edges
        )
    return Picture(path.replace("\\", "/").rpartition("/")[2], tuple(nodes), tuple(edges))


def _count(automata: Sequence[SystemAutomaton]) -> tuple[Detail, ...]:
    """How many copies of a machine the system has, with the names of ROS nodes; empty for a single one."""
    count = len(automata)
    if count == 1:
        return ()
    names = [automaton.outline.name for automaton in automata if automaton.instance is None]
    if len(names) < count:
        return (Detail(DetailKind.COUNT, f"{count} nodes of trees"),)
    more = f", and {count - MAX_NAMES} more" if count > MAX_NAMES else ""
    return (Detail(DetailKind.COUNT, f"{count} nodes: {', '.join(names[:MAX_NAMES])}{more}"),)


def id_in_system(path: str, node: str) -> str:
    """The id that the node `node` of a machine has in the diagram of the system; the id of the frame of the machine if
    `node` is ""."""
    return f"{path}#{node}"
