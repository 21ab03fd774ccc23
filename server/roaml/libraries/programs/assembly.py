# SPDX-License-Identifier: Apache-2.0
"""Compiles the programs of nodes to instructions (docs/spec/mocks.md#nodes).

A program is a class in the syntax of Python. The comment at the top of `definitions/behaviortree_cpp.txt` describes its
statements. Python does not execute a program: its syntax tree is compiled.
"""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Iterator, Mapping
from typing import TypeAlias

from roaml.disk import path_of_resource, resource
from roaml.libraries import BEHAVIORTREE_CPP, Node, library
from roaml.libraries.version import NEWEST_VERSION, Version, first_patch
from roaml.record import Record, astuple, field
from roaml.regex import regex
from roaml.text import Location, Span

FILES = ("behaviortree_cpp.txt", "nav2.txt", "leaves.txt")

_BEFORE = """
if status == IDLE:
    if script("_failureIf"):
        return FAILURE
    if script("_successIf"):
        return SUCCESS
    if script("_skipIf"):
        return SKIPPED
    if not script("_while"):
        return SKIPPED
else:
    if status == RUNNING:
        if not script("_while"):
            halt_self()
"""
_AFTER = """
if result == SUCCESS:
    script("_onSuccess")
if result == FAILURE:
    script("_onFailure")
if result == SUCCESS or result == FAILURE:
    script("_post")
"""


class CodeLabel:
    """The target of jumps in a list of instructions. `index` is the index of the instruction that follows the label; it
    is -1 until the label is placed."""

    index = -1


class SetVariable(Record, frozen=True):
    """Assigns `value` to the variable `target`; if `element` is not `None`, to the variable for the child with this
    number."""

    target: str
    element: ast.expr | None
    value: ast.expr


class Jump(Record, frozen=True):
    label: CodeLabel


class Test(Record, frozen=True):
    """Jumps to `otherwise` if the condition does not hold."""

    condition: ast.expr
    otherwise: CodeLabel


class Choose(Record, frozen=True):
    """Continues with the probability `probability`; otherwise jumps to `otherwise`."""

    probability: ast.expr
    otherwise: CodeLabel


class TickChild(Record, frozen=True):
    """Ticks a child, and assigns the code of its answer to `target`."""

    child: ast.expr
    target: str


class Reset(Record, frozen=True):
    """Halts a child if it is running, and makes it IDLE."""

    child: ast.expr


class ResetAll(Record, frozen=True):
    """Precedes the instructions up to `end`, which reset all children; all except the child `but` if that is not
    `None`."""

    but: ast.expr | None
    end: CodeLabel


class Return(Record, frozen=True):
    status: ast.expr


class Evaluate(Record, frozen=True):
    """Executes a script of the node, and jumps to `otherwise` if this is not `None` and the value of the script is
    false."""

    script: str
    otherwise: CodeLabel | None


class Updated(Record, frozen=True):
    """Jumps to `otherwise` if the observed entry was not written since the last execution of this instruction."""

    otherwise: CodeLabel


class WriteOutputs(Record, frozen=True):
    """Writes the outputs of a mock."""


class HaltSelf(Record, frozen=True):
    """Halts the node itself. Its tick is answered with SKIPPED."""


class Read(Record, frozen=True):
    """Reads the entries to which `ports` are bound."""

    ports: tuple[str, ...]


class Write(Record, frozen=True):
    """Writes `value` to the entry to which a port is bound."""

    port: str
    value: ast.expr


class Count(Record, frozen=True):
    """Increments a counter that only measurements use."""

    counter: str


class Throw(Record, frozen=True):
    """The library throws an exception."""

    reason: str


Instruction: TypeAlias = (
    SetVariable
    | Jump
    | Test
    | Choose
    | TickChild
    | Reset
    | ResetAll
    | Return
    | Evaluate
    | Updated
    | WriteOutputs
    | HaltSelf
    | Read
    | Write
    | Count
    | Throw
)


class NodeProgram(Record, frozen=True, eq=False, dict=True):
    """The program of a node.

    Attributes:
        name: the name of the node.
        fixed: variable whose value is known during the translation -> its initial value.
        variables: variable of the automaton -> its initial value.
        flags: the names of the variables that exist once for each child.
        tick, halt: the instructions that are executed when the node is ticked, and when it is halted while it is
            RUNNING.
        is_stateless: whether resetting the node has no effect.
    """

    name: str
    fixed: Mapping[str, int | bool]
    variables: Mapping[str, int | bool]
    flags: tuple[str, ...]
    tick: tuple[Instruction, ...]
    halt: tuple[Instruction, ...]
    is_stateless: bool

    @functools.cached_property
    def needed_ports(self) -> tuple[str, ...]:
        """The ports that the program reads when it is ticked. They must be set."""
        return tuple(dict.fromkeys(port for part in self.tick if isinstance(part, Read) for port in part.ports))

    @functools.cached_property
    def read_ports(self) -> frozenset[str]:
        return frozenset(port for part in walk(self) if isinstance(part, Read) for port in part.ports)

    @functools.cached_property
    def written_ports(self) -> frozenset[str]:
        return frozenset(part.port for part in walk(self) if isinstance(part, Write))

    @functools.cached_property
    def timed_ports(self) -> frozenset[str]:
        """The ports that contain times in ms, which the program converts to ticks."""
        values = (value for part in self.tick for value in astuple(part) if isinstance(value, ast.expr))
        calls = (call for value in values for call in ast.walk(value) if isinstance(call, ast.Call))
        ports = (call.args[0] for call in calls if isinstance(call.func, ast.Name) and call.func.id == "ticks")
        return frozenset(port.id for port in ports if isinstance(port, ast.Name))

    @functools.cached_property
    def conditions(self) -> frozenset[str]:
        """The ports that contain scripts whose values are used as conditions."""
        scripts = (part for part in walk(self) if isinstance(part, Evaluate))
        return frozenset(part.script for part in scripts if part.otherwise is not None)

    @functools.cached_property
    def observes(self) -> bool:
        """Whether the program depends on whether an entry was written."""
        return any(isinstance(part, Updated) for part in walk(self))

    @functools.cached_property
    def reads_world(self) -> bool:
        """Whether the program depends on an event in the world (docs/spec/mocks.md#world)."""
        choices = (part.probability for part in self.tick if isinstance(part, Choose))
        return any(isinstance(probability, ast.Name) and probability.id == "event" for probability in choices)


class Programs(Mapping[str, NodeProgram]):
    """The programs of a version of BehaviorTree.CPP by the names of the nodes. A program is compiled when it is used
    for the first time."""

    def __init__(self, version: Version) -> None:
        self._texts: list[str] = []
        self._places: dict[str, list[int]] = {}
        self._compiled: dict[int, NodeProgram] = {}
        for file in FILES:
            text = resource(__package__, "definitions", file)
            for match in _CLASS.finditer(text):
                if match["before"] is None or version < first_patch(match["before"]):
                    self._places.setdefault(match["name"], []).append(len(self._texts))
                    self._texts.append(match["text"])

    def __getitem__(self, name: str) -> NodeProgram:
        return self._at(self._places[name][-1])

    def __contains__(self, name: object) -> bool:
        return name in self._places

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def _at(self, place: int) -> NodeProgram:
        """The program whose text has the index `place`. Its base class is the last one before it with that name."""
        if place not in self._compiled:
            (definition,) = ast.parse(self._texts[place]).body
            assert isinstance(definition, ast.ClassDef)
            bases = [base.id for base in definition.bases if isinstance(base, ast.Name)]
            before = [known for name in bases for known in self._places[name] if known < place]
            self._compiled[place] = _program(definition, self._at(before[-1]) if before else None)
        return self._compiled[place]


_CLASS = regex(
    r'^(?:@before\("(?P<before>[0-9.]+)"\)\n)?(?P<text>class (?P<name>\w+).*\n(?:(?:[ ].*)?\n)*)', re.MULTILINE
)
"""The definition of a program in a file. The decorator `before` restricts it to older versions."""


@functools.cache
def programs(version: Version = NEWEST_VERSION) -> Programs:
    """Name of a node -> its program in a version of BehaviorTree.CPP."""
    return Programs(version)


def is_executable(name: str, known: Node | None, version: Version = NEWEST_VERSION) -> bool:
    """Whether nodes with a type have a program in a version of BehaviorTree.CPP.

    Args:
        known: the declaration of the type; `None` if there is none. A model can declare another node with the name of
            one of a library.
    """
    return known is not None and bool(known.behaviour) and name in programs(version)


def reads_world(name: str) -> bool:
    """Whether a node of a library depends on events of the world (docs/spec/mocks.md#world)."""
    return name in programs() and programs()[name].reads_world


def program_place(name: str) -> Location | None:
    """The place of the program of a node of a library; `None` if there is none."""
    renamed = library(BEHAVIORTREE_CPP).renamed.get(name)
    for file in FILES:
        text = resource(__package__, "definitions", file)
        match = re.search(rf"^class ({re.escape(renamed.now if renamed else name)})\b", text, re.M)
        if match is not None:
            return Location(path_of_resource(__package__, "definitions", file), Span(*match.span(1)))
    return None


def segments(program: NodeProgram, given: frozenset[str]) -> dict[str, tuple[Instruction, ...]]:
    """The instructions of a node that has the conditions and scripts `given` (docs/spec/mocks.md#conditions): before
    its tick, of the tick, after it, of a halt, and after the halt."""
    return {
        "before": _around(_BEFORE, given),
        "tick": program.tick,
        "after": _around(_AFTER, given),
        "halt": program.halt,
        "halted": _around('script("_onHalted")', given),
    }


@functools.cache
def _around(text: str, given: frozenset[str]) -> tuple[Instruction, ...]:
    return _Assembler(given).function(ast.parse(text).body)


def _program(definition: ast.ClassDef, base: NodeProgram | None) -> NodeProgram:
    """The program that a class defines. A class with a base class has the statements of the base, and may set other
    initial values."""
    fixed = dict(base.fixed) if base else {}
    variables = dict(base.variables) if base else {}
    flags = list(base.flags) if base else []
    bodies: dict[str, tuple[Instruction, ...]] = {"tick": base.tick, "halt": base.halt} if base else {}
    is_stateless = base is not None and base.is_stateless
    for statement in definition.body:
        match statement:
            case ast.FunctionDef(name=name, body=body):
                bodies[name] = _Assembler().function(body)
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id="variable"), args=[value])):
                variables[name] = _constant(value)
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id="flags"))):
                flags.append(name)
            case ast.Assign(targets=[ast.Name(id="stateless")]):
                is_stateless = True
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                fixed[name] = _constant(value)
            case ast.Pass():
                pass
            case _:
                raise AssertionError(ast.dump(statement))
    halt = bodies.get("halt", _Assembler().function(ast.parse("reset_all()").body))
    return NodeProgram(definition.name, fixed, variables, tuple(flags), bodies["tick"], halt, is_stateless)


def _constant(value: ast.expr) -> int | bool:
    constant = ast.literal_eval(value)
    assert isinstance(constant, (int, bool))
    return constant


class _Assembler(Record):
    """Compiles the statements of one function. `given` contains the scripts that the node has; `None` means all
    scripts."""

    given: frozenset[str] | None = None
    instructions: list[Instruction] = field(default_factory=list)
    loops: list[CodeLabel] = field(default_factory=list)

    def function(self, body: list[ast.stmt]) -> tuple[Instruction, ...]:
        self.block(body)
        return tuple(self.instructions)

    def place(self, label: CodeLabel) -> None:
        label.index = len(self.instructions)

    def block(self, body: list[ast.stmt]) -> None:
        for statement in body:
            self.statement(statement)

    def statement(self, statement: ast.stmt) -> None:
        emit = self.instructions.append
        match statement:
            case ast.Assign(targets=[ast.Name(id=target)], value=ast.Call(func=ast.Name(id="tick"), args=[child])):
                emit(TickChild(child, target))
            case ast.Assign(targets=[ast.Name(id=target)], value=value):
                emit(SetVariable(target, None, value))
            case ast.Assign(targets=[ast.Subscript(value=ast.Name(id=target), slice=element)], value=value):
                emit(SetVariable(target, element, value))
            case ast.AugAssign(target=ast.Name(id=target), op=operator, value=value):
                emit(SetVariable(target, None, ast.BinOp(ast.Name(target), operator, value)))
            case ast.If(test=test, body=body, orelse=otherwise):
                self.choice(test, body, otherwise)
            case ast.While(test=test, body=body):
                self.loop(test, body)
            case ast.Break():
                emit(Jump(self.loops[-1]))
            case ast.Return(value=ast.expr() as value):
                emit(Return(value))
            case ast.Expr(value=ast.Call(func=ast.Name(id=function), args=arguments)):
                self.call(function, arguments)
            case ast.Pass():
                pass
            case _:
                raise AssertionError(ast.dump(statement))

    def choice(self, test: ast.expr, body: list[ast.stmt], otherwise: list[ast.stmt]) -> None:
        skip, end = CodeLabel(), CodeLabel()
        match test:
            case ast.UnaryOp(op=ast.Not(), operand=ast.Call() as call):
                self.choice(call, otherwise or [ast.Pass()], body)
                return
            case ast.Call(func=ast.Name(id="script"), args=[ast.Constant(value=str(name))]):
                if self.given is not None and name not in self.given:
                    if name == "_while":
                        self.block(body)
                    return
                self.instructions.append(Evaluate(name, skip))
            case ast.Call(func=ast.Name(id="updated")):
                self.instructions.append(Updated(skip))
            case ast.Call(func=ast.Name(id="chance"), args=[probability]):
                self.instructions.append(Choose(probability, skip))
            case _:
                self.instructions.append(Test(test, skip))
        self.block(body)
        if otherwise:
            self.instructions.append(Jump(end))
        self.place(skip)
        self.block(otherwise)
        self.place(end)

    def loop(self, test: ast.expr, body: list[ast.stmt]) -> None:
        again, end = CodeLabel(), CodeLabel()
        self.place(again)
        self.instructions.append(Test(test, end))
        self.loops.append(end)
        self.block(body)
        self.loops.pop()
        self.instructions.append(Jump(again))
        self.place(end)

    def call(self, function: str, arguments: list[ast.expr]) -> None:
        emit = self.instructions.append
        names = tuple(argument.value for argument in arguments if isinstance(argument, ast.Constant))
        match function:
            case "reset":
                emit(Reset(arguments[0]))
            case "reset_all" | "reset_others":
                self.reset(arguments)
            case "read":
                emit(Read(tuple(str(name) for name in names)))
            case "write":
                emit(Write(str(names[0]), arguments[1]))
            case "count":
                emit(Count(str(names[0])))
            case "script":
                if self.given is None or names[0] in self.given:
                    emit(Evaluate(str(names[0]), None))
            case "outputs":
                emit(WriteOutputs())
            case "halt_self":
                emit(HaltSelf())
            case "throw":
                emit(Throw(str(names[0])))
            case _:
                raise AssertionError(function)

    def reset(self, arguments: list[ast.expr]) -> None:
        """Compile the reset of all children; with an argument, of all children except the one with this number."""
        text = "_k = 0\nwhile _k < COUNT:\n    reset(_k)\n    _k += 1\n"
        if arguments:
            text = text.replace("    reset(_k)", f"    if _k != {ast.unparse(arguments[0])}:\n        reset(_k)")
        end = CodeLabel()
        self.instructions.append(ResetAll(arguments[0] if arguments else None, end))
        self.block(ast.parse(text).body)
        self.place(end)


def walk(program: NodeProgram) -> Iterator[Instruction]:
    """All instructions of a program."""
    yield from program.tick
    yield from program.halt
