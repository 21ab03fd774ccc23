# SPDX-License-Identifier: Apache-2.0
"""An executed tree with mocks -> plain SCXML (docs/spec/mocks.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from roaml.expr.operators import Operator
from roaml.expr.types import BASE_TYPES
from roaml.forest.cpp_types import mismatch
from roaml.forest.forest import CPP, Forest, port_type
from roaml.lower.blackboard import ANSWER, REQUEST, blackboard_write
from roaml.lower.build import binary, event_data, integer, name
from roaml.lower.interfaces import tree_event
from roaml.lower.timers import Timer, clock
from roaml.mocks import assembly
from roaml.mocks.assembly import NodeProgram, programs
from roaml.mocks.automaton import (
    RUNNING,
    STATUS_CODES,
    TYPES,
    Child,
    Known,
    NodeCode,
    NodeTooLargeError,
    node_automaton,
    ticks_of,
)
from roaml.mocks.board import Board, build_board, node_scripts
from roaml.mocks.entries import BoardEntry, EntryKind, kind_of_cpp, read_literal
from roaml.mocks.mock import Mock, mock_for
from roaml.mocks.refusal import TreeRefusal
from roaml.mocks.scripts import CompiledScript, ScriptRefusal, compiled
from roaml.mocks.unfolding import ExecutedNode, ExecutedTree, unfold
from roaml.model.expand import ROOT_NUMBER
from roaml.model.timing import period
from roaml.roles import NodeKind
from roaml.scxml.model import (
    Assign,
    Automaton,
    Data,
    EventRole,
    Network,
    Param,
    Role,
    ScxmlEvent,
    Send,
    State,
    Statement,
    Target,
    Transition,
)
from roaml.scxml.names import BLACKBOARD, TIMER_PREFIX, TREE_HAS_FINISHED, TREE_ROOT_PREFIX
from roaml.text import Location

DEFAULT_RATE = Fraction(10)
"""Ticks of the tree in a second."""
DEFAULT_MAX_TIME = 600 * 10**9
"""In ns."""
EVENT_PROBABILITY = 0.1
"""The probability that something happens in the world at a tick, for nodes without a mock."""
TICKS = "ticks"
"""The variable of the root with the number of ticks."""
MAX_TEXT_LENGTH = 100
"""The maximum length of a text in the blackboard."""


@dataclass(frozen=True, slots=True)
class MockOptions:
    """How a tree without a system is executed.

    Attributes:
        mocks: of leaves; the first one that fits best is used (`roaml.mocks.mock.mock_for`).
        entries: entry of the root blackboard -> the text that the host sets.
        rate: ticks in a second.
        max_time: in ns.
        counts: whether mocks count their answers, for measurements.
    """

    mocks: tuple[Mock, ...] = ()
    entries: Mapping[str, str] = field(default_factory=dict)
    rate: Fraction = DEFAULT_RATE
    max_time: int = DEFAULT_MAX_TIME
    counts: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class MockedLeaf:
    """A leaf with its mock.

    Attributes:
        duration: in ticks; `None` for conditions and synchronous actions.
        is_known: whether its library says that it succeeds; no mock is for it.
    """

    node: ExecutedNode
    probability: float
    duration: int | None
    is_known: bool


@dataclass(frozen=True, slots=True, eq=False)
class MockedTree:
    """A tree with mocks, translated.

    Attributes:
        leaves: those that have mocks.
        assumed: nodes that ask about the world and have no mock: the probability of an event at a tick is
            `EVENT_PROBABILITY`.
    """

    tree: ExecutedTree
    network: Network
    leaves: tuple[MockedLeaf, ...]
    assumed: tuple[ExecutedNode, ...]
    options: MockOptions


class MissingMocksError(Exception):
    """Leaves have no mock. `leaves` are pairs of name and type."""

    def __init__(self, leaves: Sequence[ExecutedNode]) -> None:
        super().__init__()
        self.leaves = tuple(leaves)


def mocked(forest: Forest, options: MockOptions) -> MockedTree:
    """The executed tree of the analysed file, with mocks instead of leaves that no library describes.

    Raises:
        TreeRefusal: the tree cannot be translated.
        MissingMocksError: leaves have no mock.
    """
    return _Builder(unfold(forest), options).build()


class _Builder:
    def __init__(self, tree: ExecutedTree, options: MockOptions) -> None:
        self.tree = tree
        self.options = options
        self.leaves: list[MockedLeaf] = []
        self.assumed: list[ExecutedNode] = []
        self.programs: dict[int, NodeProgram | None] = {}

    def build(self) -> MockedTree:
        missing = []
        for node in self.tree.nodes:
            program = self.program(node)
            self.programs[node.number] = program
            if program is None and self.find_mock(node) is None:
                missing.append(node)
        if missing:
            raise MissingMocksError(missing)
        board = build_board(self.tree, self.options.entries, self.programs)
        automata: dict[int, Automaton] = {}
        children: dict[int, Child] = {}
        for node in reversed(self.tree.nodes):
            code = self.code(node, board, tuple(children[number] for number in node.children))
            try:
                built = node_automaton(code)
            except NodeTooLargeError:
                raise TreeRefusal(node.origin, f"`{node.name}` has too many states") from None
            automata[node.number], children[node.number] = built.automaton, built.child
        origin = self.tree.nodes[0].origin
        tick = ScxmlEvent(f"{TIMER_PREFIX}{self.tree.name}_tick", EventRole.TIMER_TICK)
        root = _root(self.tree, tick, children[ROOT_NUMBER].answers, origin, self.options.counts)
        timer = Timer(root.name, f"{self.tree.name}_tick", tick, period(self.options.rate), origin)
        members = [root, *(automata[node.number] for node in self.tree.nodes)]
        blackboard = _blackboard(board, origin)
        if blackboard is not None:
            members.append(blackboard)
        members.append(clock([timer], self.options.max_time, origin))
        network = Network(tuple(members), MAX_TEXT_LENGTH, 2)
        self.leaves.reverse()
        self.assumed.reverse()
        return MockedTree(self.tree, network, tuple(self.leaves), tuple(self.assumed), self.options)

    def program(self, node: ExecutedNode) -> NodeProgram | None:
        """The program of a node of the libraries; `None` for a leaf that needs a mock."""
        if node.type == "SubTree" and node.children:
            return programs()["SubTree"]
        is_library = node.known is not None and bool(node.known.library)
        if is_library and node.type in programs():
            self.check_children(node)
            return programs()[node.type]
        if node.children:
            reason = f"`{node.type}` has children, and it is not known what it does with them"
            raise TreeRefusal(node.origin, reason)
        if node.known is not None and node.known.kind in (NodeKind.CONTROL, NodeKind.DECORATOR):
            raise TreeRefusal(node.origin, f"`{node.type}` needs children")
        absent = CPP.absent.get(node.type)
        if node.known is None and absent is not None:
            raise TreeRefusal(node.origin, f"`{node.type}` is not a node: {absent.reason}")
        return None

    def check_children(self, node: ExecutedNode) -> None:
        assert node.known is not None
        least, most = node.known.children
        if not least <= len(node.children) <= most:
            raise TreeRefusal(
                node.origin, f"`{node.type}` has {len(node.children)} children, which the library rejects"
            )

    # ------------------------------------------------------------------- nodes

    def code(self, node: ExecutedNode, board: Board, children: tuple[Child, ...]) -> NodeCode:
        program = self.programs[node.number]
        known: dict[str, Known] = {}
        bound: dict[str, BoardEntry] = {}
        outputs: tuple[tuple[BoardEntry, tuple[Known, ...]], ...] = ()
        elements: tuple[Known, ...] = ()
        if program is None:
            program = self.mock(node, known)
            outputs = tuple(self.outputs(node, board))
        else:
            self.set_ports(node, program, board, known, bound)
            if program.name.startswith("Loop"):
                elements = self.elements(node, known)
        if any(instruction_uses_event(instruction) for instruction in program.tick):
            known["event"] = self.event(node)
        return NodeCode(
            node.number,
            node.automaton,
            program,
            children,
            known,
            bound,
            self.scripts(node, board),
            board.flag_of.get(node.number),
            outputs,
            elements,
            board.flags,
            _flags_at(node, board),
            self.options.rate,
            self.options.counts,
            node.origin,
        )

    def find_mock(self, node: ExecutedNode) -> Mock | None:
        succeeds = node.known is not None and node.known.succeeds
        return mock_for(self.options.mocks, node.name, node.type, succeeds)

    def mock(self, node: ExecutedNode, known: dict[str, Known]) -> NodeProgram:
        mock = self.find_mock(node)
        assert mock is not None
        is_condition = node.node.element.name == "Condition" or (
            node.known is not None and (node.known.kind is NodeKind.CONDITION or node.known.running is False)
        )
        known["success"] = mock.probability
        duration = None if is_condition else ticks_of(mock.duration, self.options.rate)
        if duration is not None:
            known["DURATION"] = duration
        self.leaves.append(MockedLeaf(node, mock.probability, duration, mock not in self.options.mocks))
        return programs()["synchronous" if duration is None else "asynchronous"]

    def event(self, node: ExecutedNode) -> float:
        exact = [mock for mock in self.options.mocks if mock.pattern != "*"]
        mock = mock_for(exact, node.name, node.type)
        if mock is not None:
            return mock.probability
        self.assumed.append(node)
        return EVENT_PROBABILITY

    def outputs(self, node: ExecutedNode, board: Board) -> list[tuple[BoardEntry, tuple[Known, ...]]]:
        """What a mock writes: ports that may be outputs, if the tree reads their entries."""
        written = []
        for port, entry, _, _ in node.ports():
            declared = node.known.port(port) if node.known else None
            writes = declared is None or declared.direction.writes
            if entry is not None and writes and entry in board.entries:
                values = board.values[entry]
                is_bool = declared is not None and port_type(declared) == "bool"
                written.append((board.entries[entry], (0, 1) if is_bool else values))
            elif entry is not None and writes and entry in board.flags:
                written += [(flag, (1,)) for flag in board.flags[entry]]
        return written

    def scripts(self, node: ExecutedNode, board: Board) -> dict[str, CompiledScript]:
        result = {}
        for attribute, script, is_condition in node_scripts(node):
            try:
                result[attribute] = compiled(
                    script, lambda entry: board.entries.get(node.frame.entry(entry)), is_condition=is_condition
                )
            except ScriptRefusal as refusal:
                raise TreeRefusal(Location(node.origin.path, refusal.span), refusal.reason) from None
        return result

    # ------------------------------------------------------------------- ports

    def set_ports(
        self,
        node: ExecutedNode,
        program: NodeProgram,
        board: Board,
        known: dict[str, Known],
        bound: dict[str, BoardEntry],
    ) -> None:
        """The values of the ports that a program uses: constants, or entries."""
        if program.name in ("SetBlackboard", "UnsetBlackboard"):
            self.set_blackboard(node, board, known, bound)
            return
        given = {port: (entry, text, span) for port, entry, text, span in node.ports()}
        declared = node.known.ports if node.known else ()
        kinds = {entry.kind for entry in self.switch_entries(program, given, board)}
        for port in declared:
            if port.name in ("if", "code", "entry", "queue", "value" if program.name.startswith("Loop") else ""):
                if port.name == "value" and port.name in given:
                    entry = given["value"][0]
                    if entry is not None and entry in board.entries:
                        bound["value"] = board.entries[entry]
                continue
            entry, text, span = given.get(port.name, (None, port.default, node.node.element.name_span))
            if entry is not None:
                if entry in board.entries:
                    bound[port.name] = board.entries[entry]
                elif port.name in _needed(program):
                    reason = f"nothing sets the entry `{entry}`; give it a value with --entry {entry}=VALUE"
                    raise TreeRefusal(Location(node.origin.path, span), reason)
                continue
            if text is None:
                continue
            type_ = port_type(port)
            if program.name.startswith("Switch"):
                known[port.name] = _case(text, kinds)
            elif type_ == "NodeStatus":
                known[port.name] = STATUS_CODES.get(text.strip(), RUNNING)
            else:
                known[port.name] = self.literal(node, type_, text)
        missing = [port for port in _needed(program) if port not in known and port not in bound]
        if missing and not program.name.startswith("Switch"):
            raise TreeRefusal(node.origin, f"`{node.type}` needs the port `{missing[0]}`")
        if any(isinstance(value, BoardEntry) and value.kind is EntryKind.TEXT for value in bound.values()) and not (
            program.name.startswith("Switch")
        ):
            raise TreeRefusal(node.origin, f"a port of `{node.type}` is bound to a text")
        for port_name in ("else", "if_empty", "then_skip", "catch_on_halt", "wrap_around"):
            if port_name in bound:
                raise TreeRefusal(node.origin, f"the port `{port_name}` must be a constant to be translated")

    def switch_entries(
        self, program: NodeProgram, given: Mapping[str, tuple[str | None, str, object]], board: Board
    ) -> list[BoardEntry]:
        if not program.name.startswith("Switch"):
            return []
        return [board.entries[entry] for entry, _, _ in given.values() if entry is not None and entry in board.entries]

    def literal(self, node: ExecutedNode, type_: str, text: str) -> Known:
        wrong = mismatch(type_, text)
        value = read_literal(wrong.instead if wrong is not None and wrong.ignored else text)[1]
        if isinstance(value, str) and kind_of_cpp(type_) not in (EntryKind.TEXT, None):
            raise TreeRefusal(node.origin, f"`{text}` is not a value for a port of the type {type_}")
        return value

    def set_blackboard(
        self, node: ExecutedNode, board: Board, known: dict[str, Known], bound: dict[str, BoardEntry]
    ) -> None:
        target: str | None = None
        for port, entry, text, span in node.ports():
            if port in ("output_key", "key"):
                if entry is not None:
                    reason = (
                        f"`{{{entry}}}` means the entry whose name is the text in `{entry}`, which is only known when "
                        f'the tree runs; write `{port}="{entry}"` for the entry itself'
                    )
                    raise TreeRefusal(Location(node.origin.path, span), reason)
                target = node.frame.entry(text.strip())
        if target is None or target not in board.entries:
            known["value"] = 0
            return
        if node.type == "UnsetBlackboard":
            raise TreeRefusal(node.origin, f"`{target}` is read by the tree; a model cannot remove it")
        bound["output_key"] = board.entries[target]
        kind = board.entries[target].kind
        for port, entry, text, span in node.ports():
            if port != "value":
                continue
            if entry is None:
                known["value"] = text if kind is EntryKind.TEXT else read_literal(text)[1]
            elif entry in board.entries and (board.entries[entry].kind is EntryKind.TEXT) is (kind is EntryKind.TEXT):
                bound["value"] = board.entries[entry]
            else:
                reason = f"the value of `{entry}` is not known, and the tree reads `{target}`"
                raise TreeRefusal(Location(node.origin.path, span), reason)

    def elements(self, node: ExecutedNode, known: dict[str, Known]) -> tuple[Known, ...]:
        """The elements of the queue of a loop."""
        known.setdefault("if_empty", STATUS_CODES["SUCCESS"])
        for port, entry, text, span in node.ports():
            if port == "queue":
                if entry is not None:
                    reason = "a queue in the blackboard cannot be translated; write its elements as `1;2;3`"
                    raise TreeRefusal(Location(node.origin.path, span), reason)
                items = [item.strip() for item in text.split(";")] if text.strip() else []
                if node.type == "LoopString":
                    return tuple(items)
                read = tuple(read_literal(item)[1] for item in items)
                return tuple(float(v) for v in read) if node.type == "LoopDouble" else read
        return ()


def _flags_at(node: ExecutedNode, board: Board) -> dict[str, tuple[BoardEntry, ...]]:
    """The flags of observed entries that a node writes and whose values nothing reads."""
    flags: dict[str, tuple[BoardEntry, ...]] = {}
    for port, bound, text, _ in node.ports():
        names_entry = node.type == "SetBlackboard" and port == "output_key" and bound is None
        entry = node.frame.entry(text.strip()) if names_entry else bound
        if entry is not None and entry in board.flags and entry not in board.entries:
            flags[port] = board.flags[entry]
    return flags


def instruction_uses_event(instruction: assembly.Instruction) -> bool:
    """Whether an instruction depends on something that happens in the world."""
    match instruction:
        case assembly.Choose(probability):
            return getattr(probability, "id", "") == "event"
    return False


def _needed(program: NodeProgram) -> set[str]:
    """The ports without which a program cannot work."""
    names: set[str] = set()
    for instruction in program.tick:
        if isinstance(instruction, assembly.Read):
            names.update(instruction.ports)
    return names


def _case(text: str, kinds: set[EntryKind]) -> Known:
    """A constant of a switch: a number if the variable is one."""
    if not kinds or EntryKind.TEXT in kinds:
        return text
    return read_literal(text)[1]


# ----------------------------------------------------------------- other automata


def _root(tree: ExecutedTree, tick: ScxmlEvent, answers: frozenset[int], origin: Location, counts: bool) -> Automaton:
    """The automaton that ticks the tree until it answers something else than RUNNING; with `counts`, it counts the
    ticks."""
    response = tree_event(ROOT_NUMBER, "response")

    def to(state: str, *body: Statement) -> tuple[Target, ...]:
        return (Target(state, 1.0, body, origin),)

    waiting = [
        Transition(
            response,
            binary(event_data("status"), Operator.EQUAL, integer(code)),
            to("idle" if code == RUNNING else TREE_HAS_FINISHED),
            origin,
        )
        for code in sorted(answers)
    ]
    data = (Data(TICKS, BASE_TYPES["int64"], integer(0), origin),) if counts else ()
    counted = [Assign(name(TICKS), binary(name(TICKS), Operator.ADD, integer(1)), origin)] if counts else []
    call = Send(tree_event(ROOT_NUMBER, "tick"), (), origin)
    idle = Transition(tick, None, to("wait_tick_res", *counted, call), origin)
    states = (
        State("idle", (), (), (idle,), origin),
        State("wait_tick_res", (), (), tuple(waiting), origin),
        State(TREE_HAS_FINISHED, (), (), (), origin),
    )
    return Automaton(f"{TREE_ROOT_PREFIX}{tree.name}", Role.TREE_ROOT, "idle", data, states, origin)


def _blackboard(board: Board, origin: Location) -> Automaton | None:
    entries = [*board.entries.values(), *board.flag_of.values()]
    if not entries:
        return None
    data = tuple(Data(entry.variable, TYPES[entry.kind], entry.start, origin) for entry in entries)
    writes = [
        Transition(
            blackboard_write(entry.variable),
            None,
            (Target("idle", 1.0, (Assign(name(entry.variable), event_data("value"), origin),), origin),),
            origin,
        )
        for entry in entries
    ]
    answer = Send(ANSWER, tuple(Param(entry.variable, name(entry.variable), origin) for entry in entries), origin)
    asked = Transition(REQUEST, None, (Target("idle", 1.0, (answer,), origin),), origin)
    return Automaton(
        BLACKBOARD, Role.BLACKBOARD, "idle", data, (State("idle", (), (), (*writes, asked), origin),), origin
    )
