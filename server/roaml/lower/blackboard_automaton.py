# SPDX-License-Identifier: Apache-2.0
"""The automaton that stores variables of the blackboard (docs/spec/plain-scxml.md#blackboard)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roaml.lower.blackboard_events import answer_of, blackboard_write, request_of
from roaml.lower.build import event_data, integer, name
from roaml.scxml.events import Role
from roaml.scxml.model import Assign, Automaton, Data, Param, Send, State, Target, Transition
from roaml.scxml.names import blackboard_of
from roaml.text import Location

_STATE = "idle"


def blackboard_automaton(
    variables: Sequence[Data], flags: Mapping[str, Sequence[str]], origin: Location, *, is_read: bool, tree: str = ""
) -> Automaton:
    """The automaton that stores variables.

    Args:
        variables: the variables, at least one.
        flags: variable -> the variables that become 1 when it is written.
        is_read: whether an automaton asks for the values.
        tree: the name of the tree in the system; "" if it has none.
    """
    transitions = [_write(variable, flags.get(variable.id, ())) for variable in variables]
    if is_read:
        answer = Send(answer_of(tree), tuple(Param(v.id, name(v.id), v.origin) for v in variables), origin)
        transitions.append(Transition(request_of(tree), None, (Target(_STATE, 1.0, (answer,), origin),), origin))
    idle = State(_STATE, (), (), tuple(transitions), origin)
    return Automaton(blackboard_of(tree), Role.BLACKBOARD, _STATE, tuple(variables), (idle,), origin)


def _write(variable: Data, flags: Sequence[str]) -> Transition:
    origin = variable.origin
    value = Assign(name(variable.id), event_data("value"), origin)
    set_flags = (Assign(name(flag), integer(1), origin) for flag in flags)
    return Transition(blackboard_write(variable.id), None, (Target(_STATE, 1.0, (value, *set_flags), origin),), origin)
