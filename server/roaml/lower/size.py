# SPDX-License-Identifier: Apache-2.0
"""Computes the size of the translation of a system without translating it.

- The size is also computed for systems with errors; unknown parts have the size 0.
- The computation follows `roaml.lower` and `roaml.to_jani` where they multiply parts: a machine by the nodes of the
  tree and by its threads, a handler by the children that it listens to, a branch by the earlier branches, an array by
  its bounds, and a random number by its values. Tests compare the result with the size of translations.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.infer import infer
from roaml.expr.operators import OperatorKind
from roaml.expr.tree import ArrayLiteral, Binary, Expr, Name, ObjectLiteral, String, is_draw, walk
from roaml.expr.types import BASE_TYPES, UNKNOWN, Array, ScalarKind, Type, is_kind, resolve_type, unwrap
from roaml.interruption import checkpoint
from roaml.lower.interfaces import fields
from roaml.lower.nodes import builtin_machine
from roaml.lower.program import TranslatableSystem
from roaml.lower.statements import combinations
from roaml.model.globals import GlobalVariable
from roaml.model.machine import (
    Assign,
    CallChild,
    Chart,
    Handler,
    If,
    Machine,
    Param,
    RosSend,
    Send,
    SetOutput,
    State,
    Statement,
    statements,
)
from roaml.model.size import Share, Size, cells_of
from roaml.model.syntax import Expression
from roaml.model.system import Channel, SystemAutomaton
from roaml.model.value_types import bindings
from roaml.record import Record, field
from roaml.roles import ProtocolPart, SymbolKind, ValuePart
from roaml.scxml.names import FLAG

_EDGE = 4
"""The size of an edge without its expressions: a destination, an action and two locations."""

_CHILD_CONDITION = 4
"""The size of a condition such as `!(child = 3)`, for one earlier alternative in the guard of a child with a variable
index."""

_PLACES = 20
"""The number of entries of synchronisations that have the size of one part. A synchronisation has an entry for each
automaton, and most entries are `null`."""


def size_of(program: TranslatableSystem, globals_: Mapping[str, GlobalVariable]) -> Size:
    """The size of the translation of a system, with the largest shares first.

    Args:
        globals_: the global variables of the translation, by name.
    """
    return Size(_sorted(_cells(program, globals_)), _sorted(_parts(program, globals_)))


def _sorted(shares: Iterable[Share]) -> tuple[Share, ...]:
    """The shares, the largest first. Shares with the same phrase, path and symbol are added up."""
    counts: dict[tuple[str, str, Symbol | None], int] = {}
    for share in shares:
        checkpoint()
        key = (share.words, share.path, share.symbol)
        counts[key] = counts.get(key, 0) + share.count
    shares = (Share(count, *key) for key, count in counts.items())
    return tuple(sorted(shares, key=lambda share: -share.count))


# ----------------------------------------------------------------------- cells


def _cells(program: TranslatableSystem, globals_: Mapping[str, GlobalVariable]) -> Iterator[Share]:
    most = program.parameters.max_array_size
    for automaton, machine in _members(program):
        for chart, copies in _charts(machine):
            single = 0
            for name, type_ in _variables(chart, program).items():
                count = cells_of(type_, most)
                if count == 1:
                    single += copies
                    continue
                symbol = Symbol(automaton.path, SymbolKind.VARIABLE, name, chart.scope) if automaton.path else None
                words = f"the variable `{name}` of `{automaton.outline.name}`"
                yield Share(copies * count, words, automaton.path, symbol)
            if single:
                words = f"the variables of `{automaton.outline.name}` that are not arrays or strings"
                yield Share(single, words, automaton.path, _machine_symbol(automaton))
    for variable in globals_.values():
        source = variable.source
        words = f"the event parameter `{variable.event}__{variable.parameter}`"
        path = source.path if source else ""
        yield Share(most ** len(unwrap(variable.type)[1]), words, path, source)  # lengths are separate variables
    system = program.system
    for variable_name, type_name in system.variables.items():
        type_ = BASE_TYPES[type_name]
        yield Share(cells_of(type_, most), f"the blackboard variable `{variable_name}`", "")
    channels: list[tuple[Channel, tuple[ProtocolPart, ...], str]] = []
    channels += [
        (service, (ProtocolPart.REQUEST, ProtocolPart.RESPONSE), "service") for service in system.services.values()
    ]
    channels += [
        (action, (ProtocolPart.GOAL, ProtocolPart.FEEDBACK, ProtocolPart.RESULT), "action")
        for action in system.actions.values()
    ]
    for channel, parts, kind in channels:
        endpoint = channel.endpoints[0]
        held = (type_ for part in parts for type_ in fields(channel, part, program.environment).values())
        count = sum(cells_of(type_, most) for type_ in held)
        yield Share(count, f"the forwarded data of the {kind} `{channel.name}`", endpoint.symbol.path, endpoint.symbol)


def _members(program: TranslatableSystem) -> Iterator[tuple[SystemAutomaton, Machine]]:
    for automaton in program.system.automata:
        if program.system.is_program(automaton):
            continue  # programs have few variables, and the size of a tree is limited
        machine = program.machines.get(automaton.path) if automaton.path else builtin_machine(automaton)
        if machine is not None:
            yield automaton, machine


def _charts(machine: Machine) -> Iterator[tuple[Chart, int]]:
    """The charts of a machine with their numbers of copies."""
    yield machine.chart, 1
    yield from ((thread.chart, thread.count or 0) for thread in machine.threads)


def _variables(chart: Chart, program: TranslatableSystem) -> dict[str, Type]:
    types: dict[str, Type] = {}
    for data in chart.data:
        name = data.type.name if data.type else None
        if data.id is not None:
            type_ = resolve_type(name, program.environment.struct) if name else None
            types.setdefault(data.id.value, type_ or UNKNOWN)
    return types


# ----------------------------------------------------------------------- parts


def _parts(program: TranslatableSystem, globals_: Mapping[str, GlobalVariable]) -> Iterator[Share]:
    counted: dict[tuple[int, int], tuple[int, int]] = {}
    events = sum(variable.parameter == FLAG for variable in globals_.values())
    automata, syncs = events, 2 * events
    for automaton, machine in _members(program):
        children = len(automaton.instance.children) if automaton.instance else 0
        key = (id(machine), children)
        if key not in counted:
            charts = [(copies, _count(machine, chart, children, program)) for chart, copies in _charts(machine)]
            parts = sum(copies * count.parts for copies, count in charts)
            counted[key] = parts, sum(copies * count.actions for copies, count in charts)
        yield Share(counted[key][0], f"`{automaton.outline.name}`", automaton.path, _machine_symbol(automaton))
        automata += sum(copies for _, copies in _charts(machine))
        syncs += counted[key][1] + sum(timer.users for timer in automaton.outline.timers)
    for automaton in program.system.automata:
        if program.system.is_program(automaton) and automaton.instance is not None:
            children = len(automaton.instance.children)
            yield Share(_program_parts(children), f"`{automaton.outline.name}`", "")
            automata += 1
            syncs += _PROGRAM_SYNCS * (children + 1)
    yield Share(automata * syncs // _PLACES, f"the synchronisation of {automata:,} automata", "")


def _program_parts(children: int) -> int:
    """The approximate number of parts of the automaton of a node of a library with so many children. It depends on the
    node: a `Sequence` with 16 children has 2 times as many, a `SequenceWithMemory` 13 times."""
    return 300 + 60 * children + 6 * children**2


_PROGRAM_SYNCS = 4
"""The number of events between a node of a library and its parent, or one of its children."""


def _machine_symbol(automaton: SystemAutomaton) -> Symbol | None:
    return Symbol(automaton.path, SymbolKind.MACHINE, automaton.outline.name) if automaton.path else None


class _Query(Record, frozen=True):
    """An expression and its type; a count depends on this type."""

    tree: Expr
    handler: Handler | None
    part: ValuePart
    type: Type


class _Counted(Record, frozen=True):
    """The numbers of parts and actions of a chart, with the types that other files declare and on which they depend."""

    parts: int
    actions: int
    variables: dict[str, Type]
    queries: tuple[_Query, ...]


def _count(machine: Machine, chart: Chart, children: int, program: TranslatableSystem) -> _Counted:
    """The numbers of parts and actions of one copy of a chart. They are cached with the chart, because an edit changes
    only one machine of a system."""
    parameters = program.parameters
    known: dict[object, _Counted] = chart.__dict__.setdefault("translation_parts", {})
    key = (children, parameters.max_array_size, parameters.random_values)
    counter = _Counter(machine, chart, children, program, _variables(chart, program))
    counted = known.get(key)
    if counted is None or counted.variables != counter.variables or not all(map(counter.confirms, counted.queries)):
        parts, actions = counter.chart(), counter.actions()
        known[key] = counted = _Counted(parts, actions, counter.variables, tuple(counter.queries))
    return counted


class _Counter(Record, eq=False):
    """Counts the parts and actions of one copy of a chart, for a node with the given number of children."""

    machine: Machine
    of: Chart
    children: int
    program: TranslatableSystem
    variables: dict[str, Type]
    queries: list[_Query] = field(default_factory=list)

    def confirms(self, query: _Query) -> bool:
        """Whether the expression of a query still has the same type."""
        return self.inferred(query.tree, query.handler, query.part) == query.type

    def chart(self) -> int:
        entries = {s.id.value: self.body(s.entry.statements, None) for s in self.of.states if s.id and s.entry}
        events = {self.trigger(handler) for state in self.of.states for handler in state.handlers}
        return sum(self.state(state, entries, len(events)) for state in self.of.states)

    def state(self, state: State, entries: Mapping[str, int], events: int) -> int:
        """The number of parts of the edges of a state. The guard of a transition contains the conditions of the earlier
        transitions on the same event, and further edges discard the events without a transition."""
        leaving = self.body(state.exit.statements, None) if state.exit else 0
        count = events * _EDGE
        earlier: dict[object, int] = {}
        for handler in state.handlers:
            if not handler.effective:
                continue
            copies = self.copies(handler)
            condition = _nodes(handler.cond.tree) + 2 if handler.cond else 0
            condition += _CHILD_CONDITION if self.by_variable(handler) else 0
            condition += self.comparisons(handler.cond, handler, ValuePart.COND)
            trigger = self.trigger(handler)
            before = earlier.get(trigger, 0)
            bodies = sum(
                leaving + self.body(target.body, handler) + entries.get(target.state.value if target.state else "", 0)
                for target in handler.targets
            )
            count += copies * (_EDGE * (1 + len(handler.targets)) + before + condition + bodies)
            earlier[trigger] = before + condition
        return count + sum(earlier.values())

    def actions(self) -> int:
        """The number of actions of the copy: one for each step between states that is not the receipt of an event."""
        bodies = [b.statements for s in self.of.states for b in (s.entry, s.exit) if b]
        count = sum(map(self.steps, bodies)) + 1
        for state in self.of.states:
            for handler in state.handlers:
                count += self.copies(handler) * sum(self.steps(target.body) for target in handler.targets)
                count += handler.trigger is None
        return count

    def steps(self, body: tuple[Statement, ...]) -> int:
        count = 0
        for statement in statements(body):
            match statement:
                case If():
                    count += len(statement.branches) + 2
                case CallChild() if statement.child is not None and not statement.child.value.isdigit():
                    count += self.children + 2
                case Assign() if isinstance(statement.value, Expression):
                    count += 2 * any(map(is_draw, walk(statement.value.tree)))
        return count

    def trigger(self, handler: Handler) -> object:
        """A key for the event of a handler. Handlers of the same event have equal keys."""
        name = handler.event or handler.handle or handler.child
        return handler.trigger, name.value if name else ""

    def by_variable(self, handler: Handler) -> bool:
        return handler.child is not None and not handler.child.value.isdigit()

    def copies(self, handler: Handler) -> int:
        """The number of transitions for a handler: one for each child if it handles a child with a variable index."""
        return self.children if self.by_variable(handler) else 1

    def body(self, body: Iterable[Statement], handler: Handler | None) -> int:
        return sum(self.statement(statement, handler) for statement in body)

    def statement(self, statement: Statement, handler: Handler | None) -> int:
        match statement:
            case Assign():
                return self.assign(statement, handler)
            case If():
                return self.choice(statement, handler)
            case Send():
                return _EDGE + sum(self.param(param, handler) for param in statement.params)
            case RosSend():
                return _EDGE + sum(self.param(param, handler) for param in statement.fields)
            case SetOutput():
                return _EDGE + (self.value(statement.value, handler) if statement.value else 0)
            case CallChild() if statement.child is not None and not statement.child.value.isdigit():
                k = self.children
                return 2 * _EDGE * (k + 1) + _CHILD_CONDITION * (k + 1) * (k + 2) // 2
        return _EDGE

    def assign(self, statement: Assign, handler: Handler | None) -> int:
        if not isinstance(statement.value, Expression):
            return _EDGE
        draws = sum(map(is_draw, walk(statement.value.tree)))
        location = _nodes(statement.location.tree) if statement.location else 1
        stored = self.padding(statement, handler)
        read_and_written = location + 1 + self.value(statement.value, handler)
        if draws == 0:
            return read_and_written + stored
        values = self.program.parameters.random_values
        at_once = combinations(statement.value.tree, values)
        if at_once is not None:
            return _EDGE + at_once * (read_and_written + stored + _EDGE)
        return draws * _EDGE * (values + 1) + read_and_written + stored

    def padding(self, statement: Assign, handler: Handler | None) -> int:
        """The number of parts by which literals are padded to the capacity of the array in which they are stored."""
        assert isinstance(statement.value, Expression)
        if statement.location is None or not _literals(statement.value.tree):
            return 0
        type_ = self.type(statement.location.tree, handler)
        size = cells_of(type_, self.program.parameters.max_array_size)
        return size * len(_literals(statement.value.tree)) if size > 1 else 0

    def param(self, param: Param, handler: Handler | None) -> int:
        """The number of parts of a parameter. A literal that is sent is padded to the maximum size of arrays."""
        if not isinstance(param.value, Expression):
            return 3
        literals = _literals(param.value.tree)
        type_ = self.type(param.value.tree, handler) if literals else UNKNOWN
        padding = cells_of(type_, self.program.parameters.max_array_size, sent=True) * len(literals) if literals else 0
        draws = sum(map(is_draw, walk(param.value.tree)))
        values = self.program.parameters.random_values
        at_once = combinations(param.value.tree, values) or draws * values
        drawn = at_once * (_EDGE + _nodes(param.value.tree)) if draws else 0
        return 3 + self.value(param.value, handler) + padding + drawn

    def value(self, value: Expression, handler: Handler | None) -> int:
        return _nodes(value.tree) + self.comparisons(value, handler, ValuePart.BODY)

    def choice(self, statement: If, handler: Handler | None) -> int:
        count, earlier = 2 * _EDGE, 0
        for branch in statement.branches:
            condition = _nodes(branch.cond.tree) + 2 if branch.cond else 0
            condition += self.comparisons(branch.cond, handler, ValuePart.BODY)
            count += _EDGE + condition + earlier + self.body(branch.body, handler)
            earlier += condition
        otherwise = self.body(statement.otherwise.body, handler) if statement.otherwise else 0
        return count + _EDGE + earlier + otherwise

    def comparisons(self, value: Expression | None, handler: Handler | None, part: ValuePart) -> int:
        """The number of parts of the comparisons of arrays in an expression, which compare each element."""
        count = 0
        for node in walk(value.tree) if value else ():
            if isinstance(node, Binary) and node.operator.kind is OperatorKind.EQUALITY:
                sides = [self.type(side, handler, part) for side in (node.left, node.right)]
                arrays = [side for side in sides if isinstance(side, Array) or is_kind(side, ScalarKind.STRING)]
                if len(arrays) == 2 and not any(map(_is_literal, (node.left, node.right))):
                    count += 10 * min(cells_of(side, self.program.parameters.max_array_size) for side in arrays)
        return count

    def type(self, tree: Expr, handler: Handler | None, part: ValuePart = ValuePart.BODY) -> Type:
        type_ = self.inferred(tree, handler, part)
        self.queries.append(_Query(tree, handler, part, type_))
        return type_

    def inferred(self, tree: Expr, handler: Handler | None, part: ValuePart) -> Type:
        known = bindings(handler, part, self.machine, self.program.environment) if handler else {}
        return infer(tree, {**self.variables, **known}.get)[0]


def _nodes(tree: Expr) -> int:
    return len(walk(tree)) + sum(len(node.value) for node in walk(tree) if isinstance(node, String))


def _is_literal(tree: Expr) -> bool:
    return isinstance(tree, (ArrayLiteral, ObjectLiteral, String))


def _literals(tree: Expr) -> list[Expr]:
    """The literals of arrays, objects and strings in an expression, at most 8, outer ones before those inside."""
    return [] if isinstance(tree, Name) else [node for node in walk(tree) if _is_literal(node)][:8]
