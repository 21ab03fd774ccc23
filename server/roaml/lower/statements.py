# SPDX-License-Identifier: Apache-2.0
"""Executable content of HL-SCXML -> plain statements (spec/04 §2)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from roaml.expr.tree import Expr
from roaml.expr.types import BASE_TYPES, Struct, leaves, unwrap
from roaml.lower.build import default_value, equal, event_data, integer, name
from roaml.lower.context import Context
from roaml.lower.expressions import SEPARATOR, Scope, access_of, lower_expr, lower_leaves
from roaml.lower.interfaces import ActionEvents, ServiceEvents, topic_event
from roaml.model import machine as hl
from roaml.model.expand import Reference
from roaml.model.globals import FIELD_PREFIX
from roaml.model.machine import CallChild, Communicate, NoEffect, ReturnHalted, ReturnStatus, SetOutput
from roaml.model.syntax import Expression, Name, PortRead, Value
from roaml.model.typing import STATUSES, uses_random
from roaml.scxml.model import Assign, Body, Branch, Data, If, Param, Send, Statement
from roaml.text import Location

REAL = BASE_TYPES["float64"]


@dataclass(eq=False)
class StatementLowering:
    """Lowers the bodies of one automaton. `drawn` are variables for random numbers that are sent, made on the way."""

    context: Context
    drawn: list[Data] = field(default_factory=list)

    def body(self, statements: Iterable[hl.Statement], scope: Scope) -> Body:
        return tuple(plain for statement in statements for plain in self.statement(statement, scope))

    def statement(self, statement: hl.Statement, scope: Scope) -> Iterator[Statement]:
        origin = self.context.origin(statement.element.span)
        match statement:
            case hl.Assign():
                yield from self.assign(statement, scope, origin)
            case hl.If():
                yield self.choice(statement, scope, origin)
            case hl.Send():
                assert statement.event is not None
                params = [p for param in statement.params for p in self.params(param, "", scope)]
                yield from self.send(statement.event.value, params, origin)
            case Communicate():
                yield from self.communicate(statement, scope, origin)
            case ReturnStatus():
                yield Send(f"bt_{self.number}_response", (self.status(statement, scope, origin),), origin)
            case ReturnHalted():
                yield Send(f"bt_{self.number}_halt_response", (), origin)
            case CallChild():
                yield from self.call_child(statement, origin)
            case SetOutput():
                yield from self.set_output(statement, scope, origin)
            case NoEffect():
                return

    @property
    def number(self) -> int:
        instance = self.context.automaton.instance
        assert instance is not None
        return instance.number

    # ------------------------------------------------------------- assignments

    def assign(self, statement: hl.Assign, scope: Scope, origin: Location) -> Iterator[Statement]:
        assert statement.location is not None
        target = access_of(statement.location.tree, scope)
        assert target is not None
        struct = unwrap(target.type)[0]
        if target.length and isinstance(struct, Struct):
            for path, _ in leaves(struct):
                yield Assign(target.leaf(path), self.value(statement.value, scope), origin)
            return
        values = self.values(statement.value, scope)
        for path, value in values:
            yield Assign(target.leaf(path), value, origin)

    def values(self, value: Value | None, scope: Scope) -> list[tuple[tuple[str, ...], Expr]]:
        if isinstance(value, Expression):
            return lower_leaves(value.tree, scope)
        return [((), self.value(value, scope))]

    def value(self, value: Value | None, scope: Scope) -> Expr:
        """A value that is no struct. A port that is bound to the blackboard is read from the blackboard's answer."""
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

    def choice(self, statement: hl.If, scope: Scope, origin: Location) -> If:
        branches = tuple(self.branch(branch, scope) for branch in statement.branches)
        otherwise = self.body(statement.otherwise.body, scope) if statement.otherwise else ()
        return If(branches, otherwise, origin)

    def branch(self, branch: hl.Branch, scope: Scope) -> Branch:
        assert branch.cond is not None
        cond = lower_expr(branch.cond.tree, scope)
        return Branch(cond, self.body(branch.body, scope), self.context.origin(branch.element.span))

    # ----------------------------------------------------------------- sending

    def params(self, param: hl.Param, prefix: str, scope: Scope) -> Iterator[Param]:
        assert param.name is not None
        origin = self.context.origin(param.element.span)
        identifier = prefix + param.name.value.replace(".", SEPARATOR)
        for path, value in self.values(param.value, scope):
            yield Param(SEPARATOR.join((identifier, *path)), value, origin)

    def send(self, event: str, params: Iterable[Param], origin: Location) -> Iterator[Statement]:
        """Random numbers are drawn before the event can be received (spec/07 1.13)."""
        ready = []
        for param in params:
            value = param.value
            if uses_random(value):
                drawn = Data(self._fresh_name(), REAL, default_value(REAL), param.origin)
                self.drawn.append(drawn)
                yield Assign(name(drawn.id), value, param.origin)
                value = name(drawn.id)
            ready.append(Param(param.name, value, param.origin))
        yield Send(event, tuple(ready), origin)

    def _fresh_name(self) -> str:
        taken = {*self.context.variables, *(data.id for data in self.drawn)}
        count = len(self.drawn)
        while (found := f"random_{count}") in taken:
            count += 1
        return found

    def communicate(self, statement: Communicate, scope: Scope, origin: Location) -> Iterator[Statement]:
        fields = [p for each in statement.fields for p in self.params(each, FIELD_PREFIX, scope)]
        extra = self.arguments(statement, scope, origin)
        yield from self.send(self.event(statement), (*fields, *extra), origin)

    def arguments(self, statement: Communicate, scope: Scope, origin: Location) -> Iterator[Param]:
        """What is sent besides the fields (spec/04 §2)."""
        for parameter, value in (("goal_id", statement.goal_id), ("thread_id", statement.thread_id)):
            if value is not None:
                yield Param(parameter, lower_expr(value.tree, scope), origin)
        if statement.type.code:
            yield Param("code", integer(statement.type.code), origin)
        if statement.type.sends == "thread-free":
            assert self.context.thread is not None
            yield Param("thread_id", integer(self.context.thread), origin)

    def event(self, statement: Communicate) -> str:
        channel, part = self.context.channel(statement), statement.type.sends
        service, action = ServiceEvents(channel.name), ActionEvents(channel.name)
        match part:
            case "message":
                return topic_event(channel.name)
            case "request":
                return service.request_of(self.context.automaton)
            case "response":
                return service.response
            case "goal":
                return action.goal_of(self.context.automaton)
            case "goal-accepted":
                return action.accepted
            case "goal-rejected":
                return action.rejected
            case "feedback":
                return action.feedback
            case "result":
                return action.result
            case "thread-start":
                return action.thread_start
            case "thread-free":
                return action.thread_free
        raise AssertionError(f"unknown part {part}")

    # ------------------------------------------------------------------- trees

    def status(self, statement: ReturnStatus, scope: Scope, origin: Location) -> Param:
        assert statement.status is not None
        word = statement.status.value
        value = integer(STATUSES[word]) if word in STATUSES else name(word, statement.status.span)
        return Param("status", value, origin)

    def call_child(self, statement: CallChild, origin: Location) -> Iterator[Statement]:
        """A child known by a variable is found by comparing with every index (spec/01 §11.2)."""
        assert statement.child is not None
        children = self.children
        verb = "halt" if statement.halts else "tick"
        if (index := literal_index(statement.child)) is not None:
            yield Send(f"bt_{children[index]}_{verb}", (), origin)
        elif children:
            variable = name(statement.child.value, statement.child.span)
            yield If(
                tuple(
                    Branch(equal(variable, integer(i)), (Send(f"bt_{child}_{verb}", (), origin),), origin)
                    for i, child in enumerate(children)
                ),
                (),
                origin,
            )

    @property
    def children(self) -> tuple[int, ...]:
        """The numbers of the node's children."""
        instance = self.context.automaton.instance
        assert instance is not None
        return instance.children

    def set_output(self, statement: SetOutput, scope: Scope, origin: Location) -> Iterator[Statement]:
        assert statement.key is not None
        assert statement.value is not None
        held = self.context.port(PortRead(statement.key, statement.element.span))
        assert isinstance(held, Reference)
        value = Param("value", lower_expr(statement.value.tree, scope), origin)
        yield from self.send(f"bt_blackboard_set_{held.variable}", (value,), origin)


def literal_index(child: Name) -> int | None:
    """The index of a child that is given as a number."""
    return int(child.value) if child.value.isascii() and child.value.isdigit() else None
