# SPDX-License-Identifier: Apache-2.0
"""The vocabulary of the graph of a chart: events, duties, and what is owed and awaited in a configuration."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from roaml.exhaustive import Vocabulary
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
    """Something that must be answered exactly once. `handle` is that of the server, "" for the tree."""

    kind: DutyKind
    handle: str


TICK, HALT = Duty(DutyKind.TICK, ""), Duty(DutyKind.HALT, "")


class Subject(Vocabulary):
    """What a phase is the phase of."""

    TREE = "tree"
    """The plugin itself, as a node of the tree."""
    CHILD = "child"
    """Its children."""
    REQUEST = "request"
    GOAL = "goal"
    RESULT = "result"
    """The duties of a server."""
    RESPONSE = "response"
    DECISION = "decision"
    OUTCOME = "outcome"
    """What a client waits for; the outcome is the result of its goal."""


class Phase(Vocabulary):
    """The phase of a subject; a subject without a phase is idle, and a tree without one was never ticked."""

    TICKED = "ticked"
    HALTING = "halting"
    RUNNING = "running"
    ENDED = "ended"
    HALTED = "halted"
    DUE = "due"
    AWAITED = "awaited"
    SEVERAL = "several"
    """Several answers are due or awaited; their number is not followed."""


OWED = {DutyKind.REQUEST: Subject.REQUEST, DutyKind.GOAL: Subject.GOAL, DutyKind.RESULT: Subject.RESULT}
"""The subject whose phase says whether a server owes the answer to a duty."""


class GoalStatus(Vocabulary):
    """What a variable for the id of a goal holds."""

    ASKED = "asked"
    ACCEPTED = "accepted"
    EARLIER = "earlier"
    """An accepted goal, while a later goal is decided on."""
    REJECTED = "rejected"
    FINISHED = "finished"
    FOREIGN = "foreign"
    """A value that is not the id of a goal."""
    ANY = "any"
    """It is not known what it holds."""


class HeldId(NamedTuple):
    """`of` is the handle of the server that the goal was sent to, or the text of the expression of a foreign value."""

    status: GoalStatus
    of: str


ANY_ID = HeldId(GoalStatus.ANY, "")

Phases: TypeAlias = tuple[tuple[tuple[Subject, str], Phase], ...]
"""Sorted; subjects of servers and clients are distinguished by their handles."""
HeldIds: TypeAlias = tuple[tuple[str, HeldId], ...]
"""The variables that hold an id that was stored, sorted."""


def phase_in(phases: Phases, subject: Subject, handle: str) -> Phase | None:
    for (other, name), phase in phases:
        if other is subject and name == handle:
            return phase
    return None
