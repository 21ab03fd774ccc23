# SPDX-License-Identifier: Apache-2.0
"""A state machine as it is written: its states and what leads from one to another."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.model.machine import Chart, Handler, Machine
from roaml.views.graph import Graph, Kind, Link, Node


def machine_graph(machine: Machine) -> tuple[Graph, ...]:
    """The machine's own chart, then those of its action threads."""
    name = machine.name.value if machine.name else "machine"
    return tuple(_chart(chart, f"{name} {chart.scope}".strip()) for chart in machine.charts)


def _chart(chart: Chart, title: str) -> Graph:
    nodes = tuple(Node(state.id.value, (state.id.value,)) for state in chart.states if state.id)
    links = tuple(
        link
        for state in chart.states
        if state.id
        for handler in state.handlers
        if handler.effective
        for link in _links(state.id.value, handler)
    )
    return Graph(Kind.STATES, title, nodes, links, chart.initial.value if chart.initial else "")


def _links(source: str, handler: Handler) -> Iterator[Link]:
    label = _trigger(handler)
    for target in handler.targets:
        if target.state is None:
            continue
        chance = [f"p = {target.probability.value}"] if target.probability else []
        if handler.is_probabilistic and not chance:
            chance = ["otherwise"]
        yield Link(source, target.state.value, (*label, *chance))


def _trigger(handler: Handler) -> list[str]:
    words = [handler.element.name.removeprefix("ros_").removeprefix("bt_")] if handler.trigger != "event" else []
    words += [name.value for name in (handler.event, handler.handle, handler.child) if name]
    lines = [" ".join(words)] if handler.trigger else []
    return [*lines, *([f"[{' '.join(handler.cond.text.split())}]"] if handler.cond else [])]
