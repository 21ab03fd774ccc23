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
    debugger: Debugger, timeline: Timeline, axis: Axis, start: float, by: float, count: int
) -> Iterator[tuple[int, float]]:
    """Move the run to the states at `start`, `start + by`, …, at most `count`, within `Debugger.elsewhere`. States that
    are the same as before are left out, those between two of them in which a property is decided are added, and the
    last one is the end of the run.

    Args:
        start, by: positions on the axis, in s or steps.

    Yields:
        The number of steps before the state, and its position on the axis.
    """
    session = debugger.session
    before = _reach(debugger, timeline, axis, start - by) if start >= by else 0
    for number in range(count):
        position = start + number * by
        try:
            step = _reach(debugger, timeline, axis, position)
        except FaultError:
            return
        if step != before or number == 0:
            session.jump(step)
            debugger.follow()
            decided = {one.position for one in debugger.decided if before < one.position < step}
            for shown in (*sorted(decided), step):
                session.jump(shown)
                yield shown, position_of(timeline, axis, shown)
        before = step
        if session.end is not None:
            return


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
