# SPDX-License-Identifier: Apache-2.0
"""The reaction time of the automata of a model (docs/spec/semantics.md#reaction-time), expressed by guards.

An automaton that must have no possible step when the clock begins one takes part in this step, with self-loops in the
locations in which its guards permit that. So locations and local variables need not be copied to global variables, and
the model has no more states than with a rule for the clock.

Whether a step of several automata is possible does not depend on one of them alone. Automata take part in the step of
the clock already: the buffers of events, which must be empty. Where these leave a step of several automata undecided,
there is a copy of the clock's step for each combination of what some of them (*pivots*) can do.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

from roaml.durations import ReactionTime
from roaml.jani.expressions import Binary, Boolean, Conditional, Expression, Integer, Name, Unary
from roaml.jani.model import (
    PREFIX,
    VARIABLES,
    Action,
    Assignment,
    Automaton,
    Clause,
    Clock,
    Destination,
    Edge,
    Model,
    Sync,
    Variable,
)
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.types import BasicType, BoundedType
from roaml.record import Record, replace

ON_SEND, ON_RECEIVE = "_on_send", "_on_receive"
"""The ends of the names of actions that send and receive events (docs/spec/jani.md#names)."""
MAX_COMBINATIONS = 1024
"""The maximum number of copies of a step of the clock."""

Part: TypeAlias = tuple[int, str]
"""An element that takes part in a step, and its action. The action of an edge without action is its number."""


class ReactionError(ValueError):
    """The reaction time of a model cannot be changed. The message is for users."""


def reacting(model: Model, time: ReactionTime) -> Model:
    """A model with a reaction time. A model without a clock is returned unchanged.

    Raises:
        ReactionError: the model assumes another reaction time already.
    """
    metadata = model.metadata
    if metadata is None or metadata.clock is None or metadata.reaction_time == time:
        return model
    if not metadata.reaction_time.is_any:
        raise ReactionError(
            f"the model assumes the reaction time `{metadata.reaction_time.text}`, which cannot be changed to "
            f"`{time.text}`; translate the system again"
        )
    model = replace(model, metadata=replace(metadata, reaction_time=time))
    return replace(model, holds_clock=True) if time.is_instant else _Delays(model, metadata.clock, time).encoded()


def without_hold(model: Model) -> Model:
    """An equal model in which guards hold the clock, as JANI has no other means."""
    if not model.holds_clock or model.metadata is None or model.metadata.clock is None:
        return model
    return _Rest(replace(model, holds_clock=False), model.metadata.clock).encoded()


def owner_of(result: str, elements: Mapping[int, str], clock: str) -> int | None:
    """The element that decides to take a step: the sender, the buffer that delivers, or the only element that takes
    part; `None` if it is a step of the clock.

    Args:
        result: the action of the step.
        elements: the elements that take part, in their order, with the names of their automata.
        clock: the name of the clock.
    """
    if clock in elements.values():
        return None
    event = result.removesuffix(ON_SEND).removesuffix(ON_RECEIVE)
    buffers = [element for element, name in elements.items() if name == event]
    if buffers and result.endswith(ON_RECEIVE):
        return buffers[0]
    return next((element for element in elements if element not in buffers), None)


class _Step(Record, frozen=True):
    """A step of the model: its parts; and the number of its synchronisation, -1 for an edge without action."""

    parts: tuple[Part, ...]
    sync: int


Combination: TypeAlias = Mapping[Part, bool]
"""For each part of a pivot, whether it is ready."""


class _Encoder:
    """Rewrites the steps with which a clock begins."""

    def __init__(self, model: Model, clock: Clock) -> None:
        self.model = model
        names = [element.automaton for element in model.system.elements]
        by_name = {automaton.name: automaton for automaton in model.automata}
        self.elements = [by_name[name] for name in names]
        self.clock = names.index(clock.automaton)
        self.added: dict[str, list[Edge]] = {}
        self.known: dict[tuple[object, ...], str] = {}
        self.ready_in: list[dict[str, dict[str, list[Expression | None]]]] = [_ready(a) for a in self.elements]
        self.locations = [[location.name for location in automaton.locations] for automaton in self.elements]
        self.actions: list[str] = []
        begins = {(self.clock, action) for action in clock.actions}
        syncs = model.system.syncs
        self.starts = [i for i, sync in enumerate(syncs) if not begins.isdisjoint(sync.participants)]
        self.steps = [
            _Step(tuple(s.participants), i) for i, s in enumerate(syncs) if i not in self.starts and s.participants
        ]
        self.steps += [
            _Step(((i, action),), -1) for i, ready in enumerate(self.ready_in) for action in ready if action[:1] == "\n"
        ]
        self.allowed = [set(locations) for locations in self.locations]
        self._restrict(clock)

    def _restrict(self, clock: Clock) -> None:
        """Determine in which locations elements can be when the clock begins a step."""
        syncs = [dict(self.model.system.syncs[start].participants) for start in self.starts]
        for i, ready in enumerate(self.ready_in):
            if self.starts and all(i in parts for parts in syncs):
                self.allowed[i] = {location for parts in syncs for location in ready.get(parts[i], ())}

    def state_of(self, part: Part) -> bool | None:
        """Whether a part is ready whenever the clock begins; `None` if that depends on the state."""
        element, action = part
        ready = self.ready_in[element].get(action, {})
        guards = [ready.get(location) for location in self.allowed[element]]
        if all(guard is not None and None in guard for guard in guards):
            return True
        return None if any(guards) else False

    def undecided(self, step: _Step) -> list[Part] | None:
        """The parts on which it depends whether a step is possible when the clock begins; `None` if it never is."""
        states = [(part, self.state_of(part)) for part in step.parts]
        if any(state is False for _, state in states):
            return None
        return [part for part, state in states if state is None]

    def ready(self, part: Part, location: str) -> Expression | None:
        """Whether a part is ready in a location; `None` if it never is."""
        guards = self.ready_in[part[0]].get(part[1], {}).get(location, ())
        if not guards:
            return None
        return _TRUE if None in guards else _any_of([guard for guard in guards if guard is not None])

    def combinations(self, parts: Iterable[Part]) -> list[dict[Part, bool]]:
        """What pivots can do at the same time, for parts of pivots."""
        results: list[dict[Part, bool]] = [{}]
        for _, group in itertools.groupby(sorted(set(parts)), key=lambda part: part[0]):
            own = list(group)
            values = {
                choice
                for location in self.allowed[own[0][0]]
                for choice in itertools.product(*(_values(self.ready(part, location)) for part in own))
            }
            results = [
                {**result, **dict(zip(own, choice, strict=True))} for result in results for choice in sorted(values)
            ]
            if len(results) > MAX_COMBINATIONS:
                raise ReactionError("the steps of this model depend on too many automata for a reaction time")
        return results

    def within(self, element: int, location: str, combination: Combination) -> Expression | None:
        """The condition under which an element is ready for what a combination states; `None` if it cannot be."""
        conditions: list[Expression] = []
        for part, is_ready in combination.items():
            if part[0] == element:
                ready = self.ready(part, location)
                if (ready is None and is_ready) or (ready == _TRUE and not is_ready):
                    return None
                if ready is not None and ready != _TRUE:
                    conditions.append(ready if is_ready else _not(ready))
        return _all_of(conditions)

    def joined(self, parts: Iterable[tuple[int, str, Sequence[Edge]]], start: int) -> Sync:
        """A copy of a synchronisation in which further elements take part with edges, which are added. Equal
        edges have the same action."""
        sync = self.model.system.syncs[start]
        participants = dict(sync.participants)
        for element, stem, loops in parts:
            before = participants.get(element)
            edges = loops if before is None else self._restricted(element, before, loops)
            participants[element] = self.action(element, stem, edges)
        return replace(sync, participants=tuple(sorted(participants.items())))

    def _restricted(self, element: int, action: str, loops: Sequence[Edge]) -> list[Edge]:
        """The edges of an element for an action, each with the conditions and assignments of loops."""
        return [
            replace(
                edge,
                guard=_clause(_all_of([clause.exp for clause in (edge.guard, loop.guard) if clause is not None])),
                destinations=tuple(
                    replace(d, assignments=(*d.assignments, *_later(loop.destinations[0].assignments, d)))
                    for d in edge.destinations
                ),
            )
            for edge in self.elements[element].edges
            if edge.action == action
            for loop in loops
            if loop.source == edge.source
        ]

    def action(self, element: int, stem: str, edges: Sequence[Edge]) -> str:
        """The action of these edges of an element, which are added under this name if they are new."""
        automaton = self.elements[element].name
        key = (automaton, stem, *((e.source, e.guard, e.destinations) for e in edges))
        if key not in self.known:
            count = sum(known[:2] == (automaton, stem) for known in self.known)
            name = self.known[key] = stem if not count else f"{stem}_{count}"
            self.added.setdefault(automaton, []).extend(replace(edge, action=name) for edge in edges)
            if name not in self.actions:
                self.actions.append(name)
        return self.known[key]

    def model_with(
        self, syncs: Iterable[Sync], edges_of: Mapping[str, Sequence[Edge]], variables: Sequence[Variable] = ()
    ) -> Model:
        """The model with other synchronisations, and other edges of some automata. What is added comes from the place
        of its automaton, and variables from that of the clock."""

        def edges(automaton: Automaton) -> Iterator[Edge]:
            for edge in (*edges_of.get(automaton.name, automaton.edges), *self.added.get(automaton.name, ())):
                yield edge if edge.origin is not None else replace(edge, origin=automaton.origin)

        automata = tuple(replace(automaton, edges=tuple(edges(automaton))) for automaton in self.model.automata)
        origin = self.elements[self.clock].origin
        return replace(
            self.model,
            automata=automata,
            system=replace(self.model.system, syncs=tuple(syncs)),
            variables=(*self.model.variables, *(replace(variable, origin=origin) for variable in variables)),
            actions=(*self.model.actions, *map(Action, self.actions)),
        )


class _Rest(_Encoder):
    """Lets the clock begin only if no other step is possible."""

    def encoded(self) -> Model:
        single: set[Part] = set()
        several: list[list[Part]] = []
        for step in self.steps:
            parts = self.undecided(step)
            if parts is None:
                continue
            if not parts:  # This step is always possible, so time never advances.
                syncs = [sync for i, sync in enumerate(self.model.system.syncs) if i not in self.starts]
                return self.model_with(syncs, {})
            if len(parts) == 1:
                single.add(parts[0])
            else:
                several.append(parts)
        pivots = self._pivots(several)
        copies: dict[int, list[Sync]] = {start: [] for start in self.starts}
        for combination in self.combinations(part for parts in several for part in parts if part[0] in pivots):
            forbidden = self._forbidden(several, pivots, combination)
            if forbidden is None:
                continue
            by_element: dict[int, set[Part]] = {}
            for part in (*single, *forbidden):
                by_element.setdefault(part[0], set()).add(part)
            loops = [
                (element, f"{PREFIX}rests", self._loops(element, by_element.get(element, ()), combination))
                for element in sorted({*by_element, *(part[0] for part in combination)})
            ]
            for start in self.starts:
                copies[start].append(self.joined(loops, start))
        syncs = [copy for i, sync in enumerate(self.model.system.syncs) for copy in copies.get(i, (sync,))]
        return self.model_with(syncs, {})

    @staticmethod
    def _pivots(several: Sequence[Sequence[Part]]) -> set[int]:
        """Elements without which each step depends on one element at most."""
        pivots: set[int] = set()
        while True:
            left = [{part[0] for part in parts} - pivots for parts in several]
            count = Counter(element for elements in left if len(elements) > 1 for element in elements)
            if not count:
                return pivots
            pivots.add(max(sorted(count), key=lambda element: count[element]))

    @staticmethod
    def _forbidden(several: Sequence[Sequence[Part]], pivots: set[int], combination: Combination) -> set[Part] | None:
        """The parts that must not be ready, so that none of the steps is possible; `None` if one is possible."""
        forbidden: set[Part] = set()
        for parts in several:
            if all(combination[part] for part in parts if part[0] in pivots):
                rest = [part for part in parts if part[0] not in pivots]
                if not rest:
                    return None
                forbidden.update(rest)
        return forbidden

    def _loops(self, element: int, forbidden: Iterable[Part], combination: Combination) -> list[Edge]:
        loops = []
        for location in self._places(element):
            guard = self.within(element, location, {**combination, **dict.fromkeys(sorted(forbidden), False)})
            if guard is not None:
                loops.append(_loop(location, guard))
        return loops

    def _places(self, element: int) -> Iterator[str]:
        return (location for location in self.locations[element] if location in self.allowed[element])


class _Delays(_Encoder):
    """Lets the clock begin only if no automaton has waited for its maximum with a possible step.

    The *owner* of a step is the automaton that decides to take it: the sender, the buffer that delivers, or the only
    automaton that takes part. Each owner has a counter. The conditions of the steps that an automaton can take from a
    location are assumed not to become false all together because another automaton writes a variable: in a translated
    system, only local variables decide whether an automaton can take a step, and parts of an `<if>` complement each
    other.
    """

    def __init__(self, model: Model, clock: Clock, time: ReactionTime) -> None:
        super().__init__(model, clock)
        self.most = time.steps(clock.step)
        self.owned: dict[int, list[_Step]] = {}
        for step in self.steps:
            owner = self._owner(step)
            if owner is not None and self.undecided(step) is not None:
                self.owned.setdefault(owner, []).append(step)
        self.mirrored: set[int] = set()

    def _owner(self, step: _Step) -> int | None:
        result = (self.model.system.syncs[step.sync].result or "") if step.sync >= 0 else ""
        elements = {element: self.elements[element].name for element, _ in step.parts}
        return owner_of(result, elements, self.elements[self.clock].name)

    def encoded(self) -> Model:
        pivoted = [
            part
            for owner, steps in self.owned.items()
            for step in steps
            for part in self.undecided(step) or ()
            if part[0] != owner
        ]
        copies: dict[int, list[Sync]] = {start: [] for start in self.starts}
        for combination in self.combinations(pivoted):
            loops = [
                (element, f"{PREFIX}waits", self._loops(element, combination))
                for element in sorted({*self.owned, *(part[0] for part in combination)})
            ]
            for start in self.starts:
                copies[start].append(self.joined(loops, start))
        edges = {self.elements[owner].name: self._resetting(owner) for owner in self.owned}
        syncs: list[Sync] = []
        for i, sync in enumerate(self.model.system.syncs):
            syncs += copies.get(i) or [self._interrupting(i, sync)]
        for element in self.mirrored:
            name = self.elements[element].name
            edges[name] = [self._mirroring(element, edge) for edge in edges.get(name, self.elements[element].edges)]
            self.added[name] = [self._mirroring(element, edge) for edge in self.added.get(name, ())]
        variables = [
            Variable(self._counter(owner), BoundedType(BasicType.INT, Integer(0), Integer(self.most)), Integer(0))
            for owner in sorted(self.owned)
        ]
        for element in sorted(self.mirrored):
            last = Integer(len(self.locations[element]) - 1)
            first = self.locations[element].index(self.elements[element].initial_locations[0])
            variables.append(
                Variable(self._place(element), BoundedType(BasicType.INT, Integer(0), last), Integer(first))
            )
        return self.model_with(syncs, edges, variables)

    def _counter(self, owner: int) -> str:
        return f"{VARIABLES}waited__{self.elements[owner].name}"

    def _place(self, element: int) -> str:
        return f"{VARIABLES}place__{self.elements[element].name}"

    def _loops(self, element: int, combination: Combination) -> list[Edge]:
        """The loops of an element when the clock begins: they count, if a step is possible."""
        loops = []
        for location in self.locations[element]:
            inside = self.within(element, location, combination) if location in self.allowed[element] else None
            if inside is None:
                continue
            if element not in self.owned:
                loops.append(_loop(location, inside))
                continue
            counter = Name(self._counter(element))
            possible: list[Expression] = []
            for step in self.owned[element]:
                parts = self.undecided(step) or ()
                if all(combination[part] for part in parts if part[0] != element):
                    ready = [self.ready(part, location) for part in step.parts if part[0] == element]
                    if None not in ready:
                        possible.append(_all_of([part for part in ready if part is not None and part != _TRUE]))
            if _TRUE not in possible:
                at_rest = _all_of([part for part in (inside, *map(_not, possible)) if part != _TRUE])
                loops.append(_loop(location, at_rest, [Assignment(counter, Integer(0))]))
            if possible:
                waits = _TRUE if _TRUE in possible else _any_of(possible)
                below = Binary(BinaryOperator.LESS, counter, Integer(self.most))
                guard = _all_of([part for part in (inside, waits, below) if part != _TRUE])
                more = Binary(BinaryOperator.ADD, counter, Integer(1))
                loops.append(_loop(location, guard, [Assignment(counter, more)]))
        return loops

    def _resetting(self, owner: int) -> list[Edge]:
        """The edges of an owner. Its own steps reset its counter, others do if no own step is possible after them."""
        own = {action for step in self.owned[owner] for element, action in step.parts if element == owner}
        edges = []
        for number, edge in enumerate(self.elements[owner].edges):
            action = f"\n{number}" if edge.action is None else edge.action
            if action in own:
                edges.append(self._with_reset(owner, edge, lambda _: Integer(0)))
            elif any(self.ready((owner, other), edge.source) is not None for other in own):
                edges.append(self._with_reset(owner, edge, lambda location: self._kept(owner, location)))
            else:
                edges.append(edge)
        return edges

    def _with_reset(self, owner: int, edge: Edge, value_at: Callable[[str], Expression | None]) -> Edge:
        name = Name(self._counter(owner))
        destinations = []
        for destination in edge.destinations:
            value = value_at(destination.location)
            resets = [] if value is None else _later([Assignment(name, value)], destination)
            destinations.append(replace(destination, assignments=(*destination.assignments, *resets)))
        return replace(edge, destinations=tuple(destinations))

    def _kept(self, owner: int, location: str) -> Expression | None:
        """The counter of an owner that has arrived at a location by a step of another automaton; `None` if it keeps its
        value."""
        possible: list[Expression] = []
        for step in self.owned[owner]:
            conditions = [self._ready_now(part, owner, location) for part in step.parts]
            if None not in conditions:
                possible.append(_all_of([part for part in conditions if part is not None and part != _TRUE]))
        if _TRUE in possible:
            return None
        return Conditional(_any_of(possible), Name(self._counter(owner)), Integer(0)) if possible else Integer(0)

    def _ready_now(self, part: Part, owner: int, location: str) -> Expression | None:
        """Whether a part of a step is ready in any state in which its owner is in a location; `None` if it never is."""
        element, action = part
        if element == owner:
            return self.ready(part, location)
        ready = self.ready_in[element].get(action, {})
        if len(ready) == len(self.locations[element]):
            return _TRUE
        self.mirrored.add(element)
        numbers = (number for number, name in enumerate(self.locations[element]) if name in ready)
        place = Name(self._place(element))
        return _any_of([Binary(BinaryOperator.EQUAL, place, Integer(number)) for number in numbers])

    def _mirroring(self, element: int, edge: Edge) -> Edge:
        """An edge that also assigns its location to the variable of its element."""
        name = Name(self._place(element))
        return replace(
            edge,
            destinations=tuple(
                replace(
                    d,
                    assignments=(
                        *d.assignments,
                        *(
                            []
                            if d.location == edge.source
                            else [Assignment(name, Integer(self.locations[element].index(d.location)))]
                        ),
                    ),
                )
                for d in edge.destinations
            ),
        )

    def _interrupting(self, number: int, sync: Sync) -> Sync:
        """A synchronisation that resets the counters of automata whose steps it disables."""
        participants = dict(sync.participants)
        for owner, steps in self.owned.items():
            if owner in participants:
                continue
            stopped = {step for step in steps if any(self._leaves(part, participants) for part in step.parts)}
            if not stopped:
                continue
            loops = []
            for location in self.locations[owner]:
                ready = {step for step in steps if self._is_ready(step, owner, location)}
                reset = [Assignment(Name(self._counter(owner)), Integer(0))] if ready and ready <= stopped else []
                loops.append(_loop(location, _TRUE, reset))
            if any(loop.destinations[0].assignments for loop in loops):
                participants[owner] = self.action(owner, f"{PREFIX}interrupted", loops)
        return replace(sync, participants=tuple(sorted(participants.items())))

    def _is_ready(self, step: _Step, owner: int, location: str) -> bool:
        return all(self.ready(part, location) is not None for part in step.parts if part[0] == owner)

    def _leaves(self, part: Part, participants: Mapping[int, str]) -> bool:
        """Whether a part is not ready after a step with these participants."""
        element, action = part
        ready = self.ready_in[element].get(action, {})
        taken = participants.get(element)
        targets = {d.location for e in self.elements[element].edges if e.action == taken for d in e.destinations}
        return taken is not None and bool(targets) and targets.isdisjoint(ready)


def _ready(automaton: Automaton) -> dict[str, dict[str, list[Expression | None]]]:
    """For each action, the conditions of its edges in each location. Each edge without an action has an own name."""
    ready: dict[str, dict[str, list[Expression | None]]] = {}
    for number, edge in enumerate(automaton.edges):
        action = f"\n{number}" if edge.action is None else edge.action
        guard = None if edge.guard is None else edge.guard.exp
        ready.setdefault(action, {}).setdefault(edge.source, []).append(guard)
    return ready


def _values(ready: Expression | None) -> tuple[bool, ...]:
    """What a part can be."""
    return (False,) if ready is None else (True,) if ready == _TRUE else (False, True)


_TRUE = Boolean(True)


def _loop(location: str, guard: Expression, assignments: Iterable[Assignment] = ()) -> Edge:
    return Edge(location, (Destination(location, assignments=tuple(assignments)),), guard=_clause(guard))


def _clause(guard: Expression) -> Clause | None:
    return None if guard == _TRUE else Clause(guard)


def _not(expression: Expression) -> Expression:
    return Unary(UnaryOperator.NOT, expression)


def _all_of(parts: Sequence[Expression]) -> Expression:
    return _folded(BinaryOperator.AND, parts, _TRUE)


def _any_of(parts: Sequence[Expression]) -> Expression:
    return _folded(BinaryOperator.OR, parts, Boolean(False))


def _folded(operator: BinaryOperator, parts: Sequence[Expression], otherwise: Expression) -> Expression:
    result = parts[0] if parts else otherwise
    for part in parts[1:]:
        result = Binary(operator, result, part)
    return result


def _later(assignments: Iterable[Assignment], destination: Destination) -> list[Assignment]:
    """Assignments after all others of a destination."""
    index = 1 + max((assignment.index for assignment in destination.assignments), default=-1)
    return [replace(assignment, index=index) for assignment in assignments]
