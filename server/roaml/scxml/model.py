# SPDX-License-Identifier: Apache-2.0
"""Plain SCXML: the result of lowering HL-SCXML, and the input of the translation to JANI (docs/spec/plain-scxml.md).

- Flat state machines that share no data and exchange events by name. There are no ROS elements, trees or structs:
  variables are scalars, strings and arrays of these.
- Frozen. Everything has an `origin`, the place in the models from which it comes, including added parts.
- Expressions are trees of `roaml.expr` over flat names: `pose__x`, `_event.data.ros_fields__data`. Their own spans are
  in the file of the origin around them.
- Whole numbers are ints outside of initial values, however they were written (docs/spec/expressions.md#whole-reals).
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from roaml.expr.tree import Expr
from roaml.expr.types import Type
from roaml.text import Location


class Role(enum.Enum):
    """The role of an automaton in the system; the translation to JANI treats some roles differently
    (docs/spec/jani.md#discarding)."""

    MACHINE = "machine"
    TREE_ROOT = "root of the behavior tree"
    BLACKBOARD = "blackboard"
    HANDLER = "service or action handler"
    CLOCK = "clock"


class EventRole(enum.Enum):
    """The purpose of an event; the translation to JANI treats some differently (docs/spec/jani.md#event-automata)."""

    PLAIN = "plain"
    """An event that a receiver discards if it does not wait for the event."""
    BLOCKING = "blocking"
    """An event that waits for its receivers."""
    TIMER_TICK = "tick of a timer"
    CLOCK_STEP = "step of the clock"
    BLACKBOARD_READ = "read of the blackboard"
    BLACKBOARD_WRITE = "write to the blackboard"

    @property
    def is_synchronising(self) -> bool:
        """Whether the event waits for its receivers (docs/spec/jani.md#synchronising-names)."""
        return self in (EventRole.BLOCKING, EventRole.CLOCK_STEP)

    @property
    def is_internal(self) -> bool:
        """Whether the event has neither buffer nor variables."""
        return self in (EventRole.TIMER_TICK, EventRole.CLOCK_STEP)


@dataclass(frozen=True, slots=True)
class ScxmlEvent:
    """An event by name. Events of the same name have the same role.

    Attributes:
        after: the event that must not wait for its receivers when this one is received; "" for none.
    """

    name: str
    role: EventRole = EventRole.PLAIN
    after: str = ""


@dataclass(frozen=True, slots=True)
class Data:
    """A variable; `value` is a constant expression."""

    id: str
    type: Type
    value: Expr
    origin: Location


@dataclass(frozen=True, slots=True)
class Assign:
    """`location` is a variable, an element of one, or the `.length` of either."""

    location: Expr
    value: Expr
    origin: Location


@dataclass(frozen=True, slots=True)
class Param:
    name: str
    value: Expr
    origin: Location


@dataclass(frozen=True, slots=True)
class Send:
    event: ScxmlEvent
    params: tuple[Param, ...]
    origin: Location


@dataclass(frozen=True, slots=True)
class Branch:
    cond: Expr
    body: Body
    origin: Location


@dataclass(frozen=True, slots=True)
class If:
    """The first branch whose condition holds is executed, otherwise `otherwise`."""

    branches: tuple[Branch, ...]
    otherwise: Body
    origin: Location


Statement: TypeAlias = Assign | Send | If
Body: TypeAlias = tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Target:
    """The target of a transition and the statements on the way; the probabilities of one transition add up to 1."""

    state: str
    probability: float
    body: Body
    origin: Location


@dataclass(frozen=True, slots=True)
class Transition:
    """A transition that is taken on `event` (`None` for none) if `cond` holds and no earlier transition on the same
    event is taken."""

    event: ScxmlEvent | None
    cond: Expr | None
    targets: tuple[Target, ...]
    origin: Location


@dataclass(frozen=True, slots=True)
class State:
    id: str
    entry: Body
    exit: Body
    transitions: tuple[Transition, ...]
    origin: Location


@dataclass(frozen=True, slots=True)
class Automaton:
    """One state machine. Entering a state executes its `entry`; that of the initial state is executed once at the
    start.

    Attributes:
        thread_of: the automaton of the machine whose thread this is; "" for other automata.
    """

    name: str
    role: Role
    initial: str
    data: tuple[Data, ...]
    states: tuple[State, ...]
    origin: Location
    thread_of: str = ""


@dataclass(frozen=True, slots=True)
class Network:
    """All automata of a system, in processing order (docs/spec/systems.md#processing-order).

    Attributes:
        max_array_size: the maximum number of elements of an array without a bound, and of every array that is sent.
        random_values: the number of values of `Math.random()`.
    """

    automata: tuple[Automaton, ...]
    max_array_size: int
    random_values: int


def statements(body: Body) -> Iterator[Statement]:
    """All statements of a body in document order, including those inside of an `If`."""
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
