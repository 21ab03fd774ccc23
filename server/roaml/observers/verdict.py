# SPDX-License-Identifier: Apache-2.0
"""The verdict of an observer at the end of a trace (docs/spec/xml-properties.md#end)."""

from __future__ import annotations

import enum

from roaml.observers.program import Observer, State, evaluate


class End(enum.Enum):
    """Why a trace has no more letters."""

    FINISHED = "finished"
    """No further step is possible, with time left or in a model without time: the system has finished or is stuck."""
    TIME = "end of time"
    """The clock has made its last step, and no other step is possible at this instant."""
    CUT = "cut"
    """The generation of the trace was stopped."""


class Verdict(enum.Enum):
    SATISFIED = "satisfied"
    VIOLATED = "violated"
    OPEN = "open"
    """The time ended before a deadline."""
    UNDECIDED = "undecided"
    """The trace was stopped before the property was decided."""


def verdict(observer: Observer, state: State, end: End) -> Verdict:
    outputs = observer.outputs
    if state[outputs.violated.name]:
        return Verdict.VIOLATED
    if outputs.satisfied is not None and state[outputs.satisfied.name]:
        return Verdict.SATISFIED
    if end is End.CUT:
        return Verdict.UNDECIDED
    if not evaluate(outputs.pending, state, {}, False):
        return Verdict.SATISFIED
    if end is End.FINISHED or evaluate(outputs.due, state, {}, False):
        return Verdict.VIOLATED
    return Verdict.OPEN
