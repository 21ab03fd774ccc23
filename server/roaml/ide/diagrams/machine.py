# SPDX-License-Identifier: Apache-2.0
"""The diagram of a state machine: its states and transitions; each action thread in a separate frame."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.ide.diagrams.diagram import DiagramEdge, DiagramNode, DiagramNodeKind, EdgeKind, Picture
from roaml.model.machine import Chart, Handler, State, Thread
from roaml.project.analysis import Analysis
from roaml.roles import ProtocolPart
from roaml.text import Location
from roaml.views.machine import chance_label, trigger_label

_BT = ("bt-", "child-")


def machine_picture(analysis: Analysis, path: str) -> Picture | None:
    """The diagram; `None` if the file is not a machine."""
    machine = analysis.machine(path)
    if machine is None:
        return None
    nodes: list[DiagramNode] = []
    edges: list[DiagramEdge] = []
    frames = {thread.chart: _frame(thread, path) for thread in machine.threads}
    for chart in machine.charts:
        frame = frames[chart].id if chart in frames else ""
        if frame:
            nodes.append(frames[chart])
        # If states have the same name, transitions lead to the first.
        states = {state.id.value: state for state in reversed(chart.states) if state.id}
        shown = [state for state in chart.states if state.id and states[state.id.value] is state]
        nodes += [_node(chart, state, frame, path) for state in shown]
        edges += [edge for state in shown for edge in _edges(chart, state, states, path)]
    return Picture(machine.name.value if machine.name else "", tuple(nodes), tuple(edges))


def _frame(thread: Thread, path: str) -> DiagramNode:
    server = thread.server.value if thread.server else ""
    count = (f"{thread.count} threads",) if thread.count and thread.count > 1 else ()
    return DiagramNode(
        f"thread {thread.chart.scope}", DiagramNodeKind.THREAD, server, count, place=Location(path, thread.element.span)
    )


def state_id(chart: Chart, name: str) -> str:
    """The id of a state in the diagram."""
    return f"{chart.scope}/{name}"


def _node(chart: Chart, state: State, frame: str, path: str) -> DiagramNode:
    assert state.id is not None
    staying = [
        " ".join(trigger_label(handler))
        for handler in state.handlers
        if handler.effective and all(target.state is None for target in handler.targets)
    ]
    initial = chart.initial is not None and chart.initial.value == state.id.value
    place = Location(path, state.element.span)
    return DiagramNode(
        state_id(chart, state.id.value), DiagramNodeKind.STATE, state.id.value, tuple(staying), frame, initial, place
    )


def _edges(chart: Chart, state: State, states: dict[str, State], path: str) -> Iterator[DiagramEdge]:
    assert state.id is not None
    for handler in state.handlers:
        if not handler.effective:
            continue
        for target in handler.targets:
            if target.state is None or target.state.value not in states:
                continue
            labels = (*trigger_label(handler), *chance_label(handler, target))
            element = target.element or handler.element
            yield DiagramEdge(
                state_id(chart, state.id.value),
                state_id(chart, target.state.value),
                _kind(handler),
                labels,
                handler.is_probabilistic,
                Location(path, element.span),
            )


def _kind(handler: Handler) -> EdgeKind:
    match handler.trigger:
        case None:
            return EdgeKind.EVENTLESS
        case ProtocolPart.EVENT:
            return EdgeKind.EVENT
        case trigger:
            return EdgeKind.BT if trigger.value.startswith(_BT) else EdgeKind.ROS
