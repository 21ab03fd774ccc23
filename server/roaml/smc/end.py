# SPDX-License-Identifier: Apache-2.0
"""Why a trace has ended.

In any model, a trace ends because the goal is decided, because no step is possible (DEADLOCK), because only steps
without any change are possible (IDLE), because the same states repeat for ever (ROUND), or because there were too many
steps (CUT). A caller that knows the meaning of
the automata marks their locations. The marks explain why a trace without further changes ends: of the marks of all
current locations, the smallest number is used.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from typing import TypeAlias


class End(IntEnum):
    """The reason why a trace has ended. The kernel uses the same numbers; `TIME` to `QUIET` are the marks of
    locations."""

    DECIDED = 0
    """The question about the trace was decided."""
    TIME = 1
    """The time of the model is over."""
    FINISHED = 2
    """The behavior tree has finished."""
    STUCK = 3
    """Automata wait for one another."""
    QUIET = 4
    """There is nothing left to do."""
    DEADLOCK = 5
    """No step is possible."""
    IDLE = 6
    """Only steps that change nothing are possible, or a sampled scheduler repeats a cycle of states."""
    CUT = 7
    """The trace had the maximum length."""
    ROUND = 8
    """The trace visits some states again and again, and these do not decide the question (`rounds`)."""

    @property
    def text(self) -> str:
        """The reason as a phrase for users."""
        return _TEXTS[self]

    @property
    def key(self) -> str:
        """The reason as a key for programs."""
        return self.text.replace(" ", "_")


_TEXTS = {
    End.DECIDED: "goal decided",
    End.TIME: "end of time",
    End.FINISHED: "tree finished",
    End.STUCK: "stuck",
    End.QUIET: "nothing left to do",
    End.DEADLOCK: "no step possible",
    End.IDLE: "no change possible",
    End.CUT: "too many steps",
    End.ROUND: "repeats for ever",
}


Marks: TypeAlias = Mapping[tuple[str, str], End]
"""(automaton, location) -> why a trace ends there, if it never leaves the location."""
