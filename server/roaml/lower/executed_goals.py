# SPDX-License-Identifier: Apache-2.0
"""Stores which goals an automaton of an action server executes, for the actions whose cancel requests it handles
(docs/spec/plain-scxml.md#cancel).

For each client that cancels goals, a boolean variable states whether the automaton executes the goal of the client. A
server executes a goal from its acceptance, and a thread executes it from the start of the thread, until the automaton
ends the goal or passes it on to a thread.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from roaml.expr.operators import Operator
from roaml.expr.tree import Boolean, Expr
from roaml.expr.types import BASE_TYPES
from roaml.expr.zero import zero
from roaml.lower.build import binary, both, equal, event_data, integer, name
from roaml.lower.context import LoweringContext
from roaml.model.system import Channel
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.scxml.model import Assign, Data
from roaml.scxml.names import executes_goal
from roaml.text import NO_SPAN, Location

GOAL_ID = "goal_id"
_BOOL = BASE_TYPES["bool"]


class ExecutedGoals(Record, frozen=True):
    """The variables for the executed goals of one automaton.

    Attributes:
        variables: name of an action -> id of the goals of a client that cancels goals -> name of the variable.
    """

    variables: Mapping[str, Mapping[int, str]]

    def data(self, origin: Location) -> Iterator[Data]:
        for variables in self.variables.values():
            for variable in variables.values():
                yield Data(variable, _BOOL, zero(_BOOL), origin)

    def is_executed(self, action: Channel) -> Expr | None:
        """The condition that the automaton executes the goal that a cancel request names; `None` if there are no
        variables for the action."""
        condition: Expr | None = None
        for number, variable in self._of(action).items():
            own = both(equal(event_data(GOAL_ID), integer(number)), name(variable))
            condition = own if condition is None else binary(condition, Operator.OR, own)
        return condition

    def start(self, action: Channel, origin: Location) -> Iterator[Assign]:
        """The assignments when a thread starts and receives its goal."""
        return self._assign(action, lambda _, number: equal(event_data(GOAL_ID), integer(number)), origin)

    def sent(self, action: Channel, part: ProtocolPart, goal_id: Expr | None, origin: Location) -> Iterator[Assign]:
        """The assignments when a server or thread sends `part` of the action for the goal `goal_id`."""
        match part:
            case ProtocolPart.GOAL_ACCEPTED if goal_id is not None:
                accepted = goal_id
                yield from self._assign(
                    action,
                    lambda variable, number: binary(name(variable), Operator.OR, equal(accepted, integer(number))),
                    origin,
                )
            case ProtocolPart.RESULT | ProtocolPart.THREAD_START if goal_id is not None:
                given_up = goal_id
                yield from self._assign(
                    action,
                    lambda variable, number: both(
                        name(variable), binary(given_up, Operator.NOT_EQUAL, integer(number))
                    ),
                    origin,
                )
            case ProtocolPart.THREAD_FREE:
                yield from self._assign(action, lambda _, __: Boolean(NO_SPAN, False), origin)

    def _of(self, action: Channel) -> Mapping[int, str]:
        return self.variables.get(action.name, {})

    def _assign(self, action: Channel, value: Callable[[str, int], Expr], origin: Location) -> Iterator[Assign]:
        for number, variable in self._of(action).items():
            yield Assign(name(variable), value(variable, number), origin)


def executed_goals(context: LoweringContext) -> ExecutedGoals:
    variables: dict[str, dict[int, str]] = {}
    for state in context.chart.states:
        for handler in state.handlers:
            if handler.trigger is not ProtocolPart.CANCEL or not handler.effective:
                continue
            action = context.channel(handler)
            if action.name not in variables:
                variables[action.name] = {
                    number: _unused(executes_goal(action.name, number), context)
                    for number, client in enumerate(action.users)
                    if ProtocolPart.CANCEL in client.use.sends
                }
    return ExecutedGoals(variables)


def _unused(variable: str, context: LoweringContext) -> str:
    while variable in context.variables:
        variable += "_"
    return variable
