# SPDX-License-Identifier: Apache-2.0
"""A node of an executed tree -> a plain automaton (docs/spec/mocks.md#nodes).

The program of the node is executed symbolically: variables that are known during translation become part of the states,
so that a tick needs few steps. A state waits for an event of the tree or of the blackboard, or decides what depends on
the values of variables.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple, TypeAlias

from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Boolean, Call, Conditional, Expr, Member, Number, String, Unary
from roaml.expr.types import BASE_TYPES, Type
from roaml.lower.blackboard import ANSWER, REQUEST, blackboard_write
from roaml.lower.build import binary, both, equal, event_data, integer, name
from roaml.lower.interfaces import tree_event
from roaml.lower.program import NOWHERE
from roaml.mocks import assembly
from roaml.mocks.assembly import CodeLabel, Instruction, NodeProgram
from roaml.mocks.entries import BoardEntry, EntryKind
from roaml.mocks.scripts import CompiledScript
from roaml.scxml.model import (
    Assign,
    Automaton,
    Data,
    Param,
    Role,
    ScxmlEvent,
    Send,
    State,
    Statement,
    Target,
    Transition,
)
from roaml.text import Location

IDLE, SUCCESS, FAILURE, RUNNING, SKIPPED, HELD = range(6)
"""The codes of statuses and answers. SKIPPED: the node was skipped and is IDLE; HELD: it was skipped and has another
status. For its parent, this makes a difference (docs/spec/mocks.md#skipped)."""
STATUS_CODES = {
    "IDLE": IDLE,
    "SUCCESS": SUCCESS,
    "FAILURE": FAILURE,
    "RUNNING": RUNNING,
    "SKIPPED": SKIPPED,
    "HELD": HELD,
}

MAX_STATES = 20_000
"""The maximum number of states of one node."""

Known: TypeAlias = "int | bool | float | str"
Value: TypeAlias = "Known | Expr"

TYPES: Mapping[EntryKind, Type] = {
    EntryKind.INTEGER: BASE_TYPES["int64"],
    EntryKind.REAL: BASE_TYPES["float64"],
    EntryKind.TEXT: BASE_TYPES["string"],
}


class NodeTooLargeError(Exception):
    """The program of a node has more states than `MAX_STATES`."""


@dataclass(frozen=True, slots=True, eq=False)
class Child:
    """What a node knows of a child.

    Attributes:
        number: of the child in the tree.
        answers: the codes with which it can answer.
        is_stateless: whether a reset has no effect on it.
    """

    number: int
    answers: frozenset[int]
    is_stateless: bool


@dataclass(frozen=True, slots=True, eq=False)
class NodeCode:
    """Everything that determines the automaton of a node.

    Attributes:
        known: the values of ports and parameters that are constants.
        bound: the ports that are bound to entries of the blackboard.
        scripts: by attribute or port.
        updated: the entry that states whether the observed one was written; `None` if nothing writes it.
        outputs: what a mock writes when it succeeds: entries, each with its possible values.
        elements: of the queue of a loop.
        flags_of: observed entry -> what states for its observers that it was written.
        flags_at: the same for ports that write observed entries whose values nothing reads.
        rate: of the tree, in Hz.
        counts: whether counters for measurements are included.
    """

    number: int
    name: str
    program: NodeProgram
    children: tuple[Child, ...]
    known: Mapping[str, Known]
    bound: Mapping[str, BoardEntry]
    scripts: Mapping[str, CompiledScript]
    updated: BoardEntry | None
    outputs: tuple[tuple[BoardEntry, tuple[Known, ...]], ...]
    elements: tuple[Known, ...]
    flags_of: Mapping[str, tuple[BoardEntry, ...]]
    flags_at: Mapping[str, tuple[BoardEntry, ...]]
    rate: Fraction
    counts: bool
    origin: Location


@dataclass(frozen=True, slots=True, eq=False)
class NodeAutomaton:
    """An automaton, and what its parent has to know of it."""

    automaton: Automaton
    child: Child


def node_automaton(code: NodeCode) -> NodeAutomaton:
    """The automaton of a node.

    Raises:
        NodeTooLargeError: the node has too many states.
    """
    explorer = _Explorer(code)
    automaton = explorer.automaton()
    conditions = {name for name in code.scripts if name.startswith("_")}
    stateless = code.program.is_stateless and not conditions
    return NodeAutomaton(automaton, Child(code.number, frozenset(explorer.answers), stateless))


Place: TypeAlias = "tuple[str, int]"
"""A segment of the code, and the index of an instruction in it."""

Fixed: TypeAlias = "tuple[tuple[str, Known], ...]"
"""The values of all variables that are known, sorted by name."""

_TOUCHED = "*touched"
_RESULT = "*result"
_SKIPS = "*skips"


class _Rest(NamedTuple):
    """The node waits for its parent."""

    fixed: Fixed


class _Ticking(NamedTuple):
    """The node waits for the answer of a child to a tick."""

    place: Place
    fixed: Fixed
    child: int
    target: str


class _Halting(NamedTuple):
    """The node waits for the answer of a child to a halt."""

    place: Place
    fixed: Fixed
    child: int


class _Asking(NamedTuple):
    """The node waits for the blackboard."""

    place: Place
    fixed: Fixed
    entries: tuple[BoardEntry, ...]


class _Deciding(NamedTuple):
    """What follows depends on the values of variables."""

    place: Place
    fixed: Fixed


class _Exception(NamedTuple):
    """The library has thrown an exception."""


_Key: TypeAlias = _Rest | _Ticking | _Halting | _Asking | _Deciding | _Exception


@dataclass(slots=True)
class _Way:
    """One way through the code up to the next state: the statements on it, and what is known."""

    place: Place
    fixed: dict[str, Known]
    body: list[Statement]


@dataclass(eq=False)
class _Explorer:
    code: NodeCode
    states: dict[_Key, str] = field(default_factory=dict)
    built: dict[str, State] = field(default_factory=dict)
    names: dict[str, int] = field(default_factory=dict)
    pending: list[tuple[str, _Key]] = field(default_factory=list)
    data: dict[str, Data] = field(default_factory=dict)
    answers: set[int] = field(default_factory=set)

    def __post_init__(self) -> None:
        program = self.code.program
        given = frozenset(self.code.scripts)
        self.segments: dict[str, Sequence[Instruction | _Step]] = {
            "before": assembly.before(given),
            "tick": program.tick,
            "after": assembly.after(given),
            "halt": program.halt,
            "halted": assembly.halted(given),
        }
        self.kept = {"status", *program.fixed}
        self.declared = dict(program.variables)
        for flag in program.flags:
            self.declared |= {f"{flag}_{i}": False for i in range(len(self.code.children))}

    def automaton(self) -> Automaton:
        for variable, value in self.declared.items():
            self.declare(variable, BASE_TYPES["bool" if isinstance(value, bool) else "int32"], _expr(value))
        start: dict[str, Known] = {"status": IDLE, _TOUCHED: 0, **self.code.program.fixed}
        initial = self.rest(start)
        while self.pending:
            state, key = self.pending.pop()
            self.built[state] = self.build(state, key)
            if len(self.states) > MAX_STATES:
                raise NodeTooLargeError
        states = tuple(self.built[state] for state in self.states.values())
        return Automaton(self.code.name, Role.MACHINE, initial, tuple(self.data.values()), states, self.code.origin)

    def declare(self, variable: str, type_: Type, initial: Expr) -> None:
        if variable not in self.data:
            self.data[variable] = Data(variable, type_, initial, self.code.origin)

    # ------------------------------------------------------------------ states

    def state(self, word: str, key: _Key) -> str:
        """The state for a key; a new one is built later."""
        if key not in self.states:
            count = self.names[word] = self.names.get(word, 0) + 1
            self.states[key] = word if count == 1 else f"{word}_{count}"
            self.pending.append((self.states[key], key))
        return self.states[key]

    def rest(self, fixed: Mapping[str, Known]) -> str:
        """The state in which the node waits for its parent."""
        kept = {k: v for k, v in fixed.items() if k in self.kept or k == _TOUCHED}
        word = next(word for word, number in STATUS_CODES.items() if number == kept["status"]).lower()
        return self.state(word, _Rest(_frozen(kept)))

    def build(self, state: str, key: _Key) -> State:
        transitions: list[Transition] = []
        match key:
            case _Rest(fixed):
                transitions += self.on(self.event("tick"), ("before", 0), dict(fixed))
                if not self.code.program.is_stateless or self.has_conditions:
                    transitions += self.on_halt(dict(fixed))
            case _Ticking(place, fixed, number, target):
                child = self.code.children[number]
                answer = tree_event(child.number, "response")
                for status in sorted(child.answers):
                    after = {**dict(fixed), target: status}
                    touched = int(after[_TOUCHED])
                    after[_TOUCHED] = touched & ~(1 << number) if status == SKIPPED else touched | (1 << number)
                    transitions += self.on(answer, place, after, equal(event_data("status"), integer(status)))
            case _Halting(place, fixed, number):
                event = tree_event(self.code.children[number].number, "halt_response")
                transitions += self.on(event, place, dict(fixed))
            case _Asking(place, fixed, entries):
                body = []
                for entry in entries:
                    self.declare(entry.local, TYPES[entry.kind], entry.zero)
                    body.append(Assign(name(entry.local), event_data(entry.variable), self.code.origin))
                transitions += self.on(ANSWER, place, dict(fixed), body=body)
            case _Deciding(place, fixed):
                transitions += self.on(None, place, dict(fixed))
            case _Exception():
                pass
        return State(state, (), (), tuple(transitions), self.code.origin)

    @property
    def has_conditions(self) -> bool:
        return any(script.startswith("_") for script in self.code.scripts)

    def event(self, what: str) -> ScxmlEvent:
        return tree_event(self.code.number, what)

    def on_halt(self, fixed: dict[str, Known]) -> list[Transition]:
        if fixed["status"] == RUNNING:
            return self.on(self.event("halt"), ("halt", 0), fixed)
        target = self.rest({**fixed, "status": IDLE})
        answer = Send(self.event("halt_response"), (), self.code.origin)
        return [
            Transition(self.event("halt"), None, (Target(target, 1.0, (answer,), self.code.origin),), self.code.origin)
        ]

    # --------------------------------------------------------------- execution

    def on(
        self,
        event: ScxmlEvent | None,
        place: Place,
        fixed: dict[str, Known],
        cond: Expr | None = None,
        body: Sequence[Statement] = (),
    ) -> list[Transition]:
        """The transitions on an event: the code from `place` to the next states."""
        origin = self.code.origin
        return [
            Transition(event, guard, targets, origin)
            for guard, targets in self.alternatives(_Way(place, fixed, list(body)), cond)
        ]

    def alternatives(self, way: _Way, cond: Expr | None) -> list[tuple[Expr | None, tuple[Target, ...]]]:
        """What can follow, depending on conditions in the current state. Conditions are decided at once only as long as
        nothing was executed."""
        stop = self.run(way)
        match stop:
            case _Decision(test, yes, no) if not way.body:
                return [
                    *self.alternatives(_Way(yes, dict(way.fixed), []), both(cond, test)),
                    *self.alternatives(_Way(no, dict(way.fixed), []), both(cond, _negated(test))),
                ]
            case _Draw(probability, yes, no):
                targets = []
                for share, place in ((probability, yes), (1 - probability, no)):
                    if share > 0:
                        branch = _Way(place, dict(way.fixed), list(way.body))
                        targets.append(self.single(branch, share))
                return [(cond, tuple(targets))]
        return [(cond, (self.target(way, stop, 1.0),))]

    def single(self, way: _Way, share: float) -> Target:
        return self.target(way, self.run(way), share)

    def target(self, way: _Way, stop: _Stop, share: float) -> Target:
        # What depends on values is decided in a state of its own.
        later = _Deciding(way.place, _frozen(way.fixed))
        state = stop if isinstance(stop, str) else self.state("deciding", later)
        return Target(state, share, tuple(way.body), self.code.origin)

    def run(self, way: _Way) -> _Stop:
        """Execute until an event has to arrive, or something depends on values. `way.place` is the instruction at which
        it stops.

        Returns:
            the name of a state, or the instruction with what it depends on and the places that follow.
        """
        while True:
            segment, index = way.place
            if way.place == _EXCEPTION:
                return self.state("exception", _Exception())
            code = self.segments[segment]
            if index >= len(code):
                state = self.end(segment, way)
                if state is not None:
                    return state
                continue
            instruction = code[index]
            if isinstance(instruction, (_Ask, _Run, _Branch, _Draw)):
                stop = self.step(instruction, way)
            else:
                stop = self.execute(instruction, (segment, index + 1), way)
            if stop is not None:
                return stop

    def end(self, segment: str, way: _Way) -> str | None:
        """At the end of a segment: the next one, or the answer to the parent."""
        match segment:
            case "before":
                way.place = ("tick", 0)
            case "halt":
                way.fixed["status"] = IDLE
                way.place = ("halted", 0)
            case "halted":
                if way.fixed.pop(_SKIPS, False):
                    way.fixed[_RESULT] = SKIPPED
                    way.place = ("after", 0)
                    return None
                way.body.append(Send(self.event("halt_response"), (), self.code.origin))
                return self.rest(way.fixed)
            case "after":
                return self.answer(way)
            case _:
                raise AssertionError(f"{self.code.program.name} does not return")
        return None

    def answer(self, way: _Way) -> str:
        result = int(way.fixed.pop(_RESULT))
        if result < SKIPPED:
            way.fixed["status"] = result
        elif way.fixed["status"] != IDLE:
            result = HELD
        self.answers.add(result)
        status = Param("status", integer(result), self.code.origin)
        way.body.append(Send(self.event("response"), (status,), self.code.origin))
        return self.rest(way.fixed)

    def execute(self, instruction: Instruction, following: Place, way: _Way) -> _Stop | None:
        """Execute one instruction; return where to stop, or `None` to go on at `way.place`."""
        segment = following[0]

        def at(label: CodeLabel) -> Place:
            return (segment, label.index)

        match instruction:
            case assembly.SetVariable():
                self.assign(instruction, way)
            case assembly.Jump(label):
                following = at(label)
            case assembly.Test(condition, otherwise):
                value = self.value(condition, way.fixed)
                if not isinstance(value, (bool, int, float, str)):
                    return _Decision(value, following, at(otherwise))
                following = following if value else at(otherwise)
            case assembly.Choose(expression, otherwise):
                probability = float(self.number(expression, way.fixed))
                if 0 < probability < 1:
                    return _Draw(probability, following, at(otherwise))
                following = following if probability >= 1 else at(otherwise)
            case assembly.TickChild(child, target):
                return self.tick(int(self.number(child, way.fixed)), target, following, way)
            case assembly.Reset(child):
                state = self.reset(int(self.number(child, way.fixed)), following, way)
                if state is not None:
                    return state
            case assembly.Return(status):
                way.fixed[_RESULT] = int(self.number(status, way.fixed))
                following = ("after", 0)
            case assembly.Read(ports):
                entries = tuple(self.code.bound[port] for port in ports if port in self.code.bound)
                if entries:
                    return self.ask(entries, following, way)
            case assembly.Write(port, expression):
                self.write_port(port, self.value(expression, way.fixed), way)
            case assembly.Evaluate(script, label):
                no = None if label is None else at(label)
                following = self.evaluate(self.code.scripts[script], script, following, no)
            case assembly.Updated(otherwise):
                if self.code.updated is None:
                    following = at(otherwise)
                else:
                    following = self.ask_update(self.code.updated, following, at(otherwise))
            case assembly.WriteOutputs():
                following = self.write_outputs(following)
            case assembly.HaltSelf():
                way.fixed[_SKIPS] = True
                following = ("halt", 0)
            case assembly.Count(counter):
                if self.code.counts:
                    self.declare(counter, BASE_TYPES["int32"], integer(0))
                    increased = binary(name(counter), Operator.ADD, integer(1))
                    way.body.append(Assign(name(counter), increased, self.code.origin))
            case assembly.Throw():
                following = _EXCEPTION
        way.place = following
        return None

    def assign(self, instruction: assembly.SetVariable, way: _Way) -> None:
        value = self.value(instruction.value, way.fixed)
        target = instruction.target
        if instruction.element is not None:
            target = f"{target}_{self.number(instruction.element, way.fixed)}"
        if target in self.declared:
            way.body.append(Assign(name(target), _expr(value), self.code.origin))
        else:
            assert isinstance(value, (bool, int, float, str)), target
            way.fixed[target] = value

    def tick(self, number: int, target: str, following: Place, way: _Way) -> str:
        child = self.code.children[number]
        way.body.append(Send(tree_event(child.number, "tick"), (), self.code.origin))
        return self.state("ticking", _Ticking(following, _frozen(way.fixed), number, target))

    def reset(self, number: int, following: Place, way: _Way) -> str | None:
        child = self.code.children[number]
        touched = int(way.fixed[_TOUCHED])
        way.fixed[_TOUCHED] = touched & ~(1 << number)
        if child.is_stateless or not touched & (1 << number):
            return None
        way.body.append(Send(tree_event(child.number, "halt"), (), self.code.origin))
        return self.state("halting", _Halting(following, _frozen(way.fixed), number))

    # -------------------------------------------------------------- blackboard

    def ask(self, entries: tuple[BoardEntry, ...], following: Place, way: _Way) -> str:
        way.body.append(Send(REQUEST, (), self.code.origin))
        return self.state("asking", _Asking(following, _frozen(way.fixed), entries))

    def write(self, entry: BoardEntry, value: Expr, way: _Way) -> None:
        origin = self.code.origin
        way.body.append(Send(blackboard_write(entry.variable), (Param("value", value, origin),), origin))
        for flag in self.code.flags_of.get(entry.variable, ()):
            written = Param("value", integer(1), origin)
            way.body.append(Send(blackboard_write(flag.variable), (written,), origin))

    def write_port(self, port: str, value: Value, way: _Way) -> None:
        if port in self.code.bound:
            self.write(self.code.bound[port], _expr(value), way)
        for flag in self.code.flags_at.get(port, ()):
            self.write(flag, integer(1), way)

    def ask_update(self, flag: BoardEntry, following: Place, otherwise: Place) -> Place:
        """Whether the observed entry was written; if so, it counts as seen."""
        segment = f"*updated*{following}"
        seen = _Run(((flag.local, integer(0)),), (flag,))
        self.segments.setdefault(
            segment,
            (
                _Ask((flag,)),
                _Branch(equal(name(flag.local), integer(1)), (segment, 2), otherwise),
                seen,
                _Branch(True, following, otherwise),
            ),
        )
        return (segment, 0)

    def write_outputs(self, following: Place) -> Place:
        """Each output gets one of its values, all with the same probability."""
        segment = f"*outputs*{following}"
        if segment not in self.segments:
            steps: list[_Step] = []
            for entry, values in self.code.outputs:
                end = len(steps) + 3 * len(values)
                for position, value in enumerate(values):
                    share = 1 / (len(values) - position)
                    here = len(steps)
                    steps.append(_Draw(share, (segment, here + 1), (segment, here + 3)))
                    steps.append(_Run(((entry.local, _expr(value)),), (entry,)))
                    steps.append(_Branch(True, (segment, end), following))
            steps.append(_Branch(True, following, following))
            self.segments[segment] = tuple(steps)
        return (segment, 0)

    def evaluate(self, script: CompiledScript, key: str, following: Place, otherwise: Place | None) -> Place:
        """A script: it reads all entries at once, computes, and writes all that it has assigned."""
        segment = f"*{key}*{following}"
        if segment not in self.segments:
            steps: list[_Step] = [_Ask(script.reads)] if script.reads else []
            for condition in script.conditions:
                steps.append(_Branch(condition, (segment, len(steps) + 1), _EXCEPTION))
            steps.append(_Run(script.assignments, script.writes))
            if otherwise is None:
                steps.append(_Branch(True, following, following))
            else:
                assert script.truth is not None
                steps.append(_Branch(script.truth, following, otherwise))
            self.segments[segment] = tuple(steps)
        return (segment, 0)

    def step(self, step: _Step, way: _Way) -> _Stop | None:
        """Execute an added step; return where to stop, or `None` to go on at `way.place`."""
        segment, index = way.place
        match step:
            case _Ask(entries):
                return self.ask(entries, (segment, index + 1), way)
            case _Run(assignments, writes):
                for local, value in assignments:
                    way.body.append(Assign(name(local), value, self.code.origin))
                for entry in writes:
                    self.declare(entry.local, TYPES[entry.kind], entry.zero)
                    self.write(entry, name(entry.local), way)
                way.place = (segment, index + 1)
            case _Branch(condition, yes, no):
                if not isinstance(condition, bool):
                    return _Decision(condition, yes, no)
                way.place = yes if condition else no
            case _Draw(probability, yes, no):
                if probability < 1:
                    return step
                way.place = yes
        return None

    # ------------------------------------------------------------- expressions

    def number(self, expression: ast.expr, fixed: Mapping[str, Known]) -> float:
        value = self.value(expression, fixed)
        assert isinstance(value, (bool, int, float)), ast.unparse(expression)
        return value

    def value(self, expression: ast.expr, fixed: Mapping[str, Known]) -> Value:
        """The value of an expression of a program: known, or an expression of the automaton."""
        match expression:
            case ast.Constant(value=bool() | int() | float() | str() as constant):
                return constant
            case ast.Name(id=identifier):
                return self.name(identifier, fixed)
            case ast.Subscript(value=ast.Name(id=identifier), slice=element):
                return name(f"{identifier}_{self.number(element, fixed)}")
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                value = self.value(operand, fixed)
                return not value if _is_known(value) else _negated(_expr(value))
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.number(operand, fixed)
            case ast.BoolOp(op=operator, values=values):
                return self.logical([self.value(v, fixed) for v in values], isinstance(operator, ast.And))
            case ast.Compare(left=left, ops=[operator], comparators=[right]):
                return _compared(self.value(left, fixed), type(operator), self.value(right, fixed))
            case ast.BinOp(left=left, op=operator, right=right):
                return _computed(self.value(left, fixed), type(operator), self.value(right, fixed))
            case ast.Call(func=ast.Name(id=function), args=arguments):
                return self.call(function, [self.value(argument, fixed) for argument in arguments])
        raise AssertionError(ast.dump(expression))

    def logical(self, values: Sequence[Value], conjunction: bool) -> Value:
        result: Expr | None = None
        for value in values:
            if isinstance(value, (bool, int, float, str)):
                if bool(value) is not conjunction:
                    return not conjunction
            elif result is None:
                result = value
            else:
                result = binary(result, Operator.AND if conjunction else Operator.OR, value)
        return conjunction if result is None else result

    def name(self, identifier: str, fixed: Mapping[str, Known]) -> Value:
        if identifier in STATUS_CODES:
            return STATUS_CODES[identifier]
        if identifier in fixed:
            return fixed[identifier]
        if identifier in self.declared:
            return name(identifier)
        key = {"otherwise": "else", "result": _RESULT}.get(identifier, identifier)
        if key in fixed:
            return fixed[key]
        if key == "COUNT":
            return len(self.code.children)
        if key == "LENGTH":
            return len(self.code.elements)
        if key in self.code.bound:
            return name(self.code.bound[key].local)
        return self.code.known[key]

    def call(self, function: str, arguments: Sequence[Value]) -> Value:
        match function, arguments:
            case "ticks", [duration]:
                if isinstance(duration, (bool, int, float)):
                    return ticks_of(Fraction(str(duration)), self.code.rate)
                assert not isinstance(duration, str)
                scaled = binary(duration, Operator.MULTIPLY, _expr(float(self.code.rate)))
                return _math("ceil", binary(scaled, Operator.DIVIDE, integer(1000)))
            case "maximum", [first, second]:
                if isinstance(first, (int, float)) and isinstance(second, (int, float)):
                    return max(first, second)
                return _math("max", _expr(first), _expr(second))
            case "matches", [int() as case]:
                return self.matches(case)
            case "element", [position]:
                return self.element(position)
        raise AssertionError(function)

    def matches(self, case: int) -> Value:
        """Whether the variable of a switch equals a case."""
        return _compared(self.name("variable", {}), ast.Eq, self.name(f"case_{case + 1}", {}))

    def element(self, position: Value) -> Value:
        """The element of a queue at a position."""
        result = _expr(self.code.elements[-1])
        for index in reversed(range(len(self.code.elements) - 1)):
            test = equal(_expr(position), integer(index))
            result = Conditional(NOWHERE, test, _expr(self.code.elements[index]), result)
        return result


_EXCEPTION: Place = ("exception", 0)


class _Ask(NamedTuple):
    entries: tuple[BoardEntry, ...]


class _Run(NamedTuple):
    assignments: tuple[tuple[str, Expr], ...]
    writes: tuple[BoardEntry, ...]


class _Branch(NamedTuple):
    condition: Expr | bool
    yes: Place
    no: Place


class _Decision(NamedTuple):
    condition: Expr
    yes: Place
    no: Place


class _Draw(NamedTuple):
    probability: float
    yes: Place
    no: Place


_Step: TypeAlias = _Ask | _Run | _Branch | _Draw
_Stop: TypeAlias = str | _Decision | _Draw
"""Where the execution stops: in a state, or at something that depends on values or on chance."""


def ticks_of(milliseconds: Fraction, rate: Fraction) -> int:
    """The number of ticks of the tree that a duration takes, rounded up (docs/spec/nodes.md#durations)."""
    return math.ceil(milliseconds * rate / 1000)


def _is_known(value: Value) -> bool:
    return isinstance(value, (bool, int, float, str))


def _frozen(fixed: Mapping[str, Known]) -> Fixed:
    return tuple(sorted(fixed.items()))


_COMPARISONS: Mapping[type[ast.cmpop], tuple[Operator, Callable[[Any, Any], bool]]] = {
    ast.Eq: (Operator.EQUAL, operator.eq),
    ast.NotEq: (Operator.NOT_EQUAL, operator.ne),
    ast.Lt: (Operator.LESS, operator.lt),
    ast.LtE: (Operator.LESS_EQUAL, operator.le),
    ast.Gt: (Operator.GREATER, operator.gt),
    ast.GtE: (Operator.GREATER_EQUAL, operator.ge),
}
_ARITHMETIC: Mapping[type[ast.operator], tuple[Operator, Callable[[Any, Any], Any]]] = {
    ast.Add: (Operator.ADD, operator.add),
    ast.Sub: (Operator.SUBTRACT, operator.sub),
    ast.Mult: (Operator.MULTIPLY, operator.mul),
    ast.Div: (Operator.DIVIDE, operator.truediv),
}


def _compared(left: Value, kind: type[ast.cmpop], right: Value) -> Value:
    symbol, function = _COMPARISONS[kind]
    if isinstance(left, (bool, int, float, str)) and isinstance(right, (bool, int, float, str)):
        return function(left, right)
    return binary(_expr(left), symbol, _expr(right))


def _computed(left: Value, kind: type[ast.operator], right: Value) -> Value:
    symbol, function = _ARITHMETIC[kind]
    if isinstance(left, (bool, int, float)) and isinstance(right, (bool, int, float)):
        result: Known = function(left, right)
        return result
    return binary(_expr(left), symbol, _expr(right))


def _expr(value: Value) -> Expr:
    match value:
        case bool():
            return Boolean(NOWHERE, value)
        case int():
            return integer(value) if value >= 0 else Unary(NOWHERE, UnaryOperator.NEGATE, integer(-value))
        case float():
            return Number(NOWHERE, value, True)
        case str():
            return String(NOWHERE, value)
    return value


def _negated(condition: Expr) -> Expr:
    return Unary(NOWHERE, UnaryOperator.NOT, condition)


def _math(function: str, *arguments: Expr) -> Expr:
    return Call(NOWHERE, Member(NOWHERE, name("Math"), function, NOWHERE), arguments)
