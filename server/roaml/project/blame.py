# SPDX-License-Identifier: Apache-2.0
"""Findings at the place that is to blame for what never happens in an explored system."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

from roaml.diagnostics import Finding, Related
from roaml.jani.expressions import Integer
from roaml.libraries.programs.statuses import RUNNING
from roaml.model.expand import Instance, node_at
from roaml.model.node_effects import statuses
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.project.explored_steps import ClientRequests, ExploredStep, ExploredSteps, requests_of
from roaml.project.obstacles import Obstacle, is_contradictory, obstacles
from roaml.rules.states import never_taken
from roaml.rules.trees.never_ticked import SUCCEEDS
from roaml.scxml.names import (
    NODE_AUTOMATON,
    STATUSES,
    InterfaceEventKind,
    TreeEventKind,
    read_interface_event,
    read_tree_event,
)
from roaml.text import Location
from roaml.xml_syntax import Attribute, Element

_ANSWERS = (InterfaceEventKind.RESPONSE, InterfaceEventKind.GOAL_ANSWER, InterfaceEventKind.RESULT)
"""The kinds of events that answer a request or a goal."""


class Blame:
    """What is to blame in one explored system.

    Args:
        is_instant: whether the steps are only known if all machines react at once.
        steps_while_handled: the steps of the system while a request is handled; `None` if they are not known.
    """

    def __init__(
        self,
        analysis: Analysis,
        system: System,
        steps: ExploredSteps,
        *,
        is_instant: bool,
        steps_while_handled: Callable[[ClientRequests], ExploredSteps | None],
    ) -> None:
        self._steps_while_handled = steps_while_handled
        self._analysis = analysis
        self._machines = analysis.machines_in(system)
        self._handled: dict[str, ExploredSteps | None] = {}
        self._system = system
        self._instances = {instance.number: instance for instance in system.instances}
        self._steps = steps
        self._is_instant = is_instant

    def for_status(self, node: Instance, status: str, effects: Iterable[Related]) -> tuple[str, Finding] | None:
        """The path of a file, and the finding at the only condition in it because of which a node never returns a
        status; `None` if there are several causes, or others.

        Args:
            effects: the places that have no effect because of this.
        """
        wanted = () if self._is_inverted(node) or status != SUCCEEDS else self._returns(node, status)
        return self._for_steps(wanted, effects) if wanted else None

    def for_leaves(self, ticked: Collection[int]) -> Iterator[tuple[str, Finding]]:
        """Findings about the leaves of the tree that are ticked and never succeed.

        Args:
            ticked: the numbers of the nodes that are ticked.
        """
        for node in self._system.instances:
            file = None if node.children else self._analysis.tree(node.source.path)
            written = None if file is None else node_at(file, node.source)
            if written is not None and node.number in ticked:
                place = Location(node.source.path, written.element.name_span)
                found = self.for_status(node, SUCCEEDS, [Related(place, f"never returns {SUCCEEDS}")])
                if found is not None:
                    yield found

    def for_clients(self) -> Iterator[tuple[str, Finding]]:
        """Findings about states in which a machine waits for an answer and which no run leaves although one enters
        them."""
        for automaton, location in self._steps.waiting():
            exits = [step for step in self._steps.leaving(automaton, location) if self._steps.leaves(step)]
            awaited = [step for step in exits if self._is_answer(step.receives)]
            is_stuck = self._steps.is_entered(automaton, location) and not any(step.is_taken for step in exits)
            found = self._for_steps(awaited, ()) if awaited and is_stuck else None
            if found is not None:
                yield found

    def _is_answer(self, event: str) -> bool:
        interface = read_interface_event(event, self._steps.automata)
        return interface is not None and interface.kind in _ANSWERS

    def _for_steps(self, wanted: Iterable[ExploredStep], effects: Iterable[Related]) -> tuple[str, Finding] | None:
        found = obstacles(self._steps, wanted)
        if found is None:
            return None
        effects = tuple(effects)
        finding = self._finding(self._steps, found, effects)
        return self._in_server(found[0], effects) if finding is None and len(found) == 1 else finding

    def _in_server(self, obstacle: Obstacle, effects: Iterable[Related]) -> tuple[str, Finding] | None:
        """The finding about a server that never sends a client the response that the condition of the client needs,
        although it sends the response to others."""
        client = obstacle.step.automaton
        if client not in self._handled:
            requests = list(requests_of(self._steps, client))
            self._handled[client] = self._steps_while_handled(requests[0]) if len(requests) == 1 else None
        steps = self._handled[client]
        if steps is None:
            return None
        step = next(s for s in steps.leaving(client, obstacle.step.edge.source) if s.edge is obstacle.step.edge)
        found = obstacles(steps, [step])
        if found is None or not all(other.step.is_contextual for other in found):
            return None
        where = f"while the server handles a request of `{_name(client)}`"
        longer = [Obstacle(other.step, (*obstacle.way, *other.way[1:])) for other in found]
        return self._finding(steps, longer, effects, where)

    def _finding(
        self, steps: ExploredSteps, found: Sequence[Obstacle], effects: Iterable[Related], where: str = ""
    ) -> tuple[str, Finding] | None:
        """The finding about conditions if all of them are at the same place; otherwise `None`.

        Args:
            where: to what the steps are restricted, as an adverbial phrase.
        """
        places = {self._place(steps, obstacle.step): obstacle for obstacle in found}
        [(place, obstacle), *more] = places.items()
        if more or place is None or not all(self._is_at_fault(other.step) for other in found):
            return None
        if any(other.is_taken for other in steps.of_other_instances(obstacle.step)):
            where = f"in the node `{_name(obstacle.step.automaton)}`"
        finding = never_taken.finding(
            place.span,
            holds=self._condition(steps, obstacle.step) is None,
            related=(*self._way(obstacle), *effects),
            is_instant=self._is_instant,
            where=where,
        )
        return place.path, finding

    def _returns(self, node: Instance, status: str) -> list[ExploredStep]:
        """The steps with which a node returns a status; none if that is not known."""
        found = []
        for event in self._steps.events_sent():
            tree = read_tree_event(event)
            if tree is None or tree.number != node.number or tree.kind is not TreeEventKind.RESPONSE:
                continue
            for step in self._steps.sending(event):
                values = [a.value for a in step.destination.assignments if a.variable == f"{event}__status"]
                if not all(isinstance(value, Integer) for value in values):
                    return []
                if Integer(STATUSES[status]) in values:
                    found.append(step)
        return [] if any(step.is_taken for step in found) else found

    def _is_inverted(self, node: Instance) -> bool:
        """Whether an inverter in the tree may be the cause."""
        return node.plugin == "Inverter" or any(self._is_inverted(self._instances[child]) for child in node.children)

    def _is_at_fault(self, step: ExploredStep) -> bool:
        """Whether a step belongs to a machine, and no other instance of the machine takes it, or the condition of this
        one cannot hold. The machine of a condition is not blamed, because an inverter may be missing instead."""
        others = self._steps.of_other_instances(step)
        match = NODE_AUTOMATON.fullmatch(step.automaton)
        is_condition = match is not None and RUNNING not in statuses(self._system, self._instances[int(match[1])])
        if self._element(step) is None or is_condition:
            return False
        return not any(other.is_taken for other in others) or is_contradictory(self._steps, step)

    def _place(self, steps: ExploredSteps, step: ExploredStep) -> Location | None:
        """The place of the condition that never holds, or of the one before it that always holds."""
        own = self._condition(steps, step)
        if own is None:
            before = [other for other in steps.beside(step) if other.order < step.order and other.is_taken]
            own = self._condition(steps, before[-1]) if before else None
        return None if own is None or step.edge.origin is None else Location(step.edge.origin.path, own.value_span)

    def _condition(self, steps: ExploredSteps, step: ExploredStep) -> Attribute | None:
        """The condition of a transition or branch; `None` if it has none."""
        element = self._element(step)
        first = steps.beside(step)[0]
        is_else = step.order > 0 and first.edge.origin == step.edge.origin
        return None if element is None or is_else else element.get("cond")

    def _element(self, step: ExploredStep) -> Element | None:
        """The element of a machine from which a step comes; `None` if it belongs to no machine."""
        origin = step.edge.origin
        document = None if origin is None or origin.path not in self._machines else self._analysis.document(origin.path)
        if origin is None or document is None:
            return None
        around = document.path_at(origin.span.start + 1)
        return next((element for element in around if element.span == origin.span), None)

    def _way(self, obstacle: Obstacle) -> Iterator[Related]:
        """The elements of machines that have no effect because of an obstacle, the nearest first."""
        shown: dict[Location, str] = {}
        for step in reversed(obstacle.way):
            element = self._element(step)
            if element is not None and step.edge.origin is not None:
                place = Location(step.edge.origin.path, element.name_span)
                when = "not" if step.is_ever_taken else "never"
                shown.setdefault(place, f"{when} executed" if step.sends else f"{when} taken")
        return (Related(place, message) for place, message in shown.items())


def _name(automaton: str) -> str:
    """The name of the node of the tree, or of the machine, that an automaton executes."""
    match = NODE_AUTOMATON.fullmatch(automaton)
    return match[2] if match is not None else automaton
