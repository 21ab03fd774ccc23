# SPDX-License-Identifier: Apache-2.0
"""The diagram of a state machine: its states and transitions, with a separate frame for each action thread, and groups
of states: those between the comments `<!-- #region NAME -->` and `<!-- #endregion -->`.

A probabilistic transition leads to a choice, from which an edge leads to each target.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping

from roaml.ide.diagrams.actions import Wording, guard, outcome
from roaml.ide.diagrams.diagram import Detail, DetailKind, DiagramEdge, DiagramNode, DiagramNodeKind, EdgeKind, Picture
from roaml.ide.diagrams.precedence import precedence
from roaml.model.machine import Body, Chart, Handler, Machine, State, Target, Thread
from roaml.project.analysis import Analysis
from roaml.roles import ProtocolPart
from roaml.text import Location
from roaml.xml_syntax.regions import CommentRegion, regions

_BT = ("bt-", "child-")


def machine_picture(analysis: Analysis, path: str) -> Picture | None:
    """The diagram of a state machine; `None` if the file is not a state machine."""
    machine = analysis.machine(path)
    if machine is None:
        return None
    nodes: list[DiagramNode] = []
    edges: list[DiagramEdge] = []
    frames = {thread.chart: _frame(thread, path) for thread in machine.threads}
    for chart in machine.charts:
        frame = frames.get(chart)
        if frame:
            nodes.append(frame)
        drawn = _Chart(machine, chart, frame.id if frame else "", path)
        nodes += drawn.nodes()
        edges += drawn.edges()
    return Picture(machine.name.value if machine.name else "", tuple(nodes), tuple(edges))


def state_id(chart: Chart, name: str) -> str:
    """The id of a state in the diagram."""
    return f"{chart.scope}/{name}"


def _frame(thread: Thread, path: str) -> DiagramNode:
    server = thread.server.value if thread.server else ""
    count = (Detail(DetailKind.COUNT, f"{thread.count} threads"),) if thread.count and thread.count > 1 else ()
    return DiagramNode(
        f"thread {thread.chart.scope}", DiagramNodeKind.THREAD, server, count, place=Location(path, thread.element.span)
    )


class _Chart:
    """Collects the nodes and edges of a chart. If several states have the same name, only the first is drawn, and all
    transitions to this name lead to it."""

    def __init__(self, machine: Machine, chart: Chart, frame: str, path: str) -> None:
        self._wording = Wording(machine)
        self._chart = chart
        self._frame = frame
        self._path = path
        self._states: Mapping[str, State] = {s.id.value: s for s in reversed(chart.states) if s.id}
        self._shown = [s for s in chart.states if s.id and self._states[s.id.value] is s]
        self._groups = self._named_groups()

    def _named_groups(self) -> list[tuple[str, CommentRegion]]:
        """The regions that contain states, and their ids in the diagram. If several have the same name and are in the
        same regions, all but the first have a number, too."""
        counts: dict[tuple[str, ...], int] = {}
        found: list[tuple[str, CommentRegion]] = []
        for region in regions(self._chart.element.nodes):
            if not any(_is_in(state, region) for state in self._shown):
                continue
            number = counts[region.path] = counts.get(region.path, 0) + 1
            name = "/".join(region.path) if number == 1 else f"{'/'.join(region.path)} {number}"
            found.append((f"group {self._chart.scope}/{name}", region))
        return found

    def _parent(self, inner: State | CommentRegion) -> str:
        """The id of the innermost group around a state or group, or of the frame."""
        around = (name for name, region in reversed(self._groups) if region is not inner and _is_in(inner, region))
        return next(around, self._frame)

    def _group(self, name: str, region: CommentRegion) -> DiagramNode:
        place = Location(self._path, region.start)
        return DiagramNode(name, DiagramNodeKind.GROUP, region.name, (), self._parent(region), place=place)

    def nodes(self) -> Iterator[DiagramNode]:
        """The nodes in the order of the text, so that each group is before its states."""
        groups = deque(self._groups)
        for state in self._shown:
            assert state.id is not None
            while groups and groups[0][1].start < state.element.span:
                yield self._group(*groups.popleft())
            name = state.id.value
            initial = self._chart.initial is not None and self._chart.initial.value == name
            place = Location(self._path, state.element.span)
            details = tuple(Detail(DetailKind.ACTIONS, text) for text in self._bodies(state))
            parent = self._parent(state)
            yield DiagramNode(self._id(state), DiagramNodeKind.STATE, name, details, parent, initial, place)
            for index, handler in enumerate(state.handlers):
                if handler.effective and handler.is_probabilistic:
                    where = Location(self._path, handler.element.span)
                    choice = self._choice(state, index)
                    yield DiagramNode(choice, DiagramNodeKind.CHOICE, "", (), parent, place=where)

    def edges(self) -> Iterator[DiagramEdge]:
        for state in self._shown:
            orders = precedence(self._wording, state.handlers)
            for index, (handler, order) in enumerate(zip(state.handlers, orders, strict=True)):
                if not handler.effective:
                    continue
                if handler.is_probabilistic:
                    yield from self._by_chance(state, index, handler, order)
                    continue
                labels = tuple(filter(None, (self._wording.trigger(handler), guard(handler))))
                for target in handler.targets:
                    yield from self._edge(state, self._id(state), handler, target, labels, order)

    def _by_chance(self, state: State, index: int, handler: Handler, order: str) -> Iterator[DiagramEdge]:
        choice = self._choice(state, index)
        labels = tuple(filter(None, (self._wording.trigger(handler), guard(handler))))
        place = Location(self._path, handler.element.span)
        yield DiagramEdge(self._id(state), choice, _kind(handler), labels, place=place, order=order)
        for target in handler.targets:
            yield from self._edge(state, choice, handler, target, ())

    def _edge(
        self, state: State, source: str, handler: Handler, target: Target, labels: tuple[str, ...], order: str = ""
    ) -> Iterator[DiagramEdge]:
        if target.state is not None and target.state.value not in self._states:
            return
        reached = self._states[target.state.value] if target.state else state
        result = outcome(handler, target)
        element = target.element or handler.element
        yield DiagramEdge(
            source,
            self._id(reached),
            _kind(handler),
            (*labels, result) if result else labels,
            self._wording.actions(target.body),
            handler.is_probabilistic,
            target.state is None,
            Location(self._path, element.span),
            order=order,
        )

    def _bodies(self, state: State) -> Iterator[str]:
        for word, body in (("entry", state.entry), ("exit", state.exit)):
            yield from self._body(word, body)

    def _body(self, word: str, body: Body | None) -> Iterator[str]:
        actions = self._wording.actions(body.statements) if body else ()
        if actions:
            yield f"{word} / {'; '.join(actions)}"

    def _id(self, state: State) -> str:
        assert state.id is not None
        return state_id(self._chart, state.id.value)

    def _choice(self, state: State, index: int) -> str:
        return f"choice {index} {self._id(state)}"


def _is_in(inner: State | CommentRegion, region: CommentRegion) -> bool:
    span = inner.element.span if isinstance(inner, State) else inner.span
    return region.span.start <= span.start and span.end <= region.span.end


def _kind(handler: Handler) -> EdgeKind:
    match handler.trigger:
        case None:
            return EdgeKind.EVENTLESS
        case ProtocolPart.EVENT:
            return EdgeKind.EVENT
        case trigger:
            return EdgeKind.BT if trigger.value.startswith(_BT) else EdgeKind.ROS
