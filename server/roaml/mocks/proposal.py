# SPDX-License-Identifier: Apache-2.0
"""Proposes mocks for the leaves of a tree without a system (docs/spec/mocks.md#proposed)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from fractions import Fraction

from roaml.forest.forest import Forest
from roaml.forest.names import READS_AS_CONDITION
from roaml.libraries.programs.statuses import SUCCESS
from roaml.lower.programs.executed import ExecutedNode, ExecutedTree
from roaml.lower.programs.nodes import EVENT_PROBABILITY, event_probability, is_own_parent, program_of
from roaml.mocks.assumptions import Assumption, Constant, assumption
from roaml.mocks.guards import guards_of
from roaml.mocks.likeness import Likeness
from roaml.mocks.mock import ALL, Mock, mock_for
from roaml.mocks.unfolding import unfold
from roaml.record import Record

_LIBRARY = "Nav2"
CONDITION_PROBABILITY = 0.5
GUARD_PROBABILITY = 0.999
"""The probability with which a guard lets the nodes behind it run at a tick."""
_GUARDS = "it is ticked again while a node behind it runs, and mostly lets it run"
_SELECTS = "it is ticked again while a node behind it runs, and selects that node: mostly the one for SUCCESS"
"""Why a guard has its probability: it stops the nodes behind it, or changes between them, as in a WhileDoElse."""
ACTION = Assumption(0.9, Fraction(1000), "no library describes it: a common action")
"""The assumption about an action of which nothing is known."""


class LeafKind(Enum):
    """What the mock of a node determines."""

    CONDITION = "condition"
    SYNCHRONOUS = "action without delay"
    ACTION = "action"
    EVENT = "event"
    CONTROL = "control node"
    DECORATOR = "decorator"

    @property
    def has_duration(self) -> bool:
        """Whether the duration of the mock has an effect."""
        return self is LeafKind.ACTION

    @property
    def has_children(self) -> bool:
        """Whether the mock states like which node of a library the node is executed."""
        return self in (LeafKind.CONTROL, LeafKind.DECORATOR)


SEQUENCE = "Sequence"
"""The type of the node of the library that is proposed for nodes with children. With one child, it returns the status
of this child."""
_PARENTS = {
    LeafKind.DECORATOR: "no library describes it: it returns the status of its child",
    LeafKind.CONTROL: "no library describes it: it ticks its children one after the other while they succeed",
}


class MockableLeaf(Record, frozen=True, eq=False):
    """Leaves that one mock describes: those of a type, or those of a name if the proposals for the type differ; or
    nodes with children that no library describes.

    Attributes:
        kind: what the mock determines.
        mock: the mock that applies now; `None` if there is none. Then the leaves need one, except events, which have
            the probability `EVENT_PROBABILITY`.
        proposed: the proposed mock. Its pattern is the name or the type of the leaves.
        reason: why, as a clause without full stop.
        nodes: the leaves, in pre-order.
    """

    kind: LeafKind
    mock: Mock | None
    proposed: Mock
    reason: str
    nodes: tuple[ExecutedNode, ...]

    @property
    def is_missing(self) -> bool:
        """Whether the leaves need a mock and have none."""
        return self.mock is None and self.kind is not LeafKind.EVENT

    @property
    def line(self) -> str:
        """The proposed mock as a line of a file."""
        behaviour = self.proposed.behaviour(is_instant=not self.kind.has_duration)
        return f"{self.proposed.pattern}: {behaviour}  # {self.kind.value}: {self.reason}"


def mockable_leaves(forest: Forest, mocks: Sequence[Mock] = ()) -> tuple[MockableLeaf, ...]:
    """The leaves of the executed tree whose behaviour a mock determines, in the order of the tree, each with the mock
    that applies and a proposal.

    Args:
        mocks: the mocks that exist already.

    Raises:
        TreeRefusal: the file has no executed tree, or the tree is invalid.
    """
    return leaves_of(unfold(forest, mocks), mocks)


def leaves_of(tree: ExecutedTree, mocks: Sequence[Mock]) -> tuple[MockableLeaf, ...]:
    """As `mockable_leaves`, for an executed tree."""
    return tuple(_groups(tree, mocks))


def proposed_text(tree: str, leaves: Sequence[MockableLeaf]) -> str:
    """The text of a file with the proposed mocks.

    Args:
        tree: the name of the file with the tree.
    """
    head = (
        f"# Proposed mocks for {tree}. They are assumptions, not measurements:",
        "# replace them by what you know of your robot.",
        "# NODE: probability of SUCCESS in TIME",
        *(["# NODE: as TYPE, a node of a library"] if any(leaf.kind.has_children for leaf in leaves) else []),
    )
    return "\n".join([*head, *(leaf.line for leaf in leaves)]) + "\n"


def completed_text(text: str, leaves: Sequence[MockableLeaf]) -> str:
    """The text of a file with mocks, followed by the proposals for the leaves that need one and have none."""
    separator = "" if not text or text.endswith("\n") else "\n"
    lines = [leaf.line for leaf in leaves if leaf.is_missing]
    return text if not lines else f"{text}{separator}" + "\n".join(lines) + "\n"


class _Proposal(Record, frozen=True, eq=False):
    node: ExecutedNode
    kind: LeafKind
    assumption: Assumption


def _groups(tree: ExecutedTree, mocks: Sequence[Mock]) -> Iterator[MockableLeaf]:
    by_type: dict[str, list[_Proposal]] = {}
    guards = guards_of(tree)
    for node in tree.nodes:
        proposal = _proposal(node, tree, guards)
        if proposal is not None:
            by_type.setdefault(node.type, []).append(proposal)
    for type_, proposals in by_type.items():
        differ = len({(p.assumption.probability, p.assumption.duration) for p in proposals}) > 1
        by_name: dict[str, list[_Proposal]] = {}
        for proposal in proposals:
            by_name.setdefault(proposal.node.name if differ else type_, []).append(proposal)
        # A name or type with its own mock is a group of its own, so that each mock is shown.
        for name, members in by_name.items():
            for mock, same in _by_mock(members, mocks):
                longest = max(same, key=lambda p: p.assumption.duration)
                pattern = mock.pattern if mock is not None and mock.pattern in _words(same) else name
                assumed = longest.assumption
                like = Likeness(SEQUENCE) if longest.kind.has_children else None
                proposed = Mock(_pattern(pattern), assumed.probability, assumed.duration, like)
                yield MockableLeaf(longest.kind, mock, proposed, assumed.reason, tuple(p.node for p in same))


def _words(proposals: Sequence[_Proposal]) -> set[str]:
    return {word for proposal in proposals for word in (proposal.node.name, proposal.node.type)}


def _by_mock(proposals: Sequence[_Proposal], mocks: Sequence[Mock]) -> list[tuple[Mock | None, list[_Proposal]]]:
    """Proposals, grouped by the mocks that apply to their nodes."""
    groups: list[tuple[Mock | None, list[_Proposal]]] = []
    for proposal in proposals:
        mock = _mock_of(proposal, mocks)
        group = next((members for other, members in groups if other == mock), None)
        if group is None:
            groups.append((mock, [proposal]))
        else:
            group.append(proposal)
    return groups


def _mock_of(proposal: _Proposal, mocks: Sequence[Mock]) -> Mock | None:
    if proposal.kind.has_children:
        return None
    if proposal.kind is LeafKind.EVENT:
        mocks = [mock for mock in mocks if mock.pattern != ALL]
    return mock_for(mocks, proposal.node.name, proposal.node.type)


def _proposal(node: ExecutedNode, tree: ExecutedTree, guards: Mapping[int, frozenset[int]]) -> _Proposal | None:
    """The proposal for a node; `None` if its behaviour is known, or if the tree sets it.

    Args:
        guards: see `guards_of`.
    """
    if is_own_parent(node, tree.version):
        kind = LeafKind.DECORATOR if len(node.children) == 1 else LeafKind.CONTROL
        return _Proposal(node, kind, Assumption(1.0, Fraction(0), _PARENTS[kind]))
    program = program_of(node, tree.version)
    if program is not None:
        if not program.reads_world or event_probability(node) is not None:
            return None
        reason = f"it happens at 1 of {1 / EVENT_PROBABILITY:g} checks"
        return _Proposal(node, LeafKind.EVENT, Assumption(EVENT_PROBABILITY, Fraction(0), reason))
    if node.known is not None and node.known.succeeds:
        return None
    is_condition = node.node.element.name == "Condition"
    if is_condition or (node.known is not None and node.known.is_synchronous):
        known_condition = node.known is None or node.known.kind.value == "condition"
        kind = LeafKind.CONDITION if is_condition or known_condition else LeafKind.SYNCHRONOUS
    else:
        kind = LeafKind.ACTION
    return _Proposal(node, kind, _assumed(node, kind, guards.get(node.number, frozenset())))


def _assumed(node: ExecutedNode, kind: LeafKind, continuing: frozenset[int]) -> Assumption:
    """The assumption about a leaf.

    Args:
        continuing: the statuses with which a guard lets the nodes behind it run; empty for other leaves.
    """
    if node.known is not None and _LIBRARY in (node.known.library, node.known.behaviour):
        known = assumption(node.type, _constants(node))
        if known is not None:
            return known
    if continuing and (node.known is None or kind is LeafKind.CONDITION):
        probability = GUARD_PROBABILITY if SUCCESS in continuing else 1 - GUARD_PROBABILITY
        return Assumption(probability, Fraction(0), _SELECTS if len(continuing) > 1 else _GUARDS)
    if kind is LeafKind.CONDITION:
        return Assumption(CONDITION_PROBABILITY, Fraction(0), "no library describes it: both outcomes are as likely")
    if kind is LeafKind.SYNCHRONOUS:
        return Assumption(ACTION.probability, Fraction(0), ACTION.reason)
    if node.known is None and READS_AS_CONDITION.match(node.type):
        return Assumption(
            CONDITION_PROBABILITY, Fraction(0), "its name reads as a condition: both outcomes are as likely"
        )
    return ACTION


def _constants(node: ExecutedNode) -> Constant:
    written = {port: text for port, entry, text, _ in node.ports() if entry is None}
    bound = {port for port, entry, _, _ in node.ports() if entry is not None}

    def constant(port: str) -> float | None:
        declared = node.known.port(port) if node.known is not None else None
        default = declared.default if declared is not None and port not in bound else None
        text = written.get(port, default)
        try:
            number = float(text) if text is not None else None
        except ValueError:
            return None
        return number if number is not None and abs(number) < 1e6 else None

    return constant


def _pattern(name: str) -> str:
    """A pattern for a name, as a line of a file can contain it."""
    inner = re.sub(r"[#\r\n\v\f\x1c-\x1e\x85\u2028\u2029]", "?", name)
    return re.sub(r"\A\s|\s\Z", "?", inner)
