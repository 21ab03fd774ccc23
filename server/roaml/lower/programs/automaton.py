# SPDX-License-Identifier: Apache-2.0
"""Creates the plain automaton of a node of an executed tree (docs/spec/mocks.md#nodes).

The program of the node is executed symbolically. Variables whose values are known during the translation become part of
the states, so that a tick needs few steps. In a state, the automaton waits for an event of the tree or of the
blackboard, or decides by the values of its variables how it continues.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

from roaml.expr.operators import Operator
from roaml.expr.tree import Expr
from roaml.expr.types import BASE_TYPES, Type
from roaml.interruption import checkpoint
from roaml.libraries.programs import assembly
from roaml.libraries.programs.assembly import CodeLabel, Instruction
from roaml.libraries.programs.statuses import HELD, IDLE, RUNNING, SKIPPED, STATUS_CODES, Known
from roaml.lower.blackboard_events import answer_of, blackboard_write, request_of
from roaml.lower.build import binary, both, equal, event_data, integer, name
from roaml.lower.interfaces import tree_event
from roaml.lower.programs.code import TYPES, Child, NodeCode, Value
from roaml.lower.programs.entries import BoardEntry
from roaml.lower.programs.liveness import live_variables
from roaml.lower.programs.steps import (
    EXCEPTION,
    Decide,
    Draw,
    Place,
    ReadEntries,
    Step,
    Update,
    output_steps,
    port_steps,
    script_steps,
    update_steps,
)
from roaml.lower.programs.values import RESULT, ProgramValues, expr, negated
from roaml.record import Record, field
from roaml.scxml.events import Role, ScxmlEvent
from roaml.scxml.model import Assign, Automaton, Data, Param, Send, State, Statement, Target, Transition
from roaml.scxml.names import TreeEventKind

MAX_STATES = 20_000
"""The maximum number of states of the automaton of one node."""


MACHINE, CONDITION_MACHINE = "machine", "condition_machine"
"""The names of the programs that evaluate the conditions of an action and of a condition whose behaviour is a machine.
Machines are also halted after they have ended (docs/spec/nodes.md#library)."""
MACHINES = (MACHINE, CONDITION_MACHINE)


class NodeTooLargeError(Exception):
    """Raised if the automaton of a node has more states than `MAX_STATES`."""


def too_large(node: str, children: int) -> str:
    """Why a node cannot be translated, and what to do.

    Args:
        node: the name of the node.
        children: the number of its children.
    """
    has = f"`{node}` with {children:,} {'child' if children == 1 else 'children'} has"
    return f"{has} more than {MAX_STATES:,} states, the maximum of one node; divide its children among nested nodes"


class NodeAutomaton(Record, frozen=True, eq=False):
    """The automaton of a node, and the properties of the node on which its parent depends."""

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
    stateless = code.program.is_stateless and not conditions and not code.is_halted_always
    return NodeAutomaton(automaton, Child(code.address, frozenset(explorer.answers), stateless, code.origin))


Fixed: TypeAlias = "tuple[tuple[str, Known], ...]"
"""The variables whose values are known, with the values; sorted by name."""

_TOUCHED = "*touched"
_SKIPS = "*skips"
_ENDED = "*ended"


class _Rest(Record, frozen=True):
    """The node waits for its parent."""

    fixed: Fixed


class _Ticking(Record, frozen=True):
    """The node waits for the answer of a child to a tick."""

    place: Place
    fixed: Fixed
    child: int
    target: str


class _Halting(Record, frozen=True):
    """The node waits for the answer of a child to a halt."""

    place: Place
    fixed: Fixed
    child: int


class _Asking(Record, frozen=True):
    """The node waits for the blackboard."""

    place: Place
    fixed: Fixed
    entries: tuple[BoardEntry, ...]


class _Deciding(Record, frozen=True):
    """The node decides by the values of variables how it continues."""

    place: Place
    fixed: Fixed


class _Exception(Record, frozen=True):
    """The library has thrown an exception."""


class _Decision(Record, frozen=True):
    """The execution continues at `yes` if a condition on variables holds, otherwise at `no`."""

    condition: Expr
    yes: Place
    no: Place


_Stop: TypeAlias = str | _Decision | Draw
"""The reason why the execution stops: it has reached the state with this name, or it depends on a condition or on
chance."""

_Key: TypeAlias = _Rest | _Ticking | _Halting | _Asking | _Deciding | _Exception


class _Execution(Record):
    """One execution of the code up to the next state.

    Attributes:
        place: the next instruction.
        fixed: variable whose value is known -> the value.
        body: the statements that the automaton executes.
    """

    place: Place
    fixed: dict[str, Known]
    body: list[Statement]


class _Explorer(Record, eq=False, dict=True):
    code: NodeCode
    states: dict[_Key, str] = field(default_factory=dict)
    built: dict[str, State] = field(default_factory=dict)
    names: dict[str, int] = field(default_factory=dict)
    pending: list[tuple[str, _Key]] = field(default_factory=list)
    data: dict[str, Data] = field(default_factory=dict)
    answers: set[int] = field(default_factory=set)
    continued: dict[str, tuple[Place, ...]] = field(default_factory=dict)
    """Segment that `added` has created -> the places at which the execution continues after it."""

    def __post_init__(self) -> None:
        program = self.code.program
        self.segments: dict[str, Sequence[Instruction | Step]] = {
            **assembly.segments(program, frozenset(self.code.scripts))
        }
        self.live = live_variables(program, frozenset(self.code.scripts))
        self.kept = {"status", *program.fixed}
        self.declared = dict(program.variables)
        for flag in program.flags:
            self.declared |= {f"{flag}_{i}": False for i in range(len(self.code.children))}
        self.values = ProgramValues(self.code, self.declared)
        self.skippable = sum(
            1 << i for i, child in enumerate(self.code.children) if SKIPPED in child.answers and not child.is_stateless
        )

    def automaton(self) -> Automaton:
        for variable, value in self.declared.items():
            self.declare(variable, BASE_TYPES["bool" if isinstance(value, bool) else "int32"], expr(value))
        start: dict[str, Known] = {"status": IDLE, _TOUCHED: 0, **self.code.program.fixed}
        initial = self.rest(start)
        while self.pending:
            state, key = self.pending.pop()
            checkpoint()
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
        """The name of the state for `key`. A new state is named after `word` and is built later."""
        if key not in self.states:
            count = self.names[word] = self.names.get(word, 0) + 1
            self.states[key] = word if count == 1 else f"{word}_{count}"
            self.pending.append((self.states[key], key))
        return self.states[key]

    def rest(self, fixed: Mapping[str, Known]) -> str:
        """The name of the state in which the node waits for its parent."""
        kept = {k: v for k, v in fixed.items() if k in self.kept or k == _TOUCHED}
        word = next(word for word, number in STATUS_CODES.items() if number == kept["status"]).lower()
        return self.state(word, _Rest(_frozen(kept)))

    def build(self, state: str, key: _Key) -> State:
        transitions: list[Transition] = []
        match key:
            case _Rest(fixed):
                transitions += self.on(self.event(TreeEventKind.TICK), ("before", 0), dict(fixed))
                if not self.code.program.is_stateless or self.has_conditions or self.code.is_halted_always:
                    transitions += self.on_halt(dict(fixed))
            case _Ticking(place, fixed, number, target):
                child = self.code.children[number]
                answer = tree_event(child.address, TreeEventKind.RESPONSE)
                for status in sorted(child.answers):
                    after = {**dict(fixed), target: status}
                    touched, bit = int(after[_TOUCHED]), 0 if child.is_stateless else 1 << number
                    after[_TOUCHED] = touched & ~bit if status == SKIPPED else touched | bit
                    transitions += self.on(answer, place, after, equal(event_data("status"), integer(status)))
            case _Halting(place, fixed, number):
                event = tree_event(self.code.children[number].address, TreeEventKind.HALT_RESPONSE)
                transitions += self.on(event, place, dict(fixed))
            case _Asking(place, fixed, entries):
                body = []
                for entry in entries:
                    self.declare(entry.local, TYPES[entry.kind], entry.zero)
                    body.append(Assign(name(entry.local), entry.read(event_data(entry.variable)), self.code.origin))
                transitions += self.on(answer_of(self.code.tree), place, dict(fixed), body=body)
            case _Deciding(place, fixed):
                transitions += self.on(None, place, dict(fixed))
            case _Exception():
                pass
        return State(state, (), (), tuple(transitions), self.code.origin)

    @property
    def has_conditions(self) -> bool:
        return any(script.startswith("_") for script in self.code.scripts)

    def event(self, kind: TreeEventKind) -> ScxmlEvent:
        return tree_event(self.code.address, kind)

    def on_halt(self, fixed: dict[str, Known]) -> list[Transition]:
        if fixed["status"] == RUNNING:
            return self.on(self.event(TreeEventKind.HALT), ("halt", 0), fixed)
        if self.code.program.name in MACHINES and fixed[_TOUCHED]:
            return self.on(self.event(TreeEventKind.HALT), ("halt", 0), {**fixed, _ENDED: True})
        target = self.rest({**fixed, "status": IDLE})
        answer = Send(self.event(TreeEventKind.HALT_RESPONSE), (), self.code.origin)
        return [
            Transition(
                self.event(TreeEventKind.HALT),
                None,
                (Target(target, 1.0, (answer,), self.code.origin),),
                self.code.origin,
            )
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
        """The transitions on an event, which execute the code from `place` to the next states."""
        origin = self.code.origin
        return [
            Transition(event, guard, targets, origin)
            for guard, targets in self.alternatives(_Execution(place, fixed, list(body)), cond)
        ]

    def alternatives(self, execution: _Execution, cond: Expr | None) -> list[tuple[Expr | None, tuple[Target, ...]]]:
        """The conditions and targets of the transitions that continue an execution. A condition becomes the condition
        of a transition only if no statement precedes it; otherwise it is decided in a separate state."""
        stop = self.run(execution)
        match stop:
            case _Decision(test, yes, no) if not execution.body:
                return [
                    *self.alternatives(_Execution(yes, dict(execution.fixed), []), both(cond, test)),
                    *self.alternatives(_Execution(no, dict(execution.fixed), []), both(cond, negated(test))),
                ]
            case Draw(probability, yes, no):
                targets = []
                for share, place in ((probability, yes), (1 - probability, no)):
                    if share > 0:
                        branch = _Execution(place, dict(execution.fixed), list(execution.body))
                        targets.append(self.single(branch, share))
                return [(cond, tuple(targets))]
        return [(cond, (self.target(execution, stop, 1.0),))]

    def single(self, execution: _Execution, share: float) -> Target:
        return self.target(execution, self.run(execution), share)

    def target(self, execution: _Execution, stop: _Stop, share: float) -> Target:
        # A condition after statements is decided in a separate state.
        later = _Deciding(execution.place, self.needed(execution.place, execution.fixed))
        state = stop if isinstance(stop, str) else self.state("deciding", later)
        return Target(state, share, tuple(execution.body), self.code.origin)

    def run(self, execution: _Execution) -> _Stop:
        """Execute instructions until the node must wait for an event, or until a condition or chance decides how it
        continues. `execution.place` is then the instruction at which the execution stopped.

        Returns:
            The name of the state that is reached, or the decision with the places at which the execution continues.
        """
        while True:
            segment, index = execution.place
            if execution.place == EXCEPTION:
                return self.state("exception", _Exception())
            code = self.segments[segment]
            if index >= len(code):
                state = self.end(segment, execution)
                if state is not None:
                    return state
                continue
            instruction = code[index]
            if isinstance(instruction, (ReadEntries, Update, Decide, Draw)):
                stop = self.step(instruction, execution)
            else:
                stop = self.execute(instruction, (segment, index + 1), execution)
            if stop is not None:
                return stop

    def end(self, segment: str, execution: _Execution) -> str | None:
        """Continue after the end of a segment. Return the name of the reached state, or `None` if `execution.place` is
        the beginning of the next segment."""
        match segment:
            case "before":
                execution.place = ("tick", 0)
            case "halt":
                execution.fixed["status"] = IDLE
                if execution.fixed.pop(_ENDED, False):
                    execution.body.append(Send(self.event(TreeEventKind.HALT_RESPONSE), (), self.code.origin))
                    return self.rest(execution.fixed)
                execution.place = ("halted", 0)
            case "halted":
                if execution.fixed.pop(_SKIPS, False):
                    execution.fixed[RESULT] = SKIPPED
                    execution.place = ("after", 0)
                    return None
                execution.body.append(Send(self.event(TreeEventKind.HALT_RESPONSE), (), self.code.origin))
                return self.rest(execution.fixed)
            case "after":
                return self.answer(execution)
            case _:
                raise AssertionError(f"{self.code.program.name} does not return")
        return None

    def answer(self, execution: _Execution) -> str:
        result = int(execution.fixed.pop(RESULT))
        if result < SKIPPED:
            execution.fixed["status"] = result
        elif execution.fixed["status"] != IDLE:
            result = HELD
        self.answers.add(result)
        status = Param("status", integer(result), self.code.origin)
        execution.body.append(Send(self.event(TreeEventKind.RESPONSE), (status,), self.code.origin))
        return self.rest(execution.fixed)

    def execute(self, instruction: Instruction, following: Place, execution: _Execution) -> _Stop | None:
        """Execute one instruction. Return the reason to stop, or `None` if the execution continues at
        `execution.place`."""
        segment = following[0]

        def at(label: CodeLabel) -> Place:
            return (segment, label.index)

        match instruction:
            case assembly.SetVariable():
                self.assign(instruction, execution)
            case assembly.Jump(label):
                following = at(label)
            case assembly.Test(condition, otherwise):
                value = self.values.value(condition, execution.fixed)
                if not isinstance(value, (bool, int, float, str)):
                    return _Decision(value, following, at(otherwise))
                following = following if value else at(otherwise)
            case assembly.Choose(expression, otherwise):
                probability = float(self.values.number(expression, execution.fixed))
                if 0 < probability < 1:
                    return Draw(probability, following, at(otherwise))
                following = following if probability >= 1 else at(otherwise)
            case assembly.TickChild(child, target):
                return self.tick(int(self.values.number(child, execution.fixed)), target, following, execution)
            case assembly.Reset(child):
                state = self.reset(int(self.values.number(child, execution.fixed)), following, execution)
                if state is not None:
                    return state
            case assembly.Return(status):
                execution.fixed[RESULT] = int(self.values.number(status, execution.fixed))
                following = ("after", 0)
            case assembly.Read(ports):
                following = self.read_ports(ports, following)
            case assembly.Write(port, expression):
                self.write_port(port, self.values.value(expression, execution.fixed), execution)
            case assembly.Evaluate(script, label):
                no = None if label is None else at(label)
                following = self.evaluate(script, following, no)
            case assembly.Updated(otherwise):
                if self.code.updated is None:
                    following = at(otherwise)
                else:
                    following = self.read_update(self.code.updated, following, at(otherwise))
            case assembly.WriteOutputs():
                following = self.write_outputs(following)
            case assembly.HaltSelf():
                execution.fixed[_SKIPS] = True
                following = ("halt", 0)
            case assembly.Count(counter):
                if self.code.counts:
                    self.declare(counter, BASE_TYPES["int32"], integer(0))
                    increased = binary(name(counter), Operator.ADD, integer(1))
                    execution.body.append(Assign(name(counter), increased, self.code.origin))
            case assembly.ResetAll():
                pass  # the following instructions reset the children
            case assembly.Throw():
                following = EXCEPTION
        execution.place = following
        return None

    def assign(self, instruction: assembly.SetVariable, execution: _Execution) -> None:
        value = self.values.value(instruction.value, execution.fixed)
        target = instruction.target
        if instruction.element is not None:
            target = f"{target}_{self.values.number(instruction.element, execution.fixed)}"
        if target in self.declared:
            execution.body.append(Assign(name(target), expr(value), self.code.origin))
        else:
            assert isinstance(value, (bool, int, float, str)), target
            execution.fixed[target] = value

    def tick(self, number: int, target: str, following: Place, execution: _Execution) -> str:
        child = self.code.children[number]
        execution.body.append(Send(tree_event(child.address, TreeEventKind.TICK), (), child.origin))
        execution.fixed[_TOUCHED] = self.merged(int(execution.fixed[_TOUCHED]), number)
        execution.fixed.pop(target, None)
        return self.state("ticking", _Ticking(following, self.needed(following, execution.fixed), number, target))

    def merged(self, touched: int, number: int) -> int:
        """The touched children when the child `number` is ticked; whether it is one of them itself follows from its
        answer. Children before it and before a touched child that can be skipped become touched too, because the number
        of states would grow exponentially with the number of children that were skipped or not. The halt of a child
        that is IDLE has no effect."""
        last = max(number, touched.bit_length() - 1)
        return (touched | self.skippable & ((1 << last) - 1)) & ~(1 << number)

    def reset(self, number: int, following: Place, execution: _Execution) -> str | None:
        child = self.code.children[number]
        touched = int(execution.fixed[_TOUCHED])
        execution.fixed[_TOUCHED] = touched & ~(1 << number)
        if not touched & (1 << number):
            return None
        execution.body.append(Send(tree_event(child.address, TreeEventKind.HALT), (), child.origin))
        return self.state("halting", _Halting(following, self.needed(following, execution.fixed), number))

    # -------------------------------------------------------------- blackboard

    def read_entries(self, entries: tuple[BoardEntry, ...], following: Place, execution: _Execution) -> str:
        execution.body.append(Send(request_of(self.code.tree), (), self.code.origin))
        return self.state("asking", _Asking(following, self.needed(following, execution.fixed), entries))

    def write(self, entry: BoardEntry, value: Expr, execution: _Execution) -> None:
        origin = self.code.origin
        execution.body.append(
            Send(blackboard_write(entry.variable), (Param("value", entry.written(value), origin),), origin)
        )

    def write_port(self, port: str, value: Value, execution: _Execution) -> None:
        if port in self.code.bound:
            self.write(self.code.bound[port], expr(value), execution)
        for flag in self.code.flags_at.get(port, ()):
            self.write(flag, integer(1), execution)

    def read_update(self, flag: BoardEntry, following: Place, otherwise: Place) -> Place:
        return self.added(
            f"*updated*{following}", lambda key: update_steps(key, flag, following, otherwise), following, otherwise
        )

    def read_ports(self, ports: Sequence[str], following: Place) -> Place:
        entries = tuple(self.code.bound[port] for port in ports if port in self.code.bound)
        whole = tuple(self.code.bound[port] for port in ports if port in self.code.whole)
        if not entries:
            return following
        return self.added(f"*ports*{following}", lambda key: port_steps(key, entries, whole, following), following)

    def write_outputs(self, following: Place) -> Place:
        return self.added(
            f"*outputs*{following}", lambda key: output_steps(key, self.code.outputs, following), following
        )

    def evaluate(self, script: str, following: Place, otherwise: Place | None) -> Place:
        compiled = self.code.scripts[script]
        continued = (following,) if otherwise is None else (following, otherwise)
        return self.added(
            f"*{script}*{following}", lambda key: script_steps(key, compiled, following, otherwise), *continued
        )

    def added(self, segment: str, steps: Callable[[str], tuple[Step, ...]], *continued: Place) -> Place:
        """The place at the beginning of a segment. If the segment does not exist yet, `steps` creates it. The execution
        continues at one of the places `continued` after it."""
        if segment not in self.segments:
            self.segments[segment] = steps(segment)
            self.continued[segment] = continued
        return (segment, 0)

    def needed(self, place: Place, fixed: Mapping[str, Known]) -> Fixed:
        """The variables in `fixed` that may be read when the execution continues at `place`."""
        places = self.continued.get(place[0], (place,))
        live = frozenset[str]().union(*(self.live[each] for each in places if each != EXCEPTION))
        return _frozen({name: value for name, value in fixed.items() if name in live or name.startswith("*")})

    def step(self, step: Step, execution: _Execution) -> _Stop | None:
        """Execute one step. Return the reason to stop, or `None` if the execution continues at `execution.place`."""
        segment, index = execution.place
        match step:
            case ReadEntries(entries):
                return self.read_entries(entries, (segment, index + 1), execution)
            case Update(assignments, writes):
                for local, value in assignments:
                    execution.body.append(Assign(name(local), value, self.code.origin))
                for entry in writes:
                    self.declare(entry.local, TYPES[entry.kind], entry.zero)
                    self.write(entry, name(entry.local), execution)
                execution.place = (segment, index + 1)
            case Decide(condition, yes, no):
                if not isinstance(condition, bool):
                    return _Decision(condition, yes, no)
                execution.place = yes if condition else no
            case Draw(probability, yes, no):
                if probability < 1:
                    return step
                execution.place = yes
        return None


def _frozen(fixed: Mapping[str, Known]) -> Fixed:
    return tuple(sorted(fixed.items()))
