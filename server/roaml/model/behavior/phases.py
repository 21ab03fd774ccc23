# SPDX-License-Identifier: Apache-2.0
"""The types of the graph of a chart: events, duties, and the answers that a configuration owes and awaits."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from roaml.exhaustive import Vocabulary
from roaml.record import Record
from roaml.roles import ProtocolPart


class ProtocolEvent(NamedTuple):
    """An event that a machine receives or sends: the part of an interface or of the tree protocol, and the handle or
    the name of the event ("" for the tree)."""

    part: ProtocolPart
    name: str


class DutyKind(Vocabulary):
    TICK = "tick"
    HALT = "halt"
    REQUEST = "request"
    GOAL = "goal"
    """A goal that must be accepted or rejected."""
    RESULT = "result"
    """An accepted goal that must be ended."""
    THREAD = "thread"
    """The start of a thread; only faults have this kind."""

    @property
    def is_of_tree(self) -> bool:
        return self is DutyKind.TICK or self is DutyKind.HALT


class Duty(NamedTuple):
    """An event that must be answered exactly once. `handle` is the handle of the server; "" for ticks and halts."""

    kind: DutyKind
    handle: str


TICK, HALT = Duty(DutyKind.TICK, ""), Duty(DutyKind.HALT, "")


class Subject(Vocabulary):
    """A part of the protocol that has a phase: the plugin, its children, or a kind of answer."""

    TREE = "tree"
    """The plugin itself, as a node of the tree."""
    CHILD = "child"
    """The children of the plugin, as nodes of the tree."""
    REQUEST = "request"
    GOAL = "goal"
    RESULT = "result"
    """REQUEST, GOAL and RESULT: the answers that a server owes."""
    RESPONSE = "response"
    DECISION = "decision"
    OUTCOME = "outcome"
    """RESPONSE, DECISION and OUTCOME: the answers that a client waits for. The decision accepts or rejects the goal of
    the client; the outcome is the result of this goal."""


class Phase(Vocabulary):
    """The phase of a subject. A subject without a phase is idle; a `TREE` without a phase has been neither ticked nor
    halted."""

    TICKED = "ticked"
    HALTING = "halting"
    RUNNING = "running"
    ENDED = "ended"
    HALTED = "halted"
    DUE = "due"
    AWAITED = "awaited"
    SEVERAL = "several"
    """Several answers are due or awaited; the exact number is not stored."""


OWED = {DutyKind.REQUEST: Subject.REQUEST, DutyKind.GOAL: Subject.GOAL, DutyKind.RESULT: Subject.RESULT}
"""Kind of duty -> the subject whose phase states whether the server owes the answer."""

AWAITED_ANSWER = {
    ProtocolPart.RESPONSE: Subject.RESPONSE,
    ProtocolPart.RESULT: Subject.OUTCOME,
    ProtocolPart.GOAL_RESPONSE: Subject.DECISION,
}
"""The event that a client receives -> the answer that it brings."""


class GoalStatus(Vocabulary):
    """The status of a goal whose id a variable holds."""

    ASKED = "asked"
    ACCEPTED = "accepted"
    EARLIER = "earlier"
    """An accepted goal during the step that handles the arrival of a later goal."""
    REJECTED = "rejected"
    FINISHED = "finished"
    FOREIGN = "foreign"
    """A value that is not the id of a goal."""
    ANY = "any"
    """The content of the variable is not known."""


class HeldId(Record, frozen=True):
    """The id of a goal in a variable. `of` is the handle of the server to which the goal was sent; for a foreign value,
    it is the text of the assigned expression."""

    status: GoalStatus
    of: str


ANY_ID = HeldId(GoalStatus.ANY, "")

Phases: TypeAlias = tuple[tuple[tuple[Subject, str], Phase], ...]
"""The phases of all subjects that have one: sorted pairs of (subject, handle) and phase. The handle names the server or
client."""
HeldIds: TypeAlias = tuple[tuple[str, HeldId], ...]
"""The variables in which an id was stored, with the ids; sorted by variable."""


def phase_in(phases: Phases, subject: Subject, handle: str) -> Phase | None:
    for (other, name), phase in phases:
        if other is subject and name == handle:
            return phase
    return None
