# SPDX-License-Identifier: Apache-2.0
"""The nodes to highlight in diagrams after a step of an automaton of the translation."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.diagrams.machine import state_id
from roaml.project.analysis import Analysis
from roaml.record import Record
from roaml.text import Location


class DiagramHighlight(Record, frozen=True):
    """A node to highlight. `picture` is the kind of diagram, "machine" or "tree"; `path` is the file whose diagram this
    is: a machine, or the system of a tree; `node` is the id of the node in the diagram."""

    picture: str
    path: str
    node: str


def highlights(
    analysis: Analysis, system: str, automaton: str, origin: Location, location: str
) -> tuple[DiagramHighlight, ...]:
    """The nodes to highlight after a step of an automaton.

    Args:
        system: the path of the system file.
        automaton: the name of the automaton in the translation.
        origin: the place in the models to which the step belongs.
        location: the location of the automaton after the step: a state, or a location between two states.
    """
    return (*_state(analysis, origin, location), *_tree_node(analysis, system, automaton))


def _state(analysis: Analysis, origin: Location, location: str) -> Iterator[DiagramHighlight]:
    """The state of the machine. In a location between two states, this is the state that the machine leaves."""
    machine = analysis.machine(origin.path)
    for chart in machine.charts if machine else ():
        named = [state for state in chart.states if state.id]
        around = [
            s for s in named if s.element.span.start <= origin.span.start and origin.span.end <= s.element.span.end
        ]
        if not around:
            continue
        innermost = min(around, key=lambda state: state.element.span.end - state.element.span.start)
        reached = next((state for state in named if state.id and state.id.value == location), innermost)
        if reached.id is not None:
            yield DiagramHighlight("machine", origin.path, state_id(chart, reached.id.value))
            return


def _tree_node(analysis: Analysis, system: str, automaton: str) -> Iterator[DiagramHighlight]:
    linked = analysis.system(system)
    for instance in linked.instances if linked else ():
        if instance.automaton == automaton:
            yield DiagramHighlight("tree", system, str(instance.number))
