# SPDX-License-Identifier: Apache-2.0
"""Translates executable content of HL-SCXML to statements of plain SCXML (docs/spec/plain-scxml.md#events)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from heapq import heappop, heappush
from typing import TypeAlias

from roaml.exhaustive import assert_never
from roaml.expr.infer import infer
from roaml.expr.transform import map_children
from roaml.expr.tree import Expr, Index, Member, is_draw, walk
from roaml.expr.tree import Name as VariableName
from roaml.expr.types import BASE_TYPES, UNKNOWN, Scalar, ScalarKind, Struct, Type, leaves, unwrap
from roaml.expr.zero import zero
from roaml.lower.blackboard_events import blackboard_write
from roaml.lower.build import equal, event_data, integer, name, random_number
from roaml.lower.context import LoweringContext
from roaml.lower.executed_goals import ExecutedGoals
from roaml.lower.expressions import SEPARATOR, LoweringScope, access_of, lower_expr, lower_leaves
from roaml.lower.interfaces import ActionEvents, ServiceEvents, parameter, topic_event, tree_event
from roaml.model import machine as hl
from roaml.model.expand import Reference
from roaml.model.machine import CallChild, NoEffect, ReturnHalted, ReturnStatus, RosSend, SetOutput
from roaml.model.syntax import Expression, Name, PortRead, Value
from roaml.model.value_types import leaf_fields, unset_fields
from roaml.record import Record, field, replace
from roaml.roles import ProtocolPart
from roaml.scxml.events import ScxmlEvent
from roaml.scxml.model import Assign, Body, Branch, Data, If, Param, Send, Statement
from roaml.scxml.names import FIELD_PREFIX, STATUSES, TreeEventKind, named
from roaml.text import Location

INT, REAL = BASE_TYPES["int32"], BASE_TYPES["float64"]
_NAMED = {ScalarKind.INT: BASE_TYPES["int64"], ScalarKind.REAL: REAL}
"""Kind of a value whose type has no name -> the type of a variable for it."""

MAX_COMBINATIONS = 10_000
"""The maximum number of combinations of random numbers that one assignment draws at once. It is limited because each
combination is a destination in JANI."""


def combinations(value: Expr, random_values: int) -> int | None:
    """The number of combinations of the random numbers in an assignment of `value` if they are drawn at once; `None` if
    they are drawn one after the other, because there are too many."""
    count: int = random_values ** sum(map(is_draw, walk(value)))
    return count if count <= MAX_COMBINATIONS else None


TypedParam: TypeAlias = tuple[Param, Type]


class StatementLowering(Record, eq=False):
    """Lowers the bodies of one automaton. Variables for random numbers are added to `drawn`."""

    context: LoweringContext
    goals: ExecutedGoals
    drawn: list[Data] = field(default_factory=list)

    def body(self, statements: Iterable[hl.Statement], scope: LoweringScope) -> Body:
        return tuple(plain for statement in statements for plain in self.statement(statement, scope))

    def statement(self, statement: hl.Statement, scope: LoweringScope) -> Iterator[Statement]:
        origin = self.context.origin(statement.element.span)
        match statement:
            case hl.Assign():
                yield from self.assign(statement, scope, origin)
            case hl.If():
                yield self.choice(statement, scope, origin)
            case hl.Send():
                assert statement.event is not None
                sent = [p for param in statement.params for p in self.params(param, "", scope)]
                yield from self.send(named(statement.event.value), sent, origin)
            case RosSend():
                yield from self.communicate(statement, scope, origin)
            case ReturnStatus():
                yield Send(
                    tree_event(self.address, TreeEventKind.RESPONSE), (self.status(statement, scope, origin),), origin
                )
            case ReturnHalted():
                yield Send(tree_event(self.address, TreeEventKind.HALT_RESPONSE), (), origin)
            case CallChild():
                yield from self.call_child(statement, origin)
            case SetOutput():
                yield from self.set_output(statement, scope, origin)
            case NoEffect():
                return

    @property
    def address(self) -> str:
        """The address of the node in events of the tree."""
        instance = self.context.automaton.instance
        assert instance is not None
        return self.context.program.address(instance.number)

    # ------------------------------------------------------------- assignments

    def assign(self, statement: hl.Assign, scope: LoweringScope, origin: Location) -> Iterator[Statement]:
        assert statement.location is not None
        target = access_of(statement.location.tree, scope)
        assert target is not None
        struct = unwrap(target.type)[0]
        if target.length and isinstance(struct, Struct):
            values = [(path, self.value(statement.value, scope)) for path, _ in leaves(struct)]
        else:
            values = self.values(statement.value, scope, target.type)
        types = dict(leaves(target.type))
        writes = [_Write(target.leaf(path), value, types.get(path, UNKNOWN)) for path, value in values]
        ordered, rest = _in_order(writes)
        for write in ordered:
            yield from self.store(write.location, write.value, origin)
        yield from self.stored_at_once(rest, INT if target.length else None, origin)

    def stored_at_once(self, writes: Iterable[_Write], type_: Type | None, origin: Location) -> Iterator[Statement]:
        """The statements for assignments of which each changes what another one reads: the indices and values are
        stored in variables first, which are reset afterwards.

        Args:
            type_: the type of the values, if it is not that of the leaves.
        """
        kept: list[Data] = []

        def keep(value: Expr, type_: Type) -> Iterator[Statement]:
            kept.append(self.fresh(type_, origin))
            yield from self.store(name(kept[-1].id), value, origin)

        last: list[Statement] = []
        for write in writes:
            location = write.location
            indices: list[Expr] = []
            for index in _indices(location):
                yield from keep(index, INT)
                indices.append(name(kept[-1].id))
            yield from keep(write.value, type_ or write.type)
            last.append(Assign(_with_indices(location, indices), name(kept[-1].id), origin))
        yield from last
        yield from (Assign(name(data.id), data.value, origin) for data in kept)

    def store(self, location: Expr, value: Expr, origin: Location) -> Iterator[Statement]:
        """The statements for an assignment. If it contains too many random numbers, they are drawn one after the other
        into variables, which are reset afterwards."""
        if combinations(value, self.context.program.parameters.random_values) is not None:
            yield Assign(location, value, origin)
            return
        drawn: list[Data] = []

        def draw(expr: Expr) -> Expr:
            if not is_draw(expr):
                return map_children(expr, draw)
            drawn.append(self.fresh(REAL, origin))
            return name(drawn[-1].id)

        used = draw(value)
        yield from (Assign(name(data.id), random_number(), origin) for data in drawn)
        yield Assign(location, used, origin)
        yield from (Assign(name(data.id), data.value, origin) for data in drawn)

    def values(self, value: Value | None, scope: LoweringScope, type_: Type) -> list[tuple[tuple[str, ...], Expr]]:
        if isinstance(value, Expression):
            return lower_leaves(value.tree, scope, type_)
        return [((), self.value(value, scope))]

    def value(self, value: Value | None, scope: LoweringScope) -> Expr:
        """The plain expression for a value that is not a struct. The value of a port that is bound to the blackboard is
        read from the answer of the blackboard."""
        match value:
            case Expression():
                return lower_expr(value.tree, scope)
            case PortRead():
                held = self.context.port(value)
                if isinstance(held, Reference):
                    return event_data(held.variable, value.span)
                return lower_expr(self.context.constant(value, held), scope)
            case None:
                raise AssertionError("a rule reports a missing value")

    # ----------------------------------------------------------------- choices

    def choice(self, statement: hl.If, scope: LoweringScope, origin: Location) -> If:
        branches = tuple(self.branch(branch, scope) for branch in statement.branches)
        otherwise = self.body(statement.otherwise.body, scope) if statement.otherwise else ()
        return If(branches, otherwise, origin)

    def branch(self, branch: hl.Branch, scope: LoweringScope) -> Branch:
        assert branch.cond is not None
        cond = lower_expr(branch.cond.tree, scope)
        return Branch(cond, self.body(branch.body, scope), self.context.origin(branch.element.span))

    # ----------------------------------------------------------------- sending

    def params(self, param: hl.Param, prefix: str, scope: LoweringScope) -> Iterator[TypedParam]:
        assert param.name is not None
        origin = self.context.origin(param.element.span)
        identifier = prefix + param.name.value.replace(".", SEPARATOR)
        type_ = self.type(param.value, scope)
        types = dict(leaves(type_))
        for path, value in self.values(param.value, scope, type_):
            yield Param(SEPARATOR.join((identifier, *path)), value, origin), types.get(path, UNKNOWN)

    def type(self, value: Value | None, scope: LoweringScope) -> Type:
        if not isinstance(value, Expression):
            return UNKNOWN
        known = {**scope.variables, **scope.event}
        return infer(value.tree, known.get)[0]

    def send(self, event: ScxmlEvent, params: Iterable[TypedParam], origin: Location) -> Iterator[Statement]:
        """The statements that send an event. Random numbers are drawn and stored before the event is sent
        (docs/spec/plain-scxml.md#random-draws)."""
        ready = []
        for param, type_ in params:
            value = param.value
            if any(map(is_draw, walk(value))):
                drawn = self.fresh(type_, param.origin)
                yield from self.store(name(drawn.id), value, param.origin)
                value = name(drawn.id)
            ready.append(replace(param, value=value))
        yield Send(event, tuple(ready), origin)

    def fresh(self, type_: Type, origin: Location) -> Data:
        """Add a variable for an intermediate value to the automaton, and return it."""
        taken = {*self.context.variables, *(data.id for data in self.drawn)}
        count = len(self.drawn)
        while (unused := f"random_{count}") in taken:
            count += 1
        named = _NAMED.get(type_.kind, type_) if isinstance(type_, Scalar) and not type_.name else type_
        self.drawn.append(Data(unused, named, zero(named), origin))
        return self.drawn[-1]

    def communicate(self, statement: RosSend, scope: LoweringScope, origin: Location) -> Iterator[Statement]:
        machine, environment = self.context.machine, self.context.program.environment
        fields = [p for sent in statement.fields for p in self.params(sent, FIELD_PREFIX, scope)]
        for path, type_ in unset_fields(statement, machine, environment):
            fields.append((Param(parameter(path.split(".")), zero(type_), origin), type_))
        known = leaf_fields(statement, machine, environment)
        declared = {parameter(path.split(".")): type_ for path, type_ in known.items()}
        fields = [(replace(param, declared=declared.get(param.name)), type_) for param, type_ in fields]
        goal_id = lower_expr(statement.goal_id.tree, scope) if statement.goal_id else None
        yield from self.goals.sent(self.context.channel(statement), statement.part, goal_id, origin)
        extra = ((param, INT) for param in self.arguments(statement, scope, origin))
        yield from self.send(self.event(statement), (*fields, *extra), origin)

    def arguments(self, statement: RosSend, scope: LoweringScope, origin: Location) -> Iterator[Param]:
        """The parameters that are sent in addition to the fields (docs/spec/plain-scxml.md#events)."""
        for argument, value in (("goal_id", statement.goal_id), ("thread_id", statement.thread_id)):
            if value is not None:
                yield Param(argument, lower_expr(value.tree, scope), origin)
        if statement.type.code:
            yield Param("code", integer(statement.type.code), origin)
        if statement.part is ProtocolPart.CANCEL:
            yield Param("goal_id", integer(self.goal_id_of_client(statement)), origin)
        if statement.part is ProtocolPart.THREAD_FREE:
            assert self.context.thread is not None
            yield Param("thread_id", integer(self.context.thread), origin)

    def goal_id_of_client(self, statement: RosSend) -> int:
        """The id that all goals of this client have (docs/spec/ros.md#goal-ids)."""
        users = self.context.channel(statement).users
        return next(number for number, user in enumerate(users) if user.automaton is self.context.automaton)

    def event(self, statement: RosSend) -> ScxmlEvent:
        channel, part = self.context.channel(statement), statement.part
        service, action = ServiceEvents(channel.name), ActionEvents(channel.name)
        match part:
            case ProtocolPart.MESSAGE:
                return topic_event(channel.name)
            case ProtocolPart.REQUEST:
                return service.request_of(self.context.automaton)
            case ProtocolPart.RESPONSE:
                return service.response
            case ProtocolPart.GOAL:
                return action.goal_of(self.context.automaton)
            case ProtocolPart.CANCEL:
                return action.cancel
            case ProtocolPart.GOAL_ACCEPTED:
                return action.accepted
            case ProtocolPart.GOAL_REJECTED:
                return action.rejected
            case ProtocolPart.FEEDBACK:
                return action.feedback
            case ProtocolPart.RESULT:
                return action.result
            case ProtocolPart.THREAD_START:
                return action.thread_start
            case ProtocolPart.THREAD_FREE:
                return action.thread_free
            case (
                ProtocolPart.BLACKBOARD
                | ProtocolPart.BT_HALT
                | ProtocolPart.BT_HALTED
                | ProtocolPart.BT_STATUS
                | ProtocolPart.BT_TICK
                | ProtocolPart.CHILD_HALT
                | ProtocolPart.CHILD_HALTED
                | ProtocolPart.CHILD_STATUS
                | ProtocolPart.CHILD_TICK
                | ProtocolPart.EVENT
                | ProtocolPart.GOAL_RESPONSE
                | ProtocolPart.TICK
                | ProtocolPart.START
            ):
                raise AssertionError(f"not sent on a channel: {part}")
            case _:
                return assert_never(part)

    # ------------------------------------------------------------------- trees

    def status(self, statement: ReturnStatus, scope: LoweringScope, origin: Location) -> Param:
        assert statement.status is not None
        word = statement.status.value
        value = integer(STATUSES[word]) if word in STATUSES else name(word, statement.status.span)
        return Param("status", value, origin)

    def call_child(self, statement: CallChild, origin: Location) -> Iterator[Statement]:
        """The statements that tick or halt a child. A variable index is compared with every index
        (docs/spec/plugins.md#children).

        The origin of the sent event is the node of the child in the tree.
        """
        assert statement.child is not None
        children = self.children
        verb = TreeEventKind.HALT if statement.halts else TreeEventKind.TICK
        calls = [Send(tree_event(child, verb), (), self.context.program.node(child)) for child in children]
        if (index := literal_index(statement.child)) is not None:
            yield calls[index]
        elif children:
            variable = name(statement.child.value, statement.child.span)
            yield If(
                tuple(Branch(equal(variable, integer(i)), (call,), origin) for i, call in enumerate(calls)),
                (),
                origin,
            )

    @property
    def children(self) -> tuple[int, ...]:
        """The numbers of the node's children."""
        instance = self.context.automaton.instance
        assert instance is not None
        return instance.children

    def set_output(self, statement: SetOutput, scope: LoweringScope, origin: Location) -> Iterator[Statement]:
        assert statement.key is not None
        assert statement.value is not None
        held = self.context.port(PortRead(statement.key, statement.element.span))
        assert isinstance(held, Reference)
        value = Param("value", lower_expr(statement.value.tree, scope), origin)
        type_ = self.type(statement.value, scope)
        yield from self.send(blackboard_write(held.variable), ((value, type_),), origin)


def literal_index(child: Name) -> int | None:
    """The index of a child if it is a number; `None` if it is a variable."""
    return int(child.value) if child.value.isascii() and child.value.isdigit() else None


class _Write(Record, frozen=True):
    """An assignment to a leaf of a struct, with the type of the leaf."""

    location: Expr
    value: Expr
    type: Type

    @property
    def variable(self) -> str:
        location = self.location
        while isinstance(location, Member | Index):
            location = location.object
        assert isinstance(location, VariableName)
        return location.name

    @property
    def reads(self) -> frozenset[str]:
        """The variables on which the value and the indices of the location depend."""
        parts = (self.value, *_indices(self.location))
        return frozenset(node.name for part in parts for node in walk(part) if isinstance(node, VariableName))


def _in_order(writes: Sequence[_Write]) -> tuple[list[_Write], list[_Write]]:
    """Assignments in an order in which none of them changes what a later one reads, such as the length of the array in
    `v[v.length]`, which is that of the first leaf; and those for which there is no such order."""
    own = {write.variable: number for number, write in enumerate(writes)}
    read = [{own[name] for name in write.reads if name in own} - {number} for number, write in enumerate(writes)]
    readers = Counter(number for numbers in read for number in numbers)
    free = [number for number in range(len(writes)) if not readers[number]]
    ordered: list[int] = []
    while free:
        ordered.append(heappop(free))
        for number in read[ordered[-1]]:
            readers[number] -= 1
            if not readers[number]:
                heappush(free, number)
    taken = set(ordered)
    return [writes[number] for number in ordered], [w for number, w in enumerate(writes) if number not in taken]


def _indices(location: Expr) -> list[Expr]:
    """The indices of a location, the outermost first."""
    indices: list[Expr] = []
    while isinstance(location, Member | Index):
        if isinstance(location, Index):
            indices.append(location.index)
        location = location.object
    return indices[::-1]


def _with_indices(location: Expr, indices: Sequence[Expr]) -> Expr:
    """A location with other indices, the outermost first."""
    match location:
        case Index():
            return replace(location, object=_with_indices(location.object, indices[:-1]), index=indices[-1])
        case Member():
            return replace(location, object=_with_indices(location.object, indices))
        case _:
            return location
