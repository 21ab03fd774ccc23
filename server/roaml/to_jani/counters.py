# SPDX-License-Identifier: Apache-2.0
"""Rewards that count events of a translated system: messages on a topic, and ticks of a node of the tree
(docs/verification.md#rewards).

The counter is a transient variable, which the sending of the event sets to 1, so it adds no states. Its name is the
text that asks for it, such as `messages /arm/command`.
"""

from __future__ import annotations

from roaml.jani.expressions import Integer, Name
from roaml.jani.model import Assignment, Automaton, Destination, Edge, Model, Variable
from roaml.jani.types import INT
from roaml.record import replace
from roaml.regex import regex
from roaml.scxml.names import sent_by, topic_message
from roaml.suggest import close_names, did_you_mean
from roaml.to_jani.observer_parts import next_index

_COUNTER = regex(r"(messages|ticks) (\S.*)")
_NODE = regex(r"BT_plugin_(\d+)_(.+)")
_TICK = regex(r"bt_(\d+)_tick")


class CounterError(ValueError):
    """Raised if a model has no event that is to be counted. The message contains the reason."""


def is_counter(name: str) -> bool:
    """Whether a name asks for a number of events."""
    return _COUNTER.fullmatch(name) is not None


def with_counter(model: Model, name: str) -> Model:
    """A copy of a model in which the transient variable `name` is 1 in each step that sends the event for which the
    name asks, and otherwise 0.

    Raises:
        CounterError: the model has no such event, or several nodes have the name.
    """
    if any(variable.name == name for variable in model.variables):
        return model
    event, index = _event(model, name), next_index(model)
    automata = tuple(
        _counting(automaton, name, index) if automaton.name == event else automaton for automaton in model.automata
    )
    return replace(model, automata=automata, variables=(*model.variables, Variable(name, INT, Integer(0), True)))


def _counting(automaton: Automaton, name: str, index: int) -> Automaton:
    counted = Assignment(Name(name), Integer(1), index)

    def with_count(destination: Destination) -> Destination:
        return replace(destination, assignments=(*destination.assignments, counted))

    def of(edge: Edge) -> Edge:
        if sent_by(edge.action or "") != automaton.name:
            return edge
        return replace(edge, destinations=tuple(map(with_count, edge.destinations)))

    return replace(automaton, edges=tuple(map(of, automaton.edges)))


def _event(model: Model, name: str) -> str:
    match = _COUNTER.fullmatch(name)
    assert match is not None
    kind, what = match.groups()
    names = [automaton.name for automaton in model.automata]
    if kind == "messages":
        event = topic_message(what)
        if event not in names:
            raise CounterError(f"nothing sends messages on the topic `{what}`")
        return event
    nodes = {match[1]: match[2] for known in names if (match := _NODE.fullmatch(known))}
    ticked = [match[1] for known in names if (match := _TICK.fullmatch(known))]
    numbers = [number for number in ticked if what in (number, nodes.get(number))]
    if not numbers:
        meant = close_names(what, nodes.values(), 1)
        raise CounterError(f"the tree has no node `{what}` that is ticked{did_you_mean(meant) if meant else ''}")
    if len(numbers) > 1:
        raise CounterError(f"several nodes are called `{what}`; write a number instead: {', '.join(numbers)}")
    return f"bt_{numbers[0]}_tick"
