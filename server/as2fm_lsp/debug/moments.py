# SPDX-License-Identifier: Apache-2.0
"""The moments of a run that a client plays: the states at positions in equal distances on an axis.

They are computed ahead of what is played. The run returns to its position, so that playing changes nothing.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.debugging.debugger import Debugger
from roaml.smc.fault import FaultError
from roaml.timeline import Axis, Timeline, position_of, step_at

MAX_MOMENTS = 200
"""The maximum number of moments of one request."""
MAX_STEPS = 5_000
"""The maximum number of new steps that are taken for one moment."""


def moments(
    debugger: Debugger, timeline: Timeline, axis: Axis, start: float, by: float, count: int, after: int | None
) -> Iterator[tuple[int, float, str | None]]:
    """Move the run to the states at `start`, `start + by`, …, at most `count`, within `Debugger.elsewhere`. States that
    are the same as before are left out, those between two of them in which a property is decided are added, and the
    last one is the end of the run, or the first state in which a breakpoint or an undefined operation stops it.

    Args:
        start, by: positions on the axis, in s or steps.
        after: only states after this step are shown, and breakpoints stop the run only there; `None` if the state at
            `start` is the first one.

    Yields:
        The number of steps before the state, its position on the axis, and why the run stops there; `None` if it goes
        on.
    """
    session = debugger.session
    before, fault = after, None
    for number in range(count):
        try:
            step = _reach(debugger, timeline, axis, start + number * by)
        except FaultError as error:
            step, fault = len(session.steps), error.message
        session.jump(step)
        before = step - 1 if before is None else before
        if step <= before and fault is None and session.end is None:
            continue
        debugger.follow()
        last, reason = debugger.first_stop(before, step) or (step, fault)
        decided = {one.position for one in debugger.decided if before < one.position < last}
        for shown in (*sorted(decided), last):
            session.jump(shown)
            yield shown, position_of(timeline, axis, shown), reason if shown == last else None
        if reason is not None or session.end is not None:
            return
        before = step


def _reach(debugger: Debugger, timeline: Timeline, axis: Axis, position: float) -> int:
    """The number of the last step up to a position. If the run is shorter, new steps are taken."""
    session = debugger.session
    if axis is Axis.STEPS:
        session.jump(int(position))
        timeline.follow(session)
        return session.position
    for _ in range(MAX_STEPS):
        timeline.follow(session)
        if timeline.times[-1] > position:
            break
        session.jump(len(session.steps))
        if session.step() is None:
            break
    return step_at(timeline, axis, position)
