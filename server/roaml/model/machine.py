# SPDX-License-Identifier: Apache-2.0
"""A state machine document as typed data (docs/spec/machines.md): its content, independent of its system.

- A machine is immutable. It depends on one file only, so equal texts give equal machines.
- An incomplete document gives an incomplete machine: every part that may be missing can be `None`; nothing is guessed.
- Every part has its XML element, which leads to its grammar (`ElementType`) and its position.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import TypeAlias

from roaml.language import ElementType
from roaml.model.syntax import Expression, Name, PortRead, TypeRef, Value
from roaml.record import Record
from roaml.roles import Direction, ProtocolPart, SymbolKind
from roaml.xml_syntax import Element


class Dialect(enum.Enum):
    """The dialect in which a machine is written (docs/spec/files.md#dialects)."""

    CURRENT = "current HL-SCXML"
    OLDER = "older HL-SCXML"
    PLAIN = "plain SCXML"
    FOREIGN = "a format of another tool"


class Data(Record, frozen=True, eq=False):
    """A variable of a machine. `comment_type` means that its type is written in a comment before the element
    (docs/spec/machines.md#type-comment)."""

    element: Element
    id: Name | None
    type: TypeRef | None
    value: Value | None
    lower: Value | None
    upper: Value | None
    comment_type: bool = False


class Declaration(Record, frozen=True, eq=False):
    """A ROS interface or timer that the machine uses.

    Attributes:
        kind: the kind of symbol that it declares: publisher, subscriber, service-client, service-server, action-client,
            action-server or timer.
        handle: the name by which the rest of the file refers to the declaration; without the attribute `name`, the name
            of the interface as written.
        interface: the name of the topic, service or action, or the port that provides it; `None` for timers.
        type: the ROS type; `None` for timers.
        rate: the rate of a timer in Hz, or the port that provides it.
    """

    element: Element
    kind: SymbolKind
    handle: Name | None
    interface: Name | PortRead | None
    type: Name | None
    rate: Name | PortRead | None = None


class Port(Record, frozen=True, eq=False):
    """A port of a behavior tree plugin."""

    element: Element
    key: Name | None
    type: TypeRef | None
    direction: Direction


class Param(Record, frozen=True, eq=False):
    """A `<param>` of an event or a `<field>` of a ROS message."""

    element: Element
    name: Name | None
    value: Value | None


class Assign(Record, frozen=True, eq=False):
    element: Element
    location: Expression | None
    value: Value | None


class Send(Record, frozen=True, eq=False):
    element: Element
    event: Name | None
    params: tuple[Param, ...]


class Branch(Record, frozen=True, eq=False):
    """A branch of an `<if>`. `element` is the `<if>`, `<elseif>` or `<else>`; a valid `<if>` or `<elseif>` has a
    condition."""

    element: Element
    cond: Expression | None
    body: tuple[Statement, ...]


class If(Record, frozen=True, eq=False):
    """An `<if>` with its branches. `otherwise` is the branch of `<else/>`, if there is one."""

    element: Element
    branches: tuple[Branch, ...]
    otherwise: Branch | None

    @property
    def parts(self) -> tuple[Branch, ...]:
        """All branches, with that of `<else/>`."""
        return self.branches if self.otherwise is None else (*self.branches, self.otherwise)


class RosSend(Record, frozen=True, eq=False):
    """An element that sends a part of a ROS interface, such as a message, request, response, goal or result.

    `goal_id` and `thread_id` are `None` if the attribute is missing or the element cannot have it.
    """

    element: Element
    type: ElementType
    handle: Name | None
    fields: tuple[Param, ...]
    goal_id: Expression | None = None
    thread_id: Expression | None = None

    @property
    def part(self) -> ProtocolPart:
        """The part of the interface that is sent."""
        assert self.type.sends is not None
        return self.type.sends


class ReturnStatus(Record, frozen=True, eq=False):
    element: Element
    status: Name | None


class ReturnHalted(Record, frozen=True, eq=False):
    element: Element


class CallChild(Record, frozen=True, eq=False):
    """An element that ticks a child, or halts it if `halts` is true. `child` is the index of the child, or a variable
    that contains it."""

    element: Element
    halts: bool
    child: Name | None


class SetOutput(Record, frozen=True, eq=False):
    element: Element
    key: Name | None
    value: Expression | None


class NoEffect(Record, frozen=True, eq=False):
    """An element that is accepted and has no effect: `<log>`."""

    element: Element


Statement: TypeAlias = Assign | Send | If | RosSend | ReturnStatus | ReturnHalted | CallChild | SetOutput | NoEffect


class Target(Record, frozen=True, eq=False):
    """A target of a transition. `element` is the `<target>`; `None` for a target that an attribute names. `probability`
    is the text of the attribute `prob`; `None` if it is missing."""

    element: Element | None
    state: Name | None
    probability: Name | None
    body: tuple[Statement, ...]


class Handler(Record, frozen=True, eq=False):
    """A transition or a callback that works like one.

    Attributes:
        trigger: what the handler waits for, such as an event, a message or a tick; `None` for an eventless transition.
        event: the event that a `<transition>` names; `None` if there is none.
        handle: the declaration that a ROS callback refers to.
        child: the child index of `bt_child_status` and `bt_child_halted`.
        targets: all `<target>` children; without them, or with the attribute `target`, exactly one target. The handler
            of a goal response has two: for acceptance and for rejection.
        effective: false for elements that are allowed but have no effect, such as `<ros_service_handle_error>`.
    """

    element: Element
    type: ElementType
    trigger: ProtocolPart | None
    event: Name | None
    handle: Name | None
    child: Name | None
    cond: Expression | None
    targets: tuple[Target, ...]
    effective: bool = True

    @property
    def is_probabilistic(self) -> bool:
        return len(self.targets) > 1 and self.trigger is not ProtocolPart.GOAL_RESPONSE


class Body(Record, frozen=True, eq=False):
    """The content of `<onentry>` or `<onexit>`."""

    element: Element
    statements: tuple[Statement, ...]


class State(Record, frozen=True, eq=False):
    element: Element
    id: Name | None
    entry: Body | None
    exit: Body | None
    handlers: tuple[Handler, ...]


class Chart(Record, frozen=True, eq=False, dict=True, weakref=True):
    """The states and data of a machine itself, or those of one action thread.

    `scope` is "" for the machine itself and distinguishes the threads of a file.
    """

    element: Element
    scope: str
    initial: Name | None
    data: tuple[Data, ...]
    states: tuple[State, ...]

    @cached_property
    def statements(self) -> tuple[Statement, ...]:
        """All statements, in the order of the bodies."""
        return tuple(statement for _, _, body in bodies(self) for statement in statements(body))

    @cached_property
    def executed(self) -> tuple[Statement, ...]:
        """The statements that transitions execute. They include the statements of an `<onexit>` if a transition leaves
        its state, and those of an `<onentry>` if its state is initial or the target of a transition, or if a transition
        names a state that does not exist (docs/spec/machines.md#onentry)."""
        return tuple(statement for body in self._executed() for statement in statements(body))

    def _executed(self) -> Iterator[tuple[Statement, ...]]:
        handlers = [handler for state in self.states for handler in state.handlers if handler.effective]
        targets = {target.state.value for handler in handlers for target in handler.targets if target.state}
        entered = {*targets, self.initial.value if self.initial else ""}
        known = {state.id.value for state in self.states if state.id}
        misspelled = not entered <= known
        for state, handler, body in bodies(self):
            if handler is not None:
                runs = handler.effective
            elif state.entry is not None and body is state.entry.statements:
                runs = misspelled or (state.id is not None and state.id.value in entered)
            else:
                runs = any(handler.effective for handler in state.handlers)
            if runs:
                yield body


class Thread(Record, frozen=True, eq=False):
    """An action thread: `count` copies of `chart` (`None` if the number is invalid)."""

    element: Element
    server: Name | None
    count: int | None
    chart: Chart


class Machine(Record, frozen=True, eq=False, dict=True):
    """A state machine document.

    Attributes:
        root: `ascxml` or `scxml`.
        plain: whether the machine uses no element, declaration or type that HL-SCXML adds to SCXML
            (docs/spec/machines.md#plain-machines).
    """

    element: Element
    root: str
    name: Name | None
    chart: Chart
    declarations: tuple[Declaration, ...]
    ports: tuple[Port, ...]
    threads: tuple[Thread, ...]
    plain: bool

    @property
    def charts(self) -> tuple[Chart, ...]:
        return (self.chart, *(thread.chart for thread in self.threads))

    @cached_property
    def declarations_by_handle(self) -> Mapping[str, Sequence[Declaration]]:
        declarations: dict[str, list[Declaration]] = {}
        for declaration in self.declarations:
            if declaration.handle:
                declarations.setdefault(declaration.handle.value, []).append(declaration)
        return declarations


# ----------------------------------------------------------------- walking


def values_of(statement: Statement) -> Iterator[Expression]:
    """The expressions whose values a statement assigns, sends or writes to the blackboard, without those inside an
    `<if>` and those with syntax errors."""
    values: list[Value | None] = []
    match statement:
        case Assign(value=value) | SetOutput(value=value):
            values = [value]
        case Send(params=params) | RosSend(fields=params):
            values = [param.value for param in params]
    yield from (value for value in values if isinstance(value, Expression) and not value.broken)


def bodies(chart: Chart) -> Iterator[tuple[State, Handler | None, tuple[Statement, ...]]]:
    """Every body of the chart, with its state and its handler. The handler is `None` for `<onentry>` and `<onexit>`."""
    for state in chart.states:
        for body in (state.entry, state.exit):
            if body is not None:
                yield state, None, body.statements
        for handler in state.handlers:
            for target in handler.targets:
                yield state, handler, target.body


def statements(body: tuple[Statement, ...]) -> Iterator[Statement]:
    """All statements of a body, including those inside `<if>`, in document order."""
    for statement in body:
        yield statement
        if isinstance(statement, If):
            for branch in statement.parts:
                yield from statements(branch.body)
