# SPDX-License-Identifier: Apache-2.0
"""Behavior trees executed in plain Python: a second implementation of the nodes of docs/spec/nodes.md#as2fm.

- Nothing here knows how the nodes are translated; each class is a paragraph of the specification.
- A node is ticked and halted by its parent only. Both, and the answers, are logged in the order in which they happen.
"""

from __future__ import annotations

import enum
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from typing import ClassVar, TypeAlias

from bt_trees import VARIABLES, Setup, Tree, is_reference

MAX_STEPS_PER_TICK = 2000


class Status(enum.IntEnum):
    """The numbers of docs/spec/plugins.md#status."""

    SUCCESS = 1
    FAILURE = 2
    RUNNING = 3


SUCCESS, FAILURE, RUNNING = Status

Step: TypeAlias = tuple[int, str]
"""What happens to a node: its number, and "tick", "halt", the status that it answers, or "halted"."""


class NeverEnds(Exception):  # noqa: N818 - it is an outcome, no error
    """A tick of the tree does not come to an end."""


INITIAL = {"int8": "0", "uint8": "0", "int32": "0", "uint32": "0", "bool": "false", "string": ""}
"""What a blackboard variable holds before it is written (docs/spec/trees.md#blackboard)."""


@dataclass
class World:
    """What the nodes of a tree share.

    Attributes:
        rate: of the ticks, in Hz.
        variables: the blackboard: name -> value as text.
        limit: how long the log may become.
    """

    rate: Fraction
    log: list[Step] = field(default_factory=list)
    variables: dict[str, str] = field(default_factory=lambda: {name: INITIAL[t] for name, t in VARIABLES.items()})
    limit: int = 0

    def note(self, number: int, what: str) -> None:
        if len(self.log) >= self.limit:
            raise NeverEnds
        self.log.append((number, what))

    def ticks(self, milliseconds: int) -> int:
        """So many ticks of the tree take so many ms, or more (docs/spec/nodes.md#durations)."""
        return math.ceil(milliseconds * self.rate / 1000)


def run(tree: Tree, setup: Setup) -> list[Step]:
    """All that happens in the tree until the time is over, or until the root has answered (docs/spec/trees.md#root).

    Raises:
        NeverEnds: a tick takes more steps than any sensible tree needs.
    """
    world = World(setup.rate)
    root = build(tree, world, itertools.count(1000))
    for _ in range(setup.ticks):
        world.limit = len(world.log) + MAX_STEPS_PER_TICK
        if root.tick() is not RUNNING and not setup.goes_on:
            break
    return world.log


def build(tree: Tree, world: World, numbers: Iterator[int]) -> Node:
    """The numbers are given in pre-order (docs/spec/trees.md#instances)."""
    number = next(numbers)
    children = [build(child, world, numbers) for child in tree.children]
    return Node.kinds[tree.kind](tree, world, number, children)


class Node:
    """`on_tick` and `on_halt` are what a kind of node is about.

    Attributes:
        kinds: by their names in trees.
    """

    kinds: ClassVar[dict[str, type[Node]]] = {}

    def __init_subclass__(cls, names: tuple[str, ...] | None = None) -> None:
        Node.kinds |= dict.fromkeys((cls.__name__,) if names is None else names, cls)

    def __init__(self, tree: Tree, world: World, number: int, children: list[Node]) -> None:
        self.tree = tree
        self.world = world
        self.number = number
        self.children = children
        self.reset()

    def tick(self) -> Status:
        self.world.note(self.number, "tick")
        status = self.on_tick()
        self.world.note(self.number, status.name)
        return status

    def halt(self) -> None:
        self.world.note(self.number, "halt")
        self.on_halt()
        self.world.note(self.number, "halted")

    def on_tick(self) -> Status:
        raise NotImplementedError

    def on_halt(self) -> None:
        self.halt_children()
        self.reset()

    def reset(self) -> None:
        """Forget what is remembered between ticks."""

    def halt_children(self) -> None:
        for child in self.children:
            child.halt()

    def end(self, status: Status) -> Status:
        """Halt the children, forget everything and answer."""
        self.on_halt()
        return status

    @property
    def child(self) -> Node:
        (only,) = self.children
        return only

    # ------------------------------------------------------------------- ports

    def port(self, key: str, default: str = "") -> str:
        """What the port holds now: the text of a constant, or of the value of a blackboard variable."""
        text = dict(self.tree.ports).get(key, default)
        return self.world.variables[text[1:-1]] if is_reference(text) else text

    def write(self, key: str, value: str) -> None:
        self.world.variables[dict(self.tree.ports)[key][1:-1]] = value


# ---------------------------------------------------------------------- leaves


class Scripted(Node, names=()):
    """Follows its script, over and over; halts change nothing."""

    ticked = 0

    def next(self) -> str:
        self.ticked += 1
        return self.tree.script[(self.ticked - 1) % len(self.tree.script)]


class Leaf(Scripted):
    def on_tick(self) -> Status:
        return Status(int(self.next()))


class Writer(Scripted):
    def on_tick(self) -> Status:
        self.write("to", self.next())
        return SUCCESS


class AlwaysSuccess(Node):
    def on_tick(self) -> Status:
        return SUCCESS


class AlwaysFailure(Node):
    def on_tick(self) -> Status:
        return FAILURE


class SetBlackboard(Node):
    def on_tick(self) -> Status:
        self.write("output_key", self.port("value"))
        return SUCCESS


# --------------------------------------------------------------- control nodes


class Sequence(Node):
    """Resumes at the child that is running."""

    passed, stopping = SUCCESS, FAILURE

    def reset(self) -> None:
        self.at = 0

    def on_tick(self) -> Status:
        while self.at < len(self.children):
            status = self.children[self.at].tick()
            if status is RUNNING:
                return RUNNING
            if status is self.stopping:
                return self.end(status)
            self.at += 1
        return self.end(self.passed)


class Fallback(Sequence):
    passed, stopping = FAILURE, SUCCESS


class SequenceWithMemory(Sequence, names=("SequenceWithMemory", "SequenceStar")):
    """A child that failed is halted alone, and tried again."""

    def on_tick(self) -> Status:
        while self.at < len(self.children):
            status = self.children[self.at].tick()
            if status is RUNNING:
                return RUNNING
            if status is FAILURE:
                self.children[self.at].halt()
                return FAILURE
            self.at += 1
        return self.end(SUCCESS)


class ReactiveSequence(Node):
    """Begins at the first child at every tick."""

    passed, stopping = SUCCESS, FAILURE

    def on_tick(self) -> Status:
        for child in self.children:
            status = child.tick()
            if status is RUNNING:
                for other in self.children:
                    if other is not child:
                        other.halt()
                return RUNNING
            if status is self.stopping:
                return self.end(status)
        return self.end(self.passed)


class ReactiveFallback(ReactiveSequence):
    passed, stopping = FAILURE, SUCCESS


class Parallel(Node):
    """Ticks the children that have not ended, and counts after each child (docs/spec/nodes.md#control)."""

    def reset(self) -> None:
        self.answers: dict[int, Status] = {}

    def count_of(self, name: str, older_name: str, default: str) -> int:
        number = int(self.port(name, self.port(older_name, default)))
        return max(len(self.children) + number + 1, 0) if number < 0 else number

    def on_tick(self) -> Status:
        needed = self.count_of("success_count", "success_threshold", "-1")
        tolerated = self.count_of("failure_count", "failure_threshold", "1")
        if max(needed, tolerated) > len(self.children):
            raise NeverEnds  # BehaviorTree.CPP throws an exception here.
        for i, child in enumerate(self.children):
            if i not in self.answers and (status := child.tick()) is not RUNNING:
                self.answers[i] = status
            answers = list(self.answers.values())
            if answers.count(SUCCESS) >= needed:
                return self.end(SUCCESS)
            if len(self.children) - answers.count(FAILURE) < needed or answers.count(FAILURE) == tolerated:
                return self.end(FAILURE)
        return RUNNING


class IfThenElse(Node):
    """The condition is not ticked while a branch is running."""

    def reset(self) -> None:
        self.branch = 0

    def on_tick(self) -> Status:
        if self.branch == 0:
            status = self.children[0].tick()
            if status is RUNNING:
                return RUNNING
            if status is FAILURE and len(self.children) == 2:
                return FAILURE
            self.branch = 1 if status is SUCCESS else 2
        status = self.children[self.branch].tick()
        return RUNNING if status is RUNNING else self.end(status)


# ------------------------------------------------------------------ decorators


class Inverter(Node):
    success, failure = FAILURE, SUCCESS

    def on_tick(self) -> Status:
        status = self.child.tick()
        return RUNNING if status is RUNNING else self.success if status is SUCCESS else self.failure


class Repeat(Node):
    """Counts successes over ticks; the child is halted after each end."""

    def reset(self) -> None:
        self.cycle = 0

    def on_tick(self) -> Status:
        cycles = int(self.port("num_cycles"))
        while cycles == -1 or self.cycle < cycles:
            status = self.child.tick()
            if status is RUNNING:
                return RUNNING
            if status is FAILURE:
                return self.end(FAILURE)
            self.cycle += 1
            self.child.halt()
        self.reset()
        return SUCCESS


class RetryUntilSuccessful(Node, names=("RetryUntilSuccessful", "RetryUntilSuccesful")):
    """Counts failures over ticks; the child is not halted between attempts."""

    def reset(self) -> None:
        self.attempt = 0

    def on_tick(self) -> Status:
        attempts = int(self.port("num_attempts"))
        while attempts == -1 or self.attempt < attempts:
            status = self.child.tick()
            if status is RUNNING:
                return RUNNING
            if status is SUCCESS:
                self.reset()
                return SUCCESS
            self.attempt += 1
        self.reset()
        return FAILURE


class BlackboardCheckInt(Node):
    def on_tick(self) -> Status:
        if int(self.port("value_A")) == int(self.port("value_B")):
            return self.child.tick()
        self.child.halt()
        return Status(int(self.port("return_on_mismatch")))
