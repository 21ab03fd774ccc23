# SPDX-License-Identifier: Apache-2.0
"""Events of plain SCXML and their roles, and the roles of automata (docs/spec/plain-scxml.md#events)."""

from __future__ import annotations

import enum

from roaml.record import Record


class Role(enum.Enum):
    """The role of an automaton in the system. The translation to JANI depends on it (docs/spec/jani.md#discarding)."""

    MACHINE = "machine"
    TREE_ROOT = "root of the behavior tree"
    BLACKBOARD = "blackboard"
    HANDLER = "service or action handler"
    CLOCK = "clock"


class EventRole(enum.Enum):
    """The purpose of an event. The translation to JANI depends on it (docs/spec/jani.md#event-automata)."""

    PLAIN = "plain"
    """An event that a receiver discards if it does not wait for the event."""
    BLOCKING = "blocking"
    """An event that waits for its receivers."""
    TIMER_TICK = "tick of a timer"
    CLOCK_STEP = "step of the clock"
    BLACKBOARD_READ = "read of the blackboard"
    BLACKBOARD_WRITE = "write to the blackboard"

    @property
    def is_synchronising(self) -> bool:
        """Whether the event waits for its receivers (docs/spec/jani.md#synchronising-names)."""
        return self in (EventRole.BLOCKING, EventRole.CLOCK_STEP)

    @property
    def is_internal(self) -> bool:
        """Whether the translation to JANI creates neither a buffer nor variables for the event. Internal events of
        SCXML (`<raise>`) are something else."""
        return self in (EventRole.TIMER_TICK, EventRole.CLOCK_STEP)


class ScxmlEvent(Record, frozen=True):
    """An event. Events with equal names have the same role.

    Attributes:
        after: the name of an event; while it waits for its receivers, this event cannot be received. "" if there is
            none.
    """

    name: str
    role: EventRole = EventRole.PLAIN
    after: str = ""
