# SPDX-License-Identifier: Apache-2.0
"""The statuses that a node can return, and what it does with its children, computed from its program
(docs/spec/lone-trees.md#statuses).

The program is executed with all answers of the children, all outcomes of conditions that depend on the blackboard, on
scripts, on the world or on time, and all sequences of ticks and halts. So the results contain everything that can
happen, and possibly more. Variables that are known during a translation keep their values; variables of the automaton
keep the values that are assigned to them, until the program computes with them.
"""

from __future__ import annotations

import ast
import functools
import operator
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias

from roaml.exhaustive import assert_never
from roaml.interruption import checkpoint
from roaml.libraries.programs import assembly
from roaml.libraries.programs.assembly import Instruction, NodeProgram
from roaml.libraries.programs.statuses import FAILURE, HELD, IDLE, RUNNING, SKIPPED, STATUS_CODES, SUCCESS, Known
from roaml.record import Record, field

Answers: TypeAlias = "frozenset[int]"
"""Statuses that a node can return: SUCCESS, FAILURE, RUNNING and SKIPPED, as codes."""

ANY_ANSWER: Answers = frozenset((SUCCESS, FAILURE, RUNNING, SKIPPED))

MAX_DECISIONS = 5_000
"""The maximum number of situations in which the execution of a program can continue in several ways. A node with more,
which has many children, is assumed to do anything."""

MAX_SIBLINGS = 6
"""The maximum number of siblings before a child, and after it, that `effects_on` distinguishes. Without this limit, its
costs for all children of a node grow with the square of their number."""


class Situation(Record, frozen=True):
    """What is known about a node before the tree is executed.

    Attributes:
        answers: the statuses that each child can return.
        first: the statuses that each child can return when it is ticked for the first time.
        ports: ports with constant values, sorted by name.
        scripts: the names of its conditions and scripts.
    """

    answers: tuple[Answers, ...]
    first: tuple[Answers, ...]
    ports: tuple[tuple[str, Known], ...] = ()
    scripts: frozenset[str] = frozenset()


class Effects(Record, frozen=True):
    """What a node may do.

    Attributes:
        answers: the statuses that it can return.
        first: the statuses that it can return at its first tick.
        ticked: the indices of the children that it can tick.
        fatal: the indices of the children that must not be skipped, because the library throws an exception then.
    """

    answers: Answers
    first: Answers
    ticked: frozenset[int]
    fatal: frozenset[int]


class ChildEffects(Record, frozen=True):
    """What a node may do with one of its children until it returns SUCCESS or FAILURE itself.

    Attributes:
        ticks_ended: whether it may tick the child again after the child has ended.
        restarts: whether it may tick the child again after the child has ended, or after it has halted the child.
        halts: the statuses (RUNNING, and SUCCESS for a child that has ended) in which it may halt the child although it
            is not halted itself.
        passes_halts: the statuses in which it halts the child when it is halted itself while it is RUNNING.
    """

    ticks_ended: bool
    restarts: bool
    halts: Answers
    passes_halts: Answers


ALL_EFFECTS = ChildEffects(True, True, frozenset((RUNNING, SUCCESS)), frozenset((RUNNING, SUCCESS)))


@functools.lru_cache(maxsize=4096)
def effects(program: NodeProgram, situation: Situation) -> Effects:
    """What a node with a program may do."""
    run = _Run(program, situation, None)
    if not run.explore():
        return Effects(ANY_ANSWER, ANY_ANSWER, frozenset(range(len(situation.answers))), frozenset())
    first = _Run(program, situation, None, is_first=True)
    first.explore_first()
    return Effects(frozenset(run.returned), frozenset(first.returned), frozenset(run.ticked), frozenset(run.fatal))


def effects_on(program: NodeProgram, situation: Situation, child: int) -> ChildEffects:
    """What a node with a program may do with the child with the index `child`."""
    return _effects_on(program, *_narrowed(situation, child))


def _narrowed(situation: Situation, child: int) -> tuple[Situation, int]:
    """A situation with few children in which a node may do with `child` what it may do in `situation`, and possibly
    more; and the index of the child in it.

    If there are many siblings before the child or after it, two children that can give all their answers replace them.
    Only nodes that treat all children alike have so many. Values of ports are omitted then, because they can be numbers
    of children.
    """
    if max(child, len(situation.answers) - child - 1) <= MAX_SIBLINGS:
        return situation, child
    answers, at = _merged(situation.answers, child)
    return Situation(answers, _merged(situation.first, child)[0], (), situation.scripts), at


def _merged(answers: tuple[Answers, ...], child: int) -> tuple[tuple[Answers, ...], int]:
    """The answers of the children of the narrowed situation, and the index of the child."""
    before, after = (
        siblings if len(siblings) <= MAX_SIBLINGS else (frozenset().union(*siblings),) * 2
        for siblings in (answers[:child], answers[child + 1 :])
    )
    return (*before, answers[child], *after), len(before)


@functools.lru_cache(maxsize=4096)
def _effects_on(program: NodeProgram, situation: Situation, child: int) -> ChildEffects:
    run = _Run(program, situation, child)
    if not run.explore():
        return ALL_EFFECTS
    return ChildEffects(run.ticks_ended, run.restarts, frozenset(run.halts), frozenset(run.passes_halts))


def constant(text: str) -> Known:
    """The value of a port that is set to a constant text."""
    text = text.strip()
    if text in STATUS_CODES:
        return STATUS_CODES[text]
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    for convert in (int, float):
        try:
            return convert(text)
        except ValueError:
            pass
    return text


# ------------------------------------------------------------------- execution


class _Unknown(Record, frozen=True):
    """A value that is not known; if `is_positive`, a number greater than 0."""

    is_positive: bool = False


_UNKNOWN, _POSITIVE = _Unknown(), _Unknown(True)
_Value: TypeAlias = "Known | _Unknown"
_Variables: TypeAlias = "dict[str, _Value]"
_Place: TypeAlias = "tuple[str, int]"

_RESULT, _SKIPS, _TICKED, _SKIPPED = "*result", "*skips", "*ticked", "*skipped"
"""The status that the program has returned; whether the node halts itself; the children that were ticked in this tick;
the child that was ticked last, if it was skipped, else -1."""
_CHILD, _DONE = "*child", "*done"
"""The status of the observed child: IDLE, RUNNING, or SUCCESS if it has ended; and whether it has ended or was halted
since the node was ticked for the first time after a reset."""


class _Run(Record, eq=False):
    """The execution of a program. `child` is the index of the observed child. If `is_first`, each child is ticked for
    the first time."""

    program: NodeProgram
    situation: Situation
    child: int | None
    is_first: bool = False
    returned: set[int] = field(default_factory=set)
    ticked: set[int] = field(default_factory=set)
    fatal: set[int] = field(default_factory=set)
    ticks_ended: bool = False
    restarts: bool = False
    halts: set[int] = field(default_factory=set)
    passes_halts: set[int] = field(default_factory=set)
    resting: dict[frozenset[tuple[str, _Value]], None] = field(default_factory=dict)
    seen: set[tuple[_Place, frozenset[tuple[str, _Value]]]] = field(default_factory=set)
    pending: list[tuple[_Place, _Variables]] = field(default_factory=list)
    segments: dict[str, tuple[Instruction, ...]] = field(default_factory=dict)
    declared: frozenset[str] = frozenset()
    ports: dict[str, Known] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.segments = assembly.segments(self.program, self.situation.scripts)
        self.declared = frozenset(self.program.variables)
        self.ports = dict(self.situation.ports)

    # ------------------------------------------------------------ explorations

    def explore(self) -> bool:
        """Execute all sequences of ticks and halts. Return whether the exploration was completed."""
        start: _Variables = {"status": IDLE, **self.program.fixed, **self.program.variables}
        if self.child is not None:
            start |= {f"{flag}_{self.child}": False for flag in self.program.flags}
            start |= {_CHILD: IDLE, _DONE: False}
        self.rest(start)
        return self.finish()

    def explore_first(self) -> None:
        """Execute the first tick of the node."""
        start: _Variables = {"status": IDLE, **self.program.fixed, **self.program.variables}
        self.pending = [(("before", 0), {**start, _TICKED: 0})]
        self.finish()

    def finish(self) -> bool:
        while self.pending and len(self.seen) <= MAX_DECISIONS:
            checkpoint()
            place, variables = self.pending.pop()
            self.execute(place, variables)
        return not self.pending

    def rest(self, variables: _Variables) -> None:
        """The node waits for its parent, which may tick, halt or reset it."""
        if self.is_first:
            return
        kept = {name: value for name, value in variables.items() if name in _KEPT or self.is_kept(name)}
        state = frozenset(kept.items())
        if state not in self.resting:
            self.resting[state] = None
            self.pending.append((("before", 0), kept))
            if kept["status"] == RUNNING:
                self.pending.append((("halt", 0), dict(kept)))
            elif kept["status"] != IDLE:
                self.rest({**kept, "status": IDLE})

    def is_kept(self, name: str) -> bool:
        return name in self.declared or name in self.program.fixed or name.startswith(self.program.flags)

    def execute(self, place: _Place, variables: _Variables) -> None:
        """Execute instructions until the execution can continue in several ways, or until the node waits."""
        while True:
            segment, index = place
            code = self.segments[segment]
            if index < len(code):
                following = list(self.step(code[index], place, variables))
            else:
                following = [(after, variables) for after in self.end(segment, variables)]
            if len(following) != 1:
                for after, changed in following:
                    key = after, frozenset(changed.items())
                    if key not in self.seen:
                        self.seen.add(key)
                        self.pending.append((after, changed))
                return
            place, variables = following[0]

    def end(self, segment: str, variables: _Variables) -> Iterator[_Place]:
        """The place at which the execution continues after the end of a segment; none if the node waits."""
        match segment:
            case "before":
                yield "tick", 0
            case "halt":
                variables["status"] = IDLE
                yield "halted", 0
            case "halted":
                if variables.pop(_SKIPS, False):
                    variables[_RESULT] = SKIPPED
                    yield "after", 0
                else:
                    self.rest({**variables, **self.without_history})
            case _:
                result = variables.pop(_RESULT)
                assert isinstance(result, int)
                self.returned.add(min(result, SKIPPED))
                has_ended = result in (SUCCESS, FAILURE)
                status = variables["status"] if result >= SKIPPED else result
                self.rest({**variables, "status": status, **(self.without_history if has_ended else {})})

    @property
    def without_history(self) -> _Variables:
        return {} if self.child is None else {_DONE: False}

    # ------------------------------------------------------------ instructions

    def step(
        self, instruction: Instruction, place: _Place, variables: _Variables
    ) -> Iterator[tuple[_Place, _Variables]]:
        """The places at which the execution may continue after an instruction, each with the variables."""
        segment, index = place
        following = segment, index + 1
        match instruction:
            case assembly.SetVariable():
                self.assign(instruction, variables)
            case assembly.Jump(label):
                following = segment, label.index
            case assembly.Test(condition, otherwise):
                yield from self.decided(
                    self.value(condition, variables), following, (segment, otherwise.index), variables
                )
                return
            case assembly.Choose(_, otherwise) | assembly.Updated(otherwise):
                yield from self.decided(_UNKNOWN, following, (segment, otherwise.index), variables)
                return
            case assembly.Evaluate(_, label):
                otherwise_at = following if label is None else (segment, label.index)
                yield from self.decided(_UNKNOWN, following, otherwise_at, variables)
                return
            case assembly.ResetAll(but, end):
                if self.child is not None and (but is None or self.number(but, variables) != self.child):
                    self.reset(segment, variables)
                following = segment, end.index
            case assembly.Reset(child):
                if self.number(child, variables) == self.child:
                    self.reset(segment, variables)
            case assembly.TickChild(child, target):
                yield from self.tick(self.number(child, variables), target, following, variables)
                return
            case assembly.Return(status):
                yield from self.returns(self.value(status, variables), variables)
                return
            case assembly.HaltSelf():
                variables[_SKIPS] = True
                following = "halt", 0
            case assembly.Throw():
                skipped = variables.get(_SKIPPED)
                self.fatal |= {skipped} if isinstance(skipped, int) else set()
                return
            case assembly.Read() | assembly.Write() | assembly.WriteOutputs() | assembly.Count():
                pass
            case _:
                assert_never(instruction)
        yield following, variables

    def decided(
        self, value: _Value, yes: _Place, no: _Place, variables: _Variables
    ) -> Iterator[tuple[_Place, _Variables]]:
        if isinstance(value, _Unknown):
            yield yes, dict(variables)
            if no != yes:
                yield no, dict(variables)
        else:
            yield (yes if value else no), variables

    def tick(
        self, child: int, target: str, following: _Place, variables: _Variables
    ) -> Iterator[tuple[_Place, _Variables]]:
        self.ticked.add(child)
        if child == self.child:
            self.ticks_ended |= variables[_CHILD] == SUCCESS
            self.restarts |= bool(variables[_DONE])
        for answer in sorted(self.answers(child, variables)):
            for code in (SKIPPED, HELD) if answer == SKIPPED else (answer,):
                after = {**variables, target: code, _SKIPPED: child if code >= SKIPPED else -1}
                if child == self.child:
                    ends = code in (SUCCESS, FAILURE)
                    # A node that is skipped and not IDLE is usually RUNNING.
                    after[_CHILD] = SUCCESS if ends else IDLE if code == SKIPPED else RUNNING
                    after[_DONE] = ends or bool(variables[_DONE])
                yield following, after

    def answers(self, child: int, variables: _Variables) -> Answers:
        every = self.situation.answers[child]
        if not self.is_first:
            return every
        ticked = variables[_TICKED]
        assert isinstance(ticked, int)
        variables[_TICKED] = ticked | 1 << child
        return every if ticked >> child & 1 else self.situation.first[child]

    def returns(self, status: _Value, variables: _Variables) -> Iterator[tuple[_Place, _Variables]]:
        results = [status] if isinstance(status, int) else sorted(ANY_ANSWER)
        for result in results:
            yield ("after", 0), {**variables, _RESULT: result}

    def reset(self, segment: str, variables: _Variables) -> None:
        """Reset the observed child."""
        status = variables[_CHILD]
        if status != IDLE:
            assert isinstance(status, int)
            is_own = segment != "halt" or bool(variables.get(_SKIPS))
            (self.halts if is_own else self.passes_halts).add(status)
            variables |= {_CHILD: IDLE, _DONE: True}

    def assign(self, instruction: assembly.SetVariable, variables: _Variables) -> None:
        value, target = self.value(instruction.value, variables), instruction.target
        if instruction.element is not None:
            if self.number(instruction.element, variables) != self.child:
                return
            target = f"{target}_{self.child}"
        if target in self.declared and isinstance(instruction.value, ast.BinOp):
            value = _UNKNOWN
        variables[target] = value

    # ------------------------------------------------------------------ values

    def number(self, expression: ast.expr, variables: _Variables) -> int:
        value = self.value(expression, variables)
        assert isinstance(value, int), ast.unparse(expression)
        return value

    def value(self, expression: ast.expr, variables: _Variables) -> _Value:
        match expression:
            case ast.Name(id=name):
                return self.name(name, variables)
            case ast.Constant(value=bool() | int() | float() | str() as value):
                return value
            case ast.Compare(left=left, ops=[kind], comparators=[right]):
                return _compared(self.value(left, variables), type(kind), self.value(right, variables))
            case ast.BoolOp(op=kind, values=values):
                return self.logical([self.value(v, variables) for v in values], isinstance(kind, ast.And))
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                negated = self.value(operand, variables)
                return negated if isinstance(negated, _Unknown) else not negated
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.number(operand, variables)
            case ast.BinOp(left=left, op=kind, right=right):
                return _computed(self.value(left, variables), type(kind), self.value(right, variables))
            case ast.Subscript(value=ast.Name(id=name), slice=element):
                return variables.get(f"{name}_{self.number(element, variables)}", _UNKNOWN)
            case ast.Call(func=ast.Name(id="ticks"), args=[duration]):
                time = self.value(duration, variables)
                if isinstance(time, _Unknown):
                    return time
                return _POSITIVE if not isinstance(time, str) and time > 0 else 0
            case ast.Call(func=ast.Name(id="maximum"), args=[first, second]):
                one, other = self.value(first, variables), self.value(second, variables)
                are_known = isinstance(one, (int, float)) and isinstance(other, (int, float))
                return max(one, other) if are_known else _UNKNOWN  # type: ignore[type-var]
        return _UNKNOWN

    def logical(self, values: list[_Value], conjunction: bool) -> _Value:
        if any(not isinstance(value, _Unknown) and bool(value) is not conjunction for value in values):
            return not conjunction
        return _UNKNOWN if any(isinstance(value, _Unknown) for value in values) else conjunction

    def name(self, name: str, variables: _Variables) -> _Value:
        if name in STATUS_CODES:
            return STATUS_CODES[name]
        if name == "COUNT":
            return len(self.situation.answers)
        key = {"otherwise": "else", "result": _RESULT}.get(name, name)
        if key in variables:
            return variables[key]
        return self.ports.get(key, _UNKNOWN)


_KEPT = frozenset(("status", _CHILD, _DONE))
_COMPARISONS: Mapping[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_ARITHMETIC: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def _compared(left: _Value, kind: type[ast.cmpop], right: _Value) -> _Value:
    """The result of a comparison. A positive number is compared with 0 and negative numbers."""
    if left == _POSITIVE and isinstance(right, (int, float)) and right <= 0:
        return _COMPARISONS[kind](1, 0)
    if right == _POSITIVE and isinstance(left, (int, float)) and left <= 0:
        return _COMPARISONS[kind](0, 1)
    if isinstance(left, _Unknown) or isinstance(right, _Unknown) or isinstance(left, str) is not isinstance(right, str):
        return _UNKNOWN
    return _COMPARISONS[kind](left, right)


def _computed(left: _Value, kind: type[ast.operator], right: _Value) -> _Value:
    is_number = isinstance(left, (int, float)) and isinstance(right, (int, float))
    if not is_number or (kind is ast.Div and right == 0):
        return _UNKNOWN
    result: Known = _ARITHMETIC[kind](left, right)
    return result
