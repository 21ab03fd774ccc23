# SPDX-License-Identifier: Apache-2.0
"""The parts of pictures that traces have executed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from roaml.ide.diagrams import DiagramEdge, DiagramKind, DiagramNode, DiagramNodeKind, EdgeKind, Picture
from roaml.ide.diagrams.machine import state_id
from roaml.ide.diagrams.system import id_in_system
from roaml.jani.model import Automaton
from roaml.model.machine import Chart, Machine
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.verification.coverage import Coverage, Entered, Taken, Ticked


class CoveredNode(Record, frozen=True):
    """A node of a picture.

    Attributes:
        traces: the number of traces that have entered the state or ticked the node.
        statuses: the statuses that a node of the tree has returned -> the number of traces in which it did.
    """

    traces: int
    statuses: Mapping[str, int] = {}


class CoveredPicture(Record, frozen=True):
    """For each node and each edge of a picture, in their order, what traces have executed of it; `None` if it is not a
    part that is executed."""

    nodes: Sequence[CoveredNode | None]
    edges: Sequence[int | None]


def covered_picture(
    kind: DiagramKind, picture: Picture, coverage: Coverage, analysis: Analysis, automata: Sequence[Automaton]
) -> CoveredPicture:
    """What traces have executed of the picture of a machine, of all machines, or of a tree.

    Args:
        automata: those of the translation.
    """
    if kind is DiagramKind.TREE:
        return _of_tree(picture, coverage)
    entered = _entered_states(coverage, analysis, automata, with_path=kind is DiagramKind.SYSTEM)
    taken = {node.id: coverage.counts.get(Taken(node.place), 0) for node in picture.nodes if node.place is not None}

    def of_node(node: DiagramNode) -> CoveredNode | None:
        match node.kind:
            case DiagramNodeKind.STATE:
                return CoveredNode(entered.get(node.id, 0))
            case DiagramNodeKind.CHOICE:
                return CoveredNode(taken.get(node.id, 0))
            case _:
                return None

    edges = [None if edge.place is None else coverage.counts.get(Taken(edge.place), 0) for edge in picture.edges]
    return CoveredPicture([of_node(node) for node in picture.nodes], edges)


def _entered_states(
    coverage: Coverage, analysis: Analysis, automata: Sequence[Automaton], *, with_path: bool
) -> Mapping[str, int]:
    """The id of a state in the picture -> the number of traces that have entered it; for a file that several automata
    execute, the number for the automaton that most have."""
    entered: Counter[str] = Counter()
    for automaton in automata:
        machine = None if automaton.origin is None else analysis.machine(automaton.origin.path)
        if machine is None or automaton.origin is None:
            continue
        for location in automaton.locations:
            count = coverage.counts.get(Entered(automaton.name, location.name), 0)
            chart = _chart(machine, automaton, location.name)
            if count and chart is not None:
                state = state_id(chart, location.name)
                node = id_in_system(automaton.origin.path, state) if with_path else state
                entered[node] = max(entered[node], count)
    return entered


def _chart(machine: Machine, automaton: Automaton, state: str) -> Chart | None:
    """The chart of a state of an automaton: of several with a state of this name, the one that contains the transitions
    of the automaton."""
    charts = [c for c in machine.charts if any(s.id is not None and s.id.value == state for s in c.states)]
    if len(charts) < 2:
        return next(iter(charts), None)
    places = [edge.origin.span for edge in automaton.edges if edge.source == state and edge.origin is not None]
    return next((c for c in charts if any(_contains(c, span.start) for span in places)), charts[0])


def _contains(chart: Chart, offset: int) -> bool:
    return any(state.element.span.start <= offset < state.element.span.end for state in chart.states)


def _of_tree(picture: Picture, coverage: Coverage) -> CoveredPicture:
    children: dict[str, str] = {}
    for edge in picture.edges:
        if edge.kind is EdgeKind.CHILD:
            children.setdefault(edge.source, edge.target)
    numbers = {node.id: node.title.number for node in picture.nodes if node.title is not None}

    def executed(node: str) -> CoveredNode | None:
        """A subtree does what its only child does."""
        while node in numbers and numbers[node] is None:
            node = children.get(node, "")
        number = numbers.get(node)
        return None if number is None else CoveredNode(coverage.counts[Ticked(number)], coverage.statuses(number))

    def ticks(edges: Sequence[DiagramEdge]) -> Iterator[int | None]:
        for edge in edges:
            child = executed(edge.target) if edge.kind is EdgeKind.CHILD else None
            yield None if child is None else child.traces

    return CoveredPicture([executed(node.id) for node in picture.nodes], list(ticks(picture.edges)))
