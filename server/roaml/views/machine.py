# SPDX-License-Identifier: Apache-2.0
"""Diagrams of the states and transitions of a state machine in HL-SCXML."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.machine import Chart, Handler, Machine, Target
from roaml.roles import ProtocolPart
from roaml.views.graph import Graph, GraphLink, GraphNode, Kind


def machine_graph(machine: Machine) -> tuple[Graph, ...]:
    """A diagram of the machine itself, then one for each of its action threads."""
    name = machine.name.value if machine.name else "machine"
    return tuple(_chart(chart, f"{name} {chart.scope}".strip()) for chart in machine.charts)


def _chart(chart: Chart, title: str) -> Graph:
    nodes = tuple(GraphNode(state.id.value, (state.id.value,)) for state in chart.states if state.id)
    links = tuple(
        link
        for state in chart.states
        if state.id
        for handler in state.handlers
        if handler.effective
        for link in _links(state.id.value, handler)
    )
    return Graph(Kind.STATES, title, nodes, links, chart.initial.value if chart.initial else "")


def _links(source: str, handler: Handler) -> Iterator[GraphLink]:
    label = trigger_label(handler)
    for target in handler.targets:
        if target.state is not None:
            yield GraphLink(source, target.state.value, (*label, *chance_label(handler, target)))


def trigger_label(handler: Handler) -> tuple[str, ...]:
    """The trigger of a transition, and its condition, one line each."""
    words = (
        [handler.element.name.removeprefix("ros_").removeprefix("bt_")]
        if handler.trigger is not ProtocolPart.EVENT
        else []
    )
    words += [name.value for name in (handler.event, handler.handle, handler.child) if name]
    lines = [" ".join(words)] if handler.trigger else []
    return (*lines, *([f"[{' '.join(handler.cond.text.split())}]"] if handler.cond else []))


def chance_label(handler: Handler, target: Target) -> tuple[str, ...]:
    """The probability of one of several targets, as a line; empty if there is only one target."""
    if target.probability:
        return (f"p = {target.probability.value}",)
    return ("otherwise",) if handler.is_probabilistic else ()
