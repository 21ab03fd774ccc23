# SPDX-License-Identifier: Apache-2.0
"""The possible next steps, with descriptions.

Each combination of enabled edges of a synchronisation vector is a choice. Vectors with the same effect are one choice.
If the seed decides, all combinations are equally probable, as in `verify`. The outcomes of a choice are the
combinations of destinations, drawn by their probabilities.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import TypeAlias

from roaml.durations import moment
from roaml.jani.expressions import Boolean, Integer, Name, Real
from roaml.jani.model import Assignment, Automaton, Destination, Edge
from roaml.jani.node import Origin
from roaml.record import Record
from roaml.scxml.events import Role
from roaml.scxml.names import (
    CLOCK,
    CLOCK_ACTION,
    array_of,
    automaton_role,
    is_observer,
    is_timer,
    received_by,
    sent_by,
)
from roaml.simulation.run import Decision, EnabledEdges, Run
from roaml.simulation.words import resting, returned_status, tree_text
from roaml.smc.compile import Legend
from roaml.smc.fault import FaultError
from roaml.smc.record import Plain, RecordedVariable
from roaml.views.actors import tree_phrase
from roaml.views.arrays import DeclaredValue, declared
from roaml.views.event_words import event_phrase
from roaml.views.events import EventReader
from roaml.views.library_nodes import is_library_node
from roaml.views.locations import states_of
from roaml.views.values import shown_parameters, shown_value

MAX_OUTCOMES = 64
"""The maximum number of listed outcomes of a choice; all outcomes can be drawn."""
MAX_CHOICES = 256
"""The maximum number of listed choices in a state."""


class Outcome(Record, frozen=True):
    """A possible outcome of a choice.

    Attributes:
        probability: the probability of the outcome if the choice is taken.
        text: a description of the assignments, states and events of this outcome; "" if the choice has only one.
        decision: the decision that takes the choice with this outcome.
    """

    probability: float
    text: str
    decision: Decision


class Choice(Record, frozen=True):
    """A possible next step.

    Attributes:
        number: the number in the list of choices, from 1.
        text: a description of what each automaton does.
        automata: the names of the automata that take part; those that only buffer an event are last.
        probability: the probability of this choice if the seed decides.
        outcomes: at least one; outcomes with probability 0 are omitted.
        origin: the place in the source of the edge of the first automaton.
        is_internal: whether one automaton only executes its next statement, which no other automaton observes.
        is_of_translation: whether only automata that the translation has added do something (`is_of_translation`).
    """

    number: int
    text: str
    automata: tuple[str, ...]
    probability: float
    outcomes: tuple[Outcome, ...]
    origin: Origin | None
    is_internal: bool
    is_of_translation: bool = False


Phrases: TypeAlias = Callable[[str], Mapping[str, str]]
"""The name of an automaton -> phrases for those of its variables whose names are not those of the user."""


class _Part(Record, frozen=True):
    """An automaton that takes part in a step, with the number of its instance, its edge, the number of the first
    destination of this edge in the kernel, and the probabilities of the destinations."""

    automaton: Automaton
    instance: int
    edge: Edge
    first_way: int
    probabilities: tuple[float, ...]


def is_of_translation(action: str, actors: Collection[str], *, has_machine: bool) -> bool:
    """Whether a step is one of the translation, which nobody has written: the clock acts, or a node of the tree or a
    handler executes its next statement.

    Args:
        actors: the names of the automata that take part, without those that only buffer an event.
        has_machine: whether one of them is a state machine or plugin.
    """
    is_internal = not sent_by(action) and not received_by(action) and action != CLOCK_ACTION
    return not has_machine and (is_internal or all(automaton_role(name) is Role.CLOCK for name in actors))


def choices(
    run: Run,
    events: EventReader,
    phrases: Phrases,
    names: Mapping[str, str],
    clock: Sequence[str],
    is_machine: Callable[[int], bool],
) -> Iterator[Choice]:
    """The choices of a state, at most `MAX_CHOICES`.

    Args:
        events: the reader of events, after it has read all steps up to this state.
        names: the names of all automata in texts for users.
        clock: the variables of the model with its time in s and the rest in ns; empty if it has no clock.
    """
    enabled, legend = run.enabled(), run.legend
    total = sum(vector.ties * math.prod(len(slot.edges) for slot in vector.slots) for vector in enabled)
    number = 0
    for vector in enabled:
        for picks in itertools.product(*(range(len(slot.edges)) for slot in vector.slots)):
            if number == MAX_CHOICES:
                return
            number += 1
            parts = [_part(legend, slot, pick) for slot, pick in zip(vector.slots, picks, strict=True)]
            actors = [part for part in parts if not events.is_event(part.automaton.name)]
            actors = [part for part in actors if not is_observer(part.automaton.name)] or actors
            action = legend.vectors[vector.vector][1] or ""
            outcomes = tuple(_outcomes(run, vector.vector, picks, parts, events, phrases, names))
            if action == CLOCK_ACTION:
                text = _time_text(_time_after(run, outcomes[0].decision, clock))
            else:
                text = _text(action, actors, parts, events, names)
            yield Choice(
                number,
                text,
                tuple(part.automaton.name for part in (*actors, *(p for p in parts if p not in actors))),
                vector.ties / total,
                outcomes,
                (actors or parts)[0].edge.origin if parts else None,
                len(actors) <= 1 and not sent_by(action) and not received_by(action) and action != CLOCK_ACTION,
                is_of_translation(
                    action,
                    [part.automaton.name for part in actors],
                    has_machine=any(is_machine(part.instance) for part in actors),
                ),
            )


def _part(legend: Legend, slot: EnabledEdges, pick: int) -> _Part:
    first_way, probabilities = slot.edges[pick]
    edge, _ = legend.ways[first_way]
    return _Part(legend.layout.instances[slot.instance].automaton, slot.instance, edge, first_way, probabilities)


def _outcomes(
    run: Run,
    vector: int,
    picks: tuple[int, ...],
    parts: Sequence[_Part],
    events: EventReader,
    phrases: Phrases,
    names: Mapping[str, str],
) -> Iterator[Outcome]:
    ways = [[way for way, chance in enumerate(part.probabilities) if chance > 0] for part in parts]
    is_certain = all(len(possible) == 1 for possible in ways)
    for taken in itertools.islice(itertools.product(*ways), MAX_OUTCOMES):
        probability = math.prod(part.probabilities[way] for part, way in zip(parts, taken, strict=True))
        decision = Decision(vector, picks, taken)
        effects = () if is_certain else tuple(_effects(run, decision, parts, events, phrases, names))
        if not is_certain and not effects:
            effects = tuple(_moves(run, decision, parts, names)) or ("nothing changes",)
        yield Outcome(probability, ", ".join(effects), decision)


def _moves(run: Run, decision: Decision, parts: Sequence[_Part], names: Mapping[str, str]) -> Iterator[str]:
    """The automata that go on to another location."""
    for part, way in zip(parts, decision.ways, strict=True):
        if run.legend.ways[part.first_way + way][1].location != part.edge.source:
            yield f"{names[part.automaton.name]} goes on"


def _effects(
    run: Run,
    decision: Decision,
    parts: Sequence[_Part],
    events: EventReader,
    phrases: Phrases,
    names: Mapping[str, str],
) -> Iterator[str]:
    """The consequences of each destination that was drawn from several ones, or the reason why the step fails."""
    destinations = [
        (part, run.legend.ways[part.first_way + way][1])
        for part, way in zip(parts, decision.ways, strict=True)
        if sum(chance > 0 for chance in part.probabilities) > 1
    ]
    computed = {variable for part, destination in destinations for variable in _computed(part, destination)}
    try:
        after = run.values_after(decision, computed) if computed else {}
    except FaultError as fault:
        yield f"the step fails: {fault.message}"
        return
    for part, destination in destinations:
        values = {variable.name: value for variable, value in after.items() if variable.instance in (-1, part.instance)}
        yield from _consequences(part.automaton, destination, values, names, events, phrases(part.automaton.name))


def _computed(part: _Part, destination: Destination) -> Iterator[RecordedVariable]:
    """The variables whose values a destination computes, with the lengths of arrays."""
    names = {
        array_of(assignment.variable) or assignment.variable
        for assignment in destination.assignments
        if array_of(assignment.variable) or _constant(assignment) is None
    }
    names |= {variable.name for variable in part.automaton.variables if array_of(variable.name) in names}
    for name in names:
        yield RecordedVariable(part.instance, name)
        yield RecordedVariable(-1, name)


def _constant(assignment: Assignment) -> Plain | None:
    """The constant to which an assignment sets a variable, known before the step; `None` for another assignment."""
    if isinstance(assignment.target, Name) and isinstance(assignment.value, (Boolean, Integer, Real)):
        return assignment.value.value
    return None


def _consequences(
    automaton: Automaton,
    destination: Destination,
    after: Mapping[str, Plain],
    names: Mapping[str, str],
    events: EventReader,
    phrases: Mapping[str, str],
) -> Iterator[str]:
    """Descriptions of what an automaton does after a destination, up to a state in which it waits or to the next
    branch.

    Args:
        after: the values of the variables that the destination computes, with the lengths of arrays.
    """
    rest, states = resting(automaton), states_of(automaton)
    name = names[automaton.name]
    visited: set[str] = set()
    while True:
        for variable, value in _assigned(destination, after).items():
            if not events.carries_event(variable):
                yield f"{phrases.get(variable, variable)} := {shown_value(value)}"
        location = destination.location
        following = [edge for edge in automaton.edges if edge.source == location]
        if location in rest:
            if not is_library_node(automaton):
                yield f"{name} enters `{states[location]}`"
            return
        if location in visited or len(following) != 1 or len(following[0].destinations) != 1:
            statuses = _statuses(automaton, location, rest)
            if len(statuses) == 1 and (status := statuses.pop()):
                yield f"{name} returns {status}"
            return
        visited.add(location)
        event = sent_by(following[0].action or "")
        (destination,), after = following[0].destinations, {}
        if status := returned_status(event, destination):
            yield f"{name} returns {status}"
        elif event:
            yield f"{name} sends {event_phrase(event, names)}"


def _statuses(automaton: Automaton, location: str, rest: Collection[str]) -> set[str]:
    """The statuses that a node of the tree may return before it waits for an event again; "" for paths on which it
    returns none."""
    statuses: set[str] = set()
    visited = {location}
    remaining = [location]
    while remaining:
        source = remaining.pop()
        if source in rest:
            statuses.add("")
            continue
        for edge in automaton.edges:
            for destination in edge.destinations if edge.source == source else ():
                if status := returned_status(sent_by(edge.action or ""), destination):
                    statuses.add(status)
                elif destination.location not in visited:
                    visited.add(destination.location)
                    remaining.append(destination.location)
    return statuses


def _assigned(destination: Destination, after: Mapping[str, Plain]) -> dict[str, DeclaredValue]:
    """The variables that a destination sets, with their values as far as they are known. An assignment to a length
    sets its array."""
    values: dict[str, DeclaredValue] = {}
    for assignment in destination.assignments:
        array = array_of(assignment.variable)
        name = array or assignment.variable
        value = after.get(name, None if array else _constant(assignment))
        if value is not None:
            values[name] = declared(name, value, after)
    return values


def _time_after(run: Run, decision: Decision, clock: Sequence[str]) -> float | None:
    """The time of the clock in s after a step; `None` if it is not known."""
    variables = [RecordedVariable(-1, name) for name in clock]
    try:
        values = run.values_after(decision, variables)
    except FaultError:
        return None
    numbers = [value for variable in variables if isinstance(value := values[variable], (int, float))]
    return numbers[0] + numbers[1] / 1e9 if numbers else None


def _time_text(time_s: float | None) -> str:
    return "time passes" if time_s is None else f"time passes to {moment(time_s)}"


def _text(
    action: str, actors: Sequence[_Part], parts: Sequence[_Part], events: EventReader, names_of: Mapping[str, str]
) -> str:
    names = [names_of[part.automaton.name] for part in actors]
    event = sent_by(action)
    spoken = event or received_by(action)
    description = tree_text(_listed(names), spoken, bool(event), events.parameters(spoken), names_of) if names else ""
    if description:
        return description
    if event:
        return f"{_listed(names)} {_verb(names, 'sends', 'send')} {event_phrase(event, names_of)}"
    event = received_by(action)
    if event and is_timer(event):
        takers = [part.automaton for part in actors if automaton_role(part.automaton.name) is not Role.CLOCK]
        if not takers:
            return "a timer ticks"
        if all(automaton_role(taker.name) is Role.TREE_ROOT for taker in takers):
            trees = dict.fromkeys(tree_phrase(taker.name, names_of) for taker in takers)
            return f"{_listed(list(trees))} {_verb(list(trees), 'begins its', 'begin their')} next tick"
        names = [names_of[taker.name] for taker in takers]
        return f"{_listed(names)} {_verb(names, 'takes', 'take')} {event_phrase(event, names_of, taken=True)}"
    if event:
        parameters = _parameters(events.parameters(event))
        if not names:
            return f"no automaton receives {event_phrase(event, names_of)}{parameters}"
        return f"{_listed(names)} {_verb(names, 'receives', 'receive')} {event_phrase(event, names_of)}{parameters}"
    if not names:
        names = [names_of[part.automaton.name] for part in parts]
    if all(_is_start(part) for part in actors or parts):
        return f"{_listed(names)} {_verb(names, 'starts', 'start')}"
    if all(part.automaton.name == CLOCK for part in actors or parts):
        return "the clock triggers the timers that are due"
    return f"{_listed(names)} {_verb(names, 'goes', 'go')} on"


def _is_start(part: _Part) -> bool:
    """Whether a part is the first step of its automaton, before its initial state (docs/spec/jani.md#locations)."""
    return part.edge.source in part.automaton.initial_locations and part.edge.action == part.edge.source


def _parameters(values: Mapping[str, DeclaredValue]) -> str:
    return f" ({shown_parameters(values)})" if values else ""


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else "".join(names)


def _verb(names: Sequence[str], singular: str, plural: str) -> str:
    return singular if len(names) == 1 else plural
