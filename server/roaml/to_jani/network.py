# SPDX-License-Identifier: Apache-2.0
"""Translates a network of automata in plain SCXML to one JANI model (docs/spec/jani.md)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from roaml.jani.model import Action, Automaton, Clock, Metadata, Model, ModelType, Variable
from roaml.jani.properties import Property
from roaml.jani.reaction import reacting
from roaml.jani.types import BOOL
from roaml.scxml.events import EventRole, Role
from roaml.scxml.model import Data, Network
from roaml.scxml.names import CLOCK, CLOCK_ACTION, TRANSLATION_MARK, flag_of
from roaml.scxml.observed import ObservedProperty
from roaml.text import Location
from roaml.to_jani.composition import compose, event_automaton, has_automaton
from roaml.to_jani.edges import flow_of
from roaml.to_jani.events import EventUsage, event_table
from roaml.to_jani.moves import AutomatonMoves, behavior_of
from roaml.to_jani.observers import observed
from roaml.to_jani.properties import expanded
from roaml.to_jani.shapes import ArrayShape, constructed_zero, jani_type, shape_of
from roaml.to_jani.values import JaniScope, elements_as, lengths_as

FEATURES = ("arrays", "trigonometric-functions")


def translate(
    network: Network,
    properties: Iterable[Property] = (),
    observed_properties: Sequence[ObservedProperty] = (),
    *,
    has_activity: bool = False,
) -> Model:
    """The JANI model of a network: its automata, an automaton for each event, observers and properties.

    Args:
        properties: the properties that are formulas of JANI.
        observed_properties: the properties for which observers are added.
        has_activity: whether observers also store whether their property was triggered.
    """
    behaviors = [behavior_of(automaton) for automaton in network.automata]
    table = event_table(behaviors)
    has_clock = any(automaton.role is Role.CLOCK for automaton in network.automata)
    automata = [_automaton(behavior, table, network) for behavior in behaviors]
    events = [event for event in table.values() if has_automaton(event)]
    # The read request of the blackboard is last, as in the reference translator.
    events.sort(key=lambda event: event.role is EventRole.BLACKBOARD_READ)
    buffers = {event.name: len(automata) + i for i, event in enumerate(events)}
    earlier = {event.event.after for event in events}
    automata += [event_automaton(event, has_clock, event.name in earlier) for event in events]
    globals_ = {v: shape for event in events for v, shape in _global_shapes(event, network.max_array_size)}
    if network.flags:
        origin = network.automata[0].origin
        globals_ |= {flag: (ArrayShape(BOOL), origin) for flag in network.flags if flag not in globals_}
    shapes = {name: shape for name, (shape, _) in globals_.items()}
    actions = sorted({edge.action for automaton in automata for edge in automaton.edges if edge.action})
    model = Model(
        ModelType.MDP,
        tuple(automata),
        compose(automata, buffers, table),
        features=FEATURES,
        metadata=Metadata(
            description=TRANSLATION_MARK,
            clock=Clock(CLOCK, (CLOCK_ACTION,), network.clock_step) if has_clock else None,
        ),
        variables=tuple(
            Variable(name, jani_type(shape), constructed_zero(shape), origin=origin)
            for name, (shape, origin) in globals_.items()
        ),
        actions=tuple(Action(action) for action in actions),
        properties=tuple(expanded(property_, shapes) for property_ in properties),
    )
    owners = {automaton.name: automaton.thread_of for automaton in network.automata if automaton.thread_of}
    model = observed(model, observed_properties, shapes, network.max_array_size, owners, has_activity=has_activity)
    return reacting(model, network.reaction_time)


def _automaton(behavior: AutomatonMoves, table: Mapping[str, EventUsage], network: Network) -> Automaton:
    automaton = behavior.automaton
    flow = flow_of(behavior, table, network.max_array_size, network.random_values)
    variables = tuple(v for data in automaton.data for v in _local_variables(data, network.max_array_size))
    return Automaton(
        automaton.name,
        tuple(sorted(flow.locations, key=lambda location: location.name)),
        (flow.initial,),
        flow.edges,
        variables,
        thread_of=automaton.thread_of,
        thread=automaton.thread,
        origin=automaton.origin,
    )


_CONSTANTS = JaniScope({}, "", {})


def _local_variables(data: Data, max_array_size: int) -> Iterator[Variable]:
    shape = shape_of(data.type, max_array_size)
    array = _CONSTANTS.array(data.value)
    if array is None:
        yield Variable(data.id, jani_type(shape), _CONSTANTS.scalar(data.value), origin=data.origin)
        return
    yield Variable(data.id, jani_type(shape), elements_as(array, shape), origin=data.origin)
    for k, (name, length) in enumerate(shape.lengths(data.id)):
        yield Variable(name, jani_type(length), lengths_as(array, shape, k + 1), origin=data.origin)


def _global_shapes(event: EventUsage, max_array_size: int) -> Iterator[tuple[str, tuple[ArrayShape, Location]]]:
    """The names, shapes and origins of the variables of an event: its flag, its parameters and their lengths
    (docs/spec/jani.md#global-variables)."""
    yield flag_of(event.name), (ArrayShape(BOOL), event.origin)
    for param, type_ in event.params.items():
        name, origin = f"{event.name}__{param}", event.places[param]
        shape = shape_of(type_, max_array_size, sent=True)
        yield name, (shape, origin)
        for companion, length in shape.lengths(name):
            yield companion, (length, origin)
