# SPDX-License-Identifier: Apache-2.0
"""The types of plain SCXML, the result of lowering HL-SCXML and the input of the translation to JANI
(docs/spec/plain-scxml.md).

- A system consists of flat state machines that share no data and exchange events by name. There are no ROS elements,
  trees or structs. Variables are scalars, strings and arrays of these.
- All data is immutable. Every part has an `origin`, the place in the models from which it comes. Parts that the
  translation adds have one, too.
- Expressions are trees of `roaml.expr` with flat names, such as `pose__x` or `_event.data.ros_fields__data`. The spans
  of an expression refer to the file of the enclosing `origin`.
- Outside of initial values, numbers without a fraction are ints, even if they are written as reals
  (docs/spec/expressions.md#whole-reals).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

from roaml.durations import ANY_TIME, ReactionTime
from roaml.expr.tree import Expr
from roaml.expr.types import Type
from roaml.record import Record
from roaml.scxml.events import Role, ScxmlEvent
from roaml.text import Location


class Data(Record, frozen=True):
    """A variable; `value` is a constant expression."""

    id: str
    type: Type
    value: Expr
    origin: Location


class Assign(Record, frozen=True):
    """An assignment. `location` is a variable, an element of an array, or the `.length` of either."""

    location: Expr
    value: Expr
    origin: Location


class Param(Record, frozen=True):
    """A parameter of an event. `declared` is the type of the ROS field that it contains; it matters if the value is
    `[]`, which does not show the type of the elements."""

    name: str
    value: Expr
    origin: Location
    declared: Type | None = None


class Send(Record, frozen=True):
    event: ScxmlEvent
    params: tuple[Param, ...]
    origin: Location


class Branch(Record, frozen=True):
    cond: Expr
    body: Body
    origin: Location


class If(Record, frozen=True):
    """A conditional statement: the first branch whose condition holds is executed. If there is none, `otherwise` is
    executed."""

    branches: tuple[Branch, ...]
    otherwise: Body
    origin: Location


Statement: TypeAlias = Assign | Send | If
Body: TypeAlias = tuple[Statement, ...]


class Target(Record, frozen=True):
    """A target of a transition, with the statements that are executed before the target is entered. The probabilities
    of the targets of a transition add up to 1."""

    state: str
    probability: float
    body: Body
    origin: Location


class Transition(Record, frozen=True):
    """A transition. It is taken on `event` if `cond` holds and no earlier transition on the same event is taken.
    `event` is `None` for an eventless transition."""

    event: ScxmlEvent | None
    cond: Expr | None
    targets: tuple[Target, ...]
    origin: Location


class State(Record, frozen=True):
    id: str
    entry: Body
    exit: Body
    transitions: tuple[Transition, ...]
    origin: Location


class Automaton(Record, frozen=True):
    """One state machine. The `entry` of a state is executed when the state is entered; the `entry` of the initial state
    is also executed once at the start.

    Attributes:
        thread_of: for an action thread, the name of the automaton of its machine; "" for other automata.
        thread: for an action thread, its name for users within its machine; "" for other automata.
    """

    name: str
    role: Role
    initial: str
    data: tuple[Data, ...]
    states: tuple[State, ...]
    origin: Location
    thread_of: str = ""
    thread: str = ""


class Network(Record, frozen=True):
    """All automata of a system, in processing order (docs/spec/systems.md#processing-order).

    Attributes:
        max_array_size: the maximum number of elements of an array without a bound, and of every array that is sent.
        random_values: the number of values of `Math.random()`.
        clock_step: the length of a step of the clock, in ns; 0 if there is no clock.
        reaction_time: how long automata may wait before they take a possible step.
        flags: names of flags of events that exist even if no automaton sends or awaits the event.
    """

    automata: tuple[Automaton, ...]
    max_array_size: int
    random_values: int
    clock_step: int = 0
    reaction_time: ReactionTime = ANY_TIME
    flags: tuple[str, ...] = ()


def statements(body: Body) -> Iterator[Statement]:
    """All statements of a body in document order, including those inside an `If`."""
    for statement in body:
        yield statement
        if isinstance(statement, If):
            for branch in statement.branches:
                yield from statements(branch.body)
            yield from statements(statement.otherwise)


def bodies(automaton: Automaton) -> Iterator[Body]:
    """Every body of the automaton, in document order."""
    for state in automaton.states:
        yield state.entry
        yield state.exit
        for transition in state.transitions:
            for target in transition.targets:
                yield target.body
