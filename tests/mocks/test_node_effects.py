# SPDX-License-Identifier: Apache-2.0
"""What is computed about the nodes of the libraries agrees with `library_model`, a second implementation: everything
that happens in random executions is expected, and everything that is expected happens."""

from __future__ import annotations

import itertools
import random
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from xml.etree import ElementTree

import pytest
from library_model import ENDED, IDLE, SKIP, LibraryError, Node, R, World, node_class, reset
from random_trees import CONDITIONS, COUNTS, WITH_WORLD

from examples import examples
from roaml.libraries import library_node
from roaml.libraries.programs import effects as effects_module
from roaml.libraries.programs.assembly import programs
from roaml.libraries.programs.effects import ANY_ANSWER, Situation, constant, effects, effects_on
from roaml.libraries.programs.statuses import RUNNING, SKIPPED, STATUS_CODES, SUCCESS
from roaml.rules.support.node_calls import WITHOUT_RESETS

NODES_OF_AS2FM = Path(str(resources.files("roaml.lower.nodes")))
TABLES = {**WITH_WORLD.controls, **WITH_WORLD.decorators}
OWN_LEAVES = {name: ports for name, ports in WITH_WORLD.leaves.items() if name in programs()}
SETS = [frozenset(s) for size in (1, 2, 3, 4) for s in itertools.combinations(sorted(ANY_ANSWER), size)]
NAMES = {code: name for name, code in STATUS_CODES.items()}


@dataclass
class Seen:
    """What was observed: kind of event -> children and statuses."""

    events: set[tuple[object, ...]] = field(default_factory=set)
    is_halted: bool = False
    done: set[int] = field(default_factory=set)


class Child(Node):
    """A child that draws its answers from sets, and observes what its parent does."""

    def __init__(self, index: int, seen: Seen, setting: Situation, source: random.Random) -> None:
        self.index, self.seen, self.setting, self.source = index, seen, setting, source
        self._status = IDLE

    @property
    def status(self) -> str:  # type: ignore[override]
        return self._status

    @status.setter
    def status(self, status: str) -> None:
        if status == IDLE and self._status != IDLE:
            code = RUNNING if self._status == R else SUCCESS
            self.seen.events.add(("passes" if self.seen.is_halted else "halts", self.index, code))
            self.seen.done.add(self.index)
        self._status = status

    def halt_node(self) -> None:
        pass  # `reset` changes the status

    def execute(self) -> str:
        self.seen.events.add(("ticked", self.index))
        if self._status in ENDED:
            self.seen.events.add(("ticks_ended", self.index))
        if self.index in self.seen.done:
            self.seen.events.add(("restarts", self.index))
        sets = self.setting.first if self._status == IDLE else self.setting.answers
        often = [RUNNING] * 3 if RUNNING in sets[self.index] else []
        answer = NAMES[self.source.choice([*sorted(sets[self.index]), *often])]
        if answer == SKIP:
            if self._status == IDLE and self.source.random() < 0.5:
                self._status = R  # a node that stays RUNNING
            return SKIP
        self._status = answer
        if answer in ENDED:
            self.seen.done.add(self.index)
        return answer


def observe(name: str, ports: dict[str, str], setting: Situation, source: random.Random, ticks: int) -> Seen:
    """The events of one random execution."""
    seen = Seen()
    world = World({"x": 0, "y": 1, "k": 0}, {}, happens=source.random() < 0.5)
    children: list[Node] = [Child(i, seen, setting, source) for i in range(len(setting.answers))]
    node = node_class(name)(world, name, ports, children)
    for tick in range(ticks):
        if source.random() < 0.7:
            world.write(source.choice(("x", "y")), source.choice((0, 1, 1, 2, 3, 4, 5, 6)))
            world.entries["k"] = source.choice((0, 1))
        world.happens ^= source.random() < 0.2
        try:
            answer = node.execute()
        except LibraryError:
            seen.events.add(("throws",))
            return seen
        seen.events.add(("answer", STATUS_CODES[answer]))
        if tick == 0:
            seen.events.add(("first", STATUS_CODES[answer]))
        if answer in ENDED:
            seen.done.clear()
        if answer in ENDED or source.random() < 0.05:
            seen.is_halted = True
            reset(node)
            seen.is_halted = False
            seen.done.clear()
    return seen


def expected(name: str, setting: Situation) -> set[tuple[object, ...]]:
    """The events that are computed from the program of a node."""
    program = programs()[name]
    of_node = effects(program, setting)
    events: set[tuple[object, ...]] = {("answer", status) for status in of_node.answers}
    events |= {("first", status) for status in of_node.first} | {("ticked", child) for child in of_node.ticked}
    for child in range(len(setting.answers)):
        of_child = effects_on(program, setting, child)
        events |= {("halts", child, status) for status in of_child.halts}
        events |= {("passes", child, status) for status in of_child.passes_halts}
        events |= {("restarts", child)} if of_child.restarts else set()
        events |= {("ticks_ended", child)} if of_child.ticks_ended else set()
    return events


def drawn(name: str, source: random.Random, *, any_answer: bool) -> tuple[dict[str, str], Situation]:
    """Values of the ports of a node, and what is known about it."""
    table = {**TABLES, **OWN_LEAVES}[name]
    ports = {port: source.choice(values) for port, values in table.items()}
    if source.random() < 0.4:
        ports[source.choice(("_failureIf", "_successIf", "_skipIf", "_while"))] = source.choice(CONDITIONS)
    least, most = (1, 1) if name in WITH_WORLD.decorators else COUNTS.get(name, (1, 3))
    least, most = (0, 0) if name in OWN_LEAVES else (least, most)
    numbers = (least, most) if name in COUNTS else (most,)
    count = source.choice(numbers) if any_answer else source.randint(least, most)
    answers = tuple(ANY_ANSWER if any_answer else source.choice(SETS) for _ in range(count))
    first = tuple(frozenset(source.sample(sorted(s), source.randint(1, len(s)))) for s in answers)
    declared = library_node(name)
    defaults = declared.ports if declared is not None else ()
    known = {port.name: constant(port.default) for port in defaults if port.default is not None}
    known |= {port: constant(text) for port, text in ports.items() if not text.startswith("{") and port[0] != "_"}
    for port, text in ports.items():
        if text.startswith("{"):
            known.pop(port, None)
    scripts = frozenset(port for port in ports if port[0] == "_")
    return ports, Situation(answers, answers if any_answer else first, tuple(sorted(known.items())), scripts)


@pytest.mark.parametrize("name", [*TABLES, *OWN_LEAVES])
def test_everything_that_happens_is_expected(name: str) -> None:
    source = random.Random(name)
    for _ in range(examples(20)):
        ports, setting = drawn(name, source, any_answer=False)
        happened = set().union(*(observe(name, ports, setting, source, 12).events for _ in range(5)))
        assert happened - {("throws",)} <= expected(name, setting), (ports, setting)


@pytest.mark.parametrize("name", [*TABLES, *OWN_LEAVES])
def test_everything_that_is_expected_happens(name: str) -> None:
    source = random.Random(name)
    happened: set[tuple[object, ...]] = set()
    settings = [drawn(name, source, any_answer=True) for _ in range(25)]
    expectation = set().union(*(expected(name, setting) for _, setting in settings))
    for _ in range(100):
        for ports, setting in settings:
            happened |= observe(name, ports, setting, source, 25).events - {("throws",)}
        if happened >= expectation:
            break
    assert happened == expectation


@pytest.mark.parametrize("name", [n for n in WITH_WORLD.controls if n not in COUNTS])
def test_a_node_with_many_children(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    source = random.Random(name)
    for _ in range(examples(10)):
        of_each = tuple(source.choice(SETS) for _ in range(source.randint(3, 4)))
        _, drawn_setting = drawn(name, source, any_answer=False)
        setting = Situation(of_each, of_each, drawn_setting.ports, drawn_setting.scripts)
        exact = expected(name, setting)
        monkeypatch.setattr(effects_module, "MAX_SIBLINGS", 1)
        assert exact <= expected(name, setting), setting
        monkeypatch.undo()


@pytest.mark.parametrize(
    ("name", "fatal"), [("IfThenElse", {0}), ("WhileDoElse", {0}), ("NonblockingSequence", {0, 1})]
)
def test_a_child_that_must_not_be_skipped(name: str, fatal: set[int]) -> None:
    any_of = (ANY_ANSWER,) * 2
    assert effects(programs()[name], Situation(any_of, any_of)).fatal == fatal
    for child in range(2):
        answers = tuple(frozenset((SKIPPED if index == child else SUCCESS,)) for index in range(2))
        setting = Situation(answers, answers)
        seen = observe(name, {}, setting, random.Random(0), 1)
        assert (("throws",) in seen.events) is (child in fatal)


def test_nodes_of_as2fm_that_do_not_reset_an_ended_child() -> None:
    """Their machines halt the child only when they are halted."""
    machines = {path.stem: ElementTree.parse(path) for path in NODES_OF_AS2FM.glob("*.ascxml")}
    halting = {name: len(list(tree.iter("bt_halt_child"))) for name, tree in machines.items()}
    halted = {name: len(tree.findall(".//bt_halt//bt_halt_child")) for name, tree in machines.items()}
    assert {name for name, count in halting.items() if count and count == halted[name]} == WITHOUT_RESETS
