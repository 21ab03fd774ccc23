# SPDX-License-Identifier: Apache-2.0
"""Translates an executed tree with mocks to plain SCXML (docs/spec/mocks.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from roaml.distributions.outcomes import Outcomes, hazards
from roaml.durations import AT_ONCE, DEFAULT_MAX_TIME, ReactionTime
from roaml.expr.operators import Operator
from roaml.expr.types import BASE_TYPES
from roaml.forest.forest import Forest, port_type
from roaml.libraries.programs.assembly import NodeProgram, programs
from roaml.libraries.programs.statuses import RUNNING, Known
from roaml.lower.build import binary, event_data, integer, name
from roaml.lower.interfaces import tree_event
from roaml.lower.programs.automaton import NodeAutomaton, NodeTooLargeError, node_automaton, too_large
from roaml.lower.programs.blackboard import board_automaton
from roaml.lower.programs.board import Board, build_board
from roaml.lower.programs.code import STATUSES, Child, NodeCode
from roaml.lower.programs.entries import BoardEntry
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree
from roaml.lower.programs.nodes import (
    EVENT_PROBABILITY,
    event_probability,
    flags_at,
    is_own_parent,
    program_of,
    values_and_scripts,
)
from roaml.lower.programs.refusal import TreeRefusal, first_of
from roaml.lower.programs.values import ticks_of
from roaml.lower.timers import Timer, clock, clock_step
from roaml.mocks.mock import Mock, MockError, drawn_ticks, mock_for
from roaml.mocks.proposal import MockableLeaf, leaves_of
from roaml.mocks.unfolding import unfold
from roaml.model.drawn_durations import DrawnDuration
from roaml.model.timing import NANOSECONDS_PER_SECOND, period
from roaml.record import Record, field
from roaml.scxml.events import EventRole, Role, ScxmlEvent
from roaml.scxml.model import Assign, Automaton, Data, Network, Send, State, Statement, Target, Transition
from roaml.scxml.names import TIMER_PREFIX, TREE_HAS_FINISHED, TREE_ROOT_PREFIX, TreeEventKind
from roaml.text import Location

DEFAULT_RATE = Fraction(10)
"""The default number of ticks of the tree per second, in Hz."""
TICKS = "ticks"
"""The name of the variable in which the automaton of the tree root counts the ticks."""
MAX_TEXT_LENGTH = 100
"""The maximum length of a text in the blackboard, in characters."""


class MockOptions(Record, frozen=True):
    """How a tree without a system is executed.

    Attributes:
        mocks: the mocks of leaves; `roaml.mocks.mock.mock_for` selects the mock of a leaf.
        entries: entries of the root blackboard, with the texts to which the program that executes the tree sets them.
        rate: the number of ticks per second.
        max_time: the limit of the simulated time, in ns.
        counts: whether the model counts ticks and the answers of mocks, for measurements.
        reaction_time: how long nodes may wait before they take a possible step; `None` for `instant`, because a mock
            states how long its leaf takes, and a tick takes no time.
    """

    mocks: tuple[Mock, ...] = ()
    entries: Mapping[str, str] = field(default_factory=dict)
    rate: Fraction = DEFAULT_RATE
    max_time: int = DEFAULT_MAX_TIME
    counts: bool = False
    reaction_time: ReactionTime | None = None

    @property
    def tick_time(self) -> Fraction:
        """The time from a tick to the next one in the model, in s. It is that of the timer, so that all reports of a
        run agree: the inverse of the rate, rounded down (`roaml.model.timing.period`)."""
        return Fraction(period(self.rate).nanoseconds, NANOSECONDS_PER_SECOND)


class MockedLeaf(Record, frozen=True, eq=False):
    """A leaf with its mock.

    Attributes:
        probability: the probability of SUCCESS.
        mock: the mock.
        drawn: the numbers of ticks for which the leaf is RUNNING, if they are drawn.
        is_known: whether the leaf has no mock because its library declares that it always succeeds.
    """

    node: ExecutedNode
    probability: float
    mock: Mock
    drawn: Outcomes | None
    is_known: bool


class MockedTree(Record, frozen=True, eq=False):
    """The translation of a tree with mocks.

    Attributes:
        leaves: the leaves that are replaced by mocks, including those that always succeed.
        assumed: the nodes that depend on the world and have no mock; their event has `EVENT_PROBABILITY`.
        overwritten: the names of entries that the tree sets and that mocks also write, because no model declares the
            ports, each with the type of the leaf and the port.
    """

    tree: ExecutedTree
    network: Network
    leaves: tuple[MockedLeaf, ...]
    assumed: tuple[ExecutedNode, ...]
    overwritten: Mapping[str, tuple[str, str]]
    options: MockOptions


class MissingMocksError(Exception):
    """Raised if nodes have no mock.

    Attributes:
        leaves: these nodes: leaves, and nodes with children that no library describes.
        mockable: all nodes of the tree whose behaviour a mock determines, with proposals.
    """

    def __init__(self, leaves: Sequence[ExecutedNode], mockable: Sequence[MockableLeaf]) -> None:
        super().__init__()
        self.leaves = tuple(leaves)
        self.mockable = tuple(mockable)


def mocked(forest: Forest, options: MockOptions) -> MockedTree:
    """The executed tree of the analysed file, with mocks instead of leaves that no library describes.

    Raises:
        TreeRefusal: the tree cannot be translated.
        MissingMocksError: a leaf, or a node with children that no library describes, has no mock.
    """
    return _Builder(unfold(forest, options.mocks), options).build()


class _Builder:
    def __init__(self, tree: ExecutedTree, options: MockOptions) -> None:
        self.tree = tree
        self.options = options
        self.leaves: list[MockedLeaf] = []
        self.assumed: list[ExecutedNode] = []
        self.overwritten: dict[str, tuple[str, str]] = {}
        self.programs: dict[int, NodeProgram | None] = {}

    def build(self) -> MockedTree:
        missing = []
        for node in self.tree.nodes:
            if is_own_parent(node, self.tree.version):
                missing.append(node)
                continue
            program = program_of(node, self.tree.version)
            self.programs[node.number] = program
            if program is None and self.find_mock(node) is None:
                missing.append(node)
        if missing:
            raise MissingMocksError(missing, leaves_of(self.tree, self.options.mocks))
        board = build_board(self.tree, self.options.entries, self.programs)
        automata: dict[int, Automaton] = {}
        children: dict[int, Child] = {}
        refusals: list[TreeRefusal] = []
        for node in reversed(self.tree.nodes):
            try:
                built = self.built(node, board, tuple(children[number] for number in node.children))
            except TreeRefusal as refusal:
                refusals.append(refusal)
                children[node.number] = Child(str(node.number), STATUSES, False, node.origin)
                continue
            automata[node.number], children[node.number] = built.automaton, built.child
        if refusals:
            raise first_of(refusals)
        origin = self.tree.nodes[0].origin
        tick = ScxmlEvent(f"{TIMER_PREFIX}{self.tree.name}_tick", EventRole.TIMER_TICK)
        root = _root(self.tree, tick, children[self.tree.root].answers, origin, self.options.counts)
        timer = Timer(root.name, f"{self.tree.name}_tick", tick, period(self.options.rate), origin)
        members = [root, *(automata[node.number] for node in self.tree.nodes)]
        blackboard = board_automaton(board, origin, is_read=bool(board.read or board.flag_of))
        if blackboard is not None:
            members.append(blackboard)
        members.append(clock([timer], self.options.max_time, origin))
        reaction_time = self.options.reaction_time or AT_ONCE
        network = Network(tuple(members), MAX_TEXT_LENGTH, 2, clock_step([timer]), reaction_time)
        self.leaves.reverse()
        self.assumed.reverse()
        return MockedTree(self.tree, network, tuple(self.leaves), tuple(self.assumed), self.overwritten, self.options)

    # ------------------------------------------------------------------- nodes

    def built(self, node: ExecutedNode, board: Board, children: tuple[Child, ...]) -> NodeAutomaton:
        code = self.code(node, board, children)
        try:
            return node_automaton(code)
        except NodeTooLargeError:
            raise TreeRefusal(node.origin, too_large(node.name, len(node.children))) from None

    def code(self, node: ExecutedNode, board: Board, children: tuple[Child, ...]) -> NodeCode:
        program = self.programs[node.number]
        outputs: tuple[tuple[BoardEntry, tuple[Known, ...]], ...] = ()
        values, scripts = values_and_scripts(node, program, board)
        if program is None:
            program = self.mock(node, values.known)
            outputs = tuple(self.outputs(node, board))
        if program.reads_world:
            values.known["event"] = self.event(node)
        return NodeCode(
            str(node.number),
            node.automaton,
            program,
            children,
            values.known,
            values.bound,
            scripts,
            board.flag_of.get(node.number),
            outputs,
            values.elements,
            flags_at(node, board),
            self.options.rate,
            self.options.counts,
            node.origin,
            whole=values.whole,
        )

    def find_mock(self, node: ExecutedNode) -> Mock | None:
        succeeds = node.known is not None and node.known.succeeds
        return mock_for(self.options.mocks, node.name, node.type, succeeds)

    def mock(self, node: ExecutedNode, known: dict[str, Known]) -> NodeProgram:
        mock = self.find_mock(node)
        assert mock is not None
        known["success"] = mock.probability
        is_instant = node.node.element.name == "Condition" or (node.known is not None and node.known.is_synchronous)
        drawn = None
        if is_instant:
            program = programs()["synchronous"]
        elif isinstance(mock.duration, DrawnDuration):
            try:
                drawn = drawn_ticks(mock.duration, self.options.rate)
            except MockError as error:
                raise TreeRefusal(node.origin, str(error)) from None
            known.update((f"ends_{ticks}", share) for ticks, share in enumerate(hazards(drawn)))
            program = programs()["randomly_long"]
        else:
            known["DURATION"] = ticks_of(mock.duration, self.options.rate)
            program = programs()["asynchronous"]
        self.leaves.append(MockedLeaf(node, mock.probability, mock, drawn, mock not in self.options.mocks))
        return program

    def event(self, node: ExecutedNode) -> float:
        exact = [mock for mock in self.options.mocks if mock.pattern != "*"]
        mock = mock_for(exact, node.name, node.own_type or node.type) or mock_for(exact, node.name, node.type)
        if mock is not None:
            return mock.probability
        probability = event_probability(node)
        if probability is not None:
            return probability
        self.assumed.append(node)
        return EVENT_PROBABILITY

    def outputs(self, node: ExecutedNode, board: Board) -> list[tuple[BoardEntry, tuple[Known, ...]]]:
        """The entries that a mock writes, with their possible values. A mock writes the entries of the ports that may
        be outputs, if the tree reads these entries. A port that no model declares is an input if the tree
        itself computes its entry."""
        written = []
        for port, entry, _, _ in node.ports():
            declared = node.known.port(port) if node.known else None
            writes = entry not in board.computed if declared is None else declared.direction.writes
            if entry is not None and writes and entry in board.entries:
                values = board.values[entry]
                is_bool = declared is not None and port_type(declared) == "bool"
                written.append((board.entries[entry], (0, 1) if is_bool else values))
                if declared is None and entry in board.assigned:
                    self.overwritten.setdefault(entry, (node.own_type or node.type, port))
            elif entry is not None and writes and entry in board.flags:
                written += [(flag, (1,)) for flag in board.flags[entry]]
        return written


# ----------------------------------------------------------------- other automata


def _root(tree: ExecutedTree, tick: ScxmlEvent, answers: frozenset[int], origin: Location, counts: bool) -> Automaton:
    """The automaton that ticks the tree until the tree returns a status other than RUNNING; with `counts`, it also
    counts the ticks."""
    response = tree_event(tree.root, TreeEventKind.RESPONSE)

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
    call = Send(tree_event(tree.root, TreeEventKind.TICK), (), origin)
    idle = Transition(tick, None, to("wait_tick_res", *counted, call), origin)
    states = (
        State("idle", (), (), (idle,), origin),
        State("wait_tick_res", (), (), tuple(waiting), origin),
        State(TREE_HAS_FINISHED, (), (), (), origin),
    )
    return Automaton(f"{TREE_ROOT_PREFIX}{tree.name}", Role.TREE_ROOT, "idle", data, states, origin)
