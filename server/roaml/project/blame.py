# SPDX-License-Identifier: Apache-2.0
"""Findings at the place that is to blame for what never happens in an explored system."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from roaml.diagnostics import Finding, Related
from roaml.jani.expressions import Integer, Name, walk
from roaml.libraries.programs.statuses import RUNNING
from roaml.model.expand import Instance, node_at
from roaml.model.node_effects import statuses
from roaml.model.system import System
from roaml.project.analysis import Analysis
from roaml.project.exploration import Reached
from roaml.project.explored_steps import ClientRequests, ExploredStep, ExploredSteps, requests_of
from roaml.project.obstacles import Obstacle, is_contradictory, obstacles
from roaml.rules.states import never_taken
from roaml.rules.support.next_child import SUCCEEDS
from roaml.scxml.names import (
    NODE_AUTOMATON,
    SERVICE_HANDLER_PREFIX,
    STATUSES,
    InterfaceEventKind,
    TreeEventKind,
    handling,
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
        reached: what the steps of the system are known from.

    Attributes:
        has_unexplained: whether something never happens for which there is no finding.
        is_tree_at_fault: whether a node is never ticked because the one before it never fails.
    """

    def __init__(self, analysis: Analysis, system: System, reached: Reached) -> None:
        self._analysis = analysis
        self._machines = analysis.machines_in(system)
        self._handled: dict[ClientRequests, ExploredSteps | None] = {}
        self._system = system
        self._instances = {instance.number: instance for instance in system.instances}
        self._steps = reached.steps()
        self._reached = reached
        self.has_unexplained = self.is_tree_at_fault = False

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
        finding = self._explained(self._obstacles(self._steps, wanted), tuple(effects))
        self.has_unexplained |= finding is None
        return finding

    def _explained(self, found: Sequence[Obstacle] | None, effects: tuple[Related, ...]) -> tuple[str, Finding] | None:
        if found is None:
            return None
        if len(found) == 1 and found[0].step.automaton.startswith(SERVICE_HANDLER_PREFIX):
            return self._without_response(found[0], effects)
        finding = self._finding(self._steps, found, effects)
        return self._in_server(found[0], effects) if finding is None and len(found) == 1 else finding

    def _without_response(self, obstacle: Obstacle, effects: Iterable[Related]) -> tuple[str, Finding] | None:
        """The finding about a server that never responds to a client, although it responds to others."""
        response, location = obstacle.step.receives, obstacle.step.edge.source
        servers = {sender.automaton for sender in self._steps.sending(response)}
        client = next((name for name in self._steps.automata if handling(name) == location), None)
        steps = None
        if client is not None and len(servers) == 1:
            steps = self._while_handled(ClientRequests(obstacle.step.automaton, location, servers.pop()))
        wanted = () if steps is None else steps.sending(response)
        if steps is None or client is None or any(step.is_taken for step in wanted):
            return None
        return self._in_context(steps, wanted, client, obstacle.way, effects)

    def _while_handled(self, requests: ClientRequests) -> ExploredSteps | None:
        if requests not in self._handled:
            self._handled[requests] = self._reached.while_handled(requests)
        return self._handled[requests]

    def _in_server(self, obstacle: Obstacle, effects: Iterable[Related]) -> tuple[str, Finding] | None:
        """The finding about a server that never sends a client the response that the condition of the client needs,
        although it sends the response to others."""
        client = obstacle.step.automaton
        requests = list(requests_of(self._steps, client))
        steps = self._while_handled(requests[0]) if len(requests) == 1 else None
        if steps is None:
            return None
        step = next(s for s in steps.leaving(client, obstacle.step.edge.source) if s.edge is obstacle.step.edge)
        return self._in_context(steps, [step], client, obstacle.way[:-1], effects)

    def _in_context(
        self,
        steps: ExploredSteps,
        wanted: Iterable[ExploredStep],
        client: str,
        way: tuple[ExploredStep, ...],
        effects: Iterable[Related],
    ) -> tuple[str, Finding] | None:
        """The finding about a condition of a server that never holds while a request of a client is handled.

        Args:
            way: the steps that lead to those that are wanted.
        """
        found = self._obstacles(steps, wanted)
        if found is None or not all(other.step.is_contextual for other in found):
            return None
        where = f"while the server handles a request of `{_name(client)}`"
        longer = [Obstacle(other.step, (*way, *other.way)) for other in found]
        return self._finding(steps, longer, effects, where)

    def _finding(
        self, steps: ExploredSteps, found: Sequence[Obstacle], effects: Iterable[Related], where: str = ""
    ) -> tuple[str, Finding] | None:
        """The finding about conditions if all of them are at the same place; otherwise `None`.

        Args:
            where: to what the steps are restricted, as an adverbial phrase.
        """
        places = self._places(steps, found)
        if len(places) > 1:
            found = self._decisive(steps, found)
            places = self._places(steps, found)
        [(place, obstacle), *more] = places.items() or ((None, None),)
        if more or place is None or obstacle is None or not all(self._is_at_fault(other.step) for other in found):
            return None
        if any(other.is_taken for other in steps.of_other_instances(obstacle.step)):
            where = f"in the node `{_name(obstacle.step.automaton)}`"
        others = [
            Related(other, "holds at all other times")
            for other in dict.fromkeys(self._conditions(steps, obstacle.step))
            if other != place
        ]
        finding = never_taken.finding(
            place.span,
            holds=self._condition(steps, obstacle.step) is None,
            related=(*others, *self._way(obstacle), *effects),
            no_run=self._reached.no_run,
            is_instant=self._reached.is_instant,
            where=where,
            values="" if where else self._values(obstacle.step),
        )
        return place.path, finding

    def _values(self, step: ExploredStep) -> str:
        """The values that the condition of a step reads, as a clause; "" if there are none."""
        from roaml.project.simulation import seen_values  # noqa: PLC0415 - few systems have findings

        names = {part.identifier for part in walk(step.guard) if isinstance(part, Name)} if step.guard else set()
        return seen_values(self._reached.model, step.automaton, step.edge.source, names) if names else ""

    def _places(self, steps: ExploredSteps, found: Iterable[Obstacle]) -> dict[Location | None, Obstacle]:
        return {self._place(steps, obstacle.step): obstacle for obstacle in found}

    def _decisive(self, steps: ExploredSteps, found: Sequence[Obstacle]) -> list[Obstacle]:
        """The conditions, of those of one machine, in the states to which it always comes back. If one of them always
        holds, only this one counts: the others are never needed because of it."""
        if len({obstacle.step.automaton for obstacle in found}) > 1:
            return []
        last = [o for o in found if steps.is_last(o.step.automaton, o.step.edge.source)]
        return [o for o in last if self._condition(steps, o.step) is None] or last

    def _obstacles(self, steps: ExploredSteps, wanted: Iterable[ExploredStep]) -> tuple[Obstacle, ...] | None:
        return obstacles(steps, wanted, are_long=self._reached.simulated > 0)

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
        conditions = self._conditions(steps, step)
        return None if not conditions else conditions[-1]

    def _conditions(self, steps: ExploredSteps, step: ExploredStep) -> list[Location]:
        """The places of the condition that never holds, or of those before it, one of which always holds. The last one
        is to blame: where `a < b` and `a > b` would leave `a == b`, that is the one which includes equality."""
        own = self._condition(steps, step)
        before = [other for other in steps.beside(step) if other.order < step.order and other.is_taken]
        conditions = [own] if own is not None else [self._condition(steps, other) for other in before]
        path = None if step.edge.origin is None else step.edge.origin.path
        known = sorted((c for c in conditions if c is not None), key=lambda c: "<=" in c.value or ">=" in c.value)
        return [Location(path, condition.value_span) for condition in known if path is not None]

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
