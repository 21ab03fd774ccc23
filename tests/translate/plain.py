# SPDX-License-Identifier: Apache-2.0
"""An interpreter of plain SCXML networks, written from docs/spec/jani.md and independent of the translation.

A machine is between two states while statements of its current move remain (`Machine.rest`); a step executes one of
them that others can notice - a send, the choice of a branch, the end of an `if` - and the assignments after it.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from reach import reachable

from roaml.expr import tree as expr
from roaml.scxml.events import Role
from roaml.scxml.model import Assign, Automaton, If, Network, Send, Statement, Transition

CLOCK_STEP = "global_timer_tick_event"
TIMER = "ros_time_rate."
SYNCHRONISING = re.compile(
    r"^(bt_[0-9]+_(tick|halt|response|halt_response)$|action_.+_goal_.+$|action_.+_result.*$"
    r"|action_.+_thread_(start|free)$|srv_.+_(response|request|req_client).*$|global_timer_tick_event$)"
)

END = "end of if"
Rest = tuple["Statement | str", ...]


@dataclass(frozen=True)
class Machine:
    """`state`: where it is or, while something remains to be done, where it goes. `event`: whose data it sees."""

    state: str
    data: tuple[tuple[str, Any], ...]
    rest: Rest = ()
    event: str = ""


@dataclass(frozen=True)
class Moment:
    """`pending` are the sent events that nobody has received yet; `sent` the last data of every event ever sent."""

    machines: tuple[Machine, ...]
    pending: frozenset[str]
    sent: tuple[tuple[str, tuple[tuple[str, Any], ...]], ...]


class Interpreter:
    def __init__(self, network: Network) -> None:
        self.automata = network.automata
        self.handled = [{awaited(t) for s in a.states for t in s.transitions} - {""} for a in self.automata]
        self.senders = {s.event.name for a in self.automata for s in _sends(a)}
        self.states = [{s.id: s for s in a.states} for a in self.automata]
        self.spontaneous = [{s.id for s in a.states if any(not t.event for t in s.transitions)} for a in self.automata]

    def initial(self) -> Moment:
        machines = []
        for automaton in self.automata:
            data = {d.id: value(d.value, {}, {}) for d in automaton.data}
            entry = next(s.entry for s in automaton.states if s.id == automaton.initial)
            # The first step out of the start is one of its own, even if only assignments follow.
            machines.append(Machine(automaton.initial, _frozen(data), ((END, *entry) if entry else ())))
        return Moment(tuple(machines), frozenset(), ())

    def reachable(self, limit: int) -> set[Moment]:
        return reachable(self.initial(), self.successors, limit)

    # -------------------------------------------------------------------- steps

    def successors(self, now: Moment) -> Iterator[Moment]:
        for i, machine in enumerate(now.machines):
            if machine.rest:
                yield from self.proceed(now, i)
            elif machine.state in self.spontaneous[i]:
                yield from self.take(now, [i], "")
        for event in sorted(now.pending):
            listeners = [i for i, handled in enumerate(self.handled) if event in handled]
            yield from self.take(replace(now, pending=now.pending - {event}), listeners, event)
        calm = not [e for e in now.pending if e != "bt_blackboard_req"]
        for i, automaton in enumerate(self.automata):
            if automaton.role is Role.CLOCK and not now.machines[i].rest and calm:
                yield from self.take(now, [i], CLOCK_STEP)

    def proceed(self, now: Moment, i: int) -> Iterator[Moment]:
        """Execute the next noticeable statement of machine `i`."""
        machine = now.machines[i]
        first, rest = machine.rest[0], machine.rest[1:]
        data, sent = dict(machine.data), dict(now.sent)
        if isinstance(first, If):
            body = first.otherwise
            for branch in first.branches:
                if value(branch.cond, data, dict(sent.get(machine.event, ()))):
                    body = branch.body
                    break
            yield from self.settle(now, i, replace(machine, rest=(*body, END, *rest)))
        elif isinstance(first, Send):
            yield from self.send(now, i, first, replace(machine, rest=rest))
        else:
            yield from self.settle(now, i, replace(machine, rest=rest))

    def send(self, now: Moment, i: int, statement: Send, after: Machine) -> Iterator[Moment]:
        data, sent = dict(after.data), dict(now.sent)
        event = statement.event.name
        if event == CLOCK_STEP:
            yield from self.settle(now, i, after)
            return
        listeners = [k for k, handled in enumerate(self.handled) if event in handled]
        if event.startswith(TIMER):
            if not now.pending:
                for settled in self.settle(now, i, after):
                    yield from self.take(settled, listeners, event)
            return
        if event in now.pending:
            return
        if event == "bt_blackboard_req" and any(e.startswith("bt_blackboard_set_") for e in now.pending):
            return
        current = dict(sent.get(after.event, ()))
        params = {p.name: value(p.value, data, current) for p in statement.params}
        sent[event] = _frozen({**dict(sent.get(event, ())), **params})
        pending = now.pending | {event} if listeners else now.pending
        yield from self.settle(Moment(now.machines, pending, _frozen(sent)), i, after)

    def take(self, now: Moment, who: list[int], event: str) -> Iterator[Moment]:
        """All of `who` react to `event` at once ("" for none), if all of them can."""
        choices = []
        for i in who:
            machine = now.machines[i]
            if machine.rest:
                return
            choices.append(list(self.reactions(now, i, event)))
        for machines in itertools.product(*choices):
            after = now
            # Data are private, so the order in which the machines' assignments happen does not matter.
            for i, machine in zip(who, machines, strict=True):
                (after,) = self.settle(after, i, machine)
            yield after

    def reactions(self, now: Moment, i: int, event: str) -> Iterator[Machine]:
        automaton, machine = self.automata[i], now.machines[i]
        state = self.states[i][machine.state]
        data, params = dict(machine.data), dict(dict(now.sent).get(event, ()))
        own = [t for t in state.transitions if awaited(t) == event]
        for transition in own:
            if transition.cond is None or value(transition.cond, data, params):
                yield from self.targets(i, machine, transition, event)
                return
        if not event or automaton.role in (Role.TREE_ROOT, Role.HANDLER):
            return
        stuck = any(t.event is None and t.cond is None for t in state.transitions)
        if not stuck and (own or not SYNCHRONISING.match(event)):
            yield machine

    def targets(self, i: int, machine: Machine, transition: Transition, event: str) -> Iterator[Machine]:
        states = self.states[i]
        for target in transition.targets:
            body = (*states[machine.state].exit, *target.body, *states[target.state].entry)
            yield Machine(target.state, machine.data, body, event)

    def settle(self, now: Moment, i: int, machine: Machine) -> Iterator[Moment]:
        """Machine `i` becomes `machine` and executes the assignments at its beginning."""
        data, params = dict(machine.data), dict(dict(now.sent).get(machine.event, ()))
        rest = machine.rest
        while rest and isinstance(rest[0], Assign):
            _store(rest[0].location, value(rest[0].value, data, params), data, params)
            rest = rest[1:]
        event = machine.event if rest else ""
        machines = list(now.machines)
        machines[i] = Machine(machine.state, _frozen(data), rest, event)
        yield replace(now, machines=tuple(machines))


def awaited(transition: Transition) -> str:
    """The name of the event; "" for none."""
    return transition.event.name if transition.event else ""


def _sends(automaton: Automaton) -> Iterator[Send]:
    stack: list[Statement] = []
    for state in automaton.states:
        stack += [*state.entry, *state.exit, *(s for t in state.transitions for g in t.targets for s in g.body)]
    while stack:
        statement = stack.pop()
        if isinstance(statement, Send):
            yield statement
        elif isinstance(statement, If):
            stack += [*statement.otherwise, *(s for b in statement.branches for s in b.body)]


def _frozen(data: dict[str, Any]) -> tuple[tuple[str, Any], ...]:
    return tuple(sorted(data.items()))


# ---------------------------------------------------------------------- values


def value(node: expr.Expr, data: dict[str, Any], params: dict[str, Any]) -> Any:
    """Arrays and strings are tuples of what is in them, without what is beyond their length."""
    match node:
        case expr.Number():
            return node.value
        case expr.Boolean():
            return node.value
        case expr.String():
            return tuple(node.value.encode())
        case expr.ArrayLiteral():
            return tuple(value(element, data, params) for element in node.elements)
        case expr.Name():
            return data[node.name]
        case expr.Member(object=expr.Member(object=expr.Name(name="_event"), name="data")):
            return params[node.name]
        case expr.Member(name="length"):
            return len(value(node.object, data, params))
        case expr.Index():
            return value(node.object, data, params)[value(node.index, data, params)]
        case expr.Unary():
            operand = value(node.operand, data, params)
            return {"-": lambda: -operand, "+": lambda: operand, "!": lambda: not operand}[node.operator.symbol]()
        case expr.Conditional():
            return value(node.then if value(node.test, data, params) else node.otherwise, data, params)
        case expr.Binary(operator=operator) if operator.symbol in ("&&", "||"):
            left = value(node.left, data, params)
            return value(node.right, data, params) if left == (operator.symbol == "&&") else left
        case expr.Binary():
            left, right = value(node.left, data, params), value(node.right, data, params)
            return _OPERATORS[node.operator.symbol](left, right)
        case expr.Call(function=expr.Member()):
            return _FUNCTIONS[node.function.name](*(value(argument, data, params) for argument in node.arguments))
    raise NotImplementedError(node)


_OPERATORS = {
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "%": lambda a, b: a % b,
    "/": lambda a, b: a / b,
}
_FUNCTIONS = {"abs": abs, "min": min, "max": max, "floor": lambda x: int(x // 1), "ceil": lambda x: int(-(-x // 1))}


def _store(location: expr.Expr, new: Any, data: dict[str, Any], params: dict[str, Any]) -> None:
    match location:
        case expr.Name():
            data[location.name] = new
        case expr.Index(object=expr.Name()):
            old, k = data[location.object.name], value(location.index, data, params)
            data[location.object.name] = (*old[:k], *(0,) * (k - len(old)), new, *old[k + 1 :])
        case expr.Member(name="length", object=expr.Name()):
            old = data[location.object.name]
            data[location.object.name] = (*old[:new], *(0,) * (new - len(old)))
        case _:
            raise NotImplementedError(location)
