# SPDX-License-Identifier: Apache-2.0
"""How many traces are generated if nobody has asked for a number: fewer if traces are long, so that work ends."""

from __future__ import annotations

from collections.abc import Callable

from roaml.record import Record

MAX_STEPS = 200_000_000
"""The number of steps that all traces together may have; these take about 10 s."""
_PILOTS = 5
"""How many further traces determine how long traces are. They are not used otherwise, so that the number of traces does
not depend on what the others show."""


class Affordable(Record, frozen=True):
    """A number of traces.

    Attributes:
        traces: the number.
        wanted: the number if traces were short.
    """

    traces: int
    wanted: int

    @property
    def remark(self) -> str:
        """Why there are fewer traces, and what to do, as a phrase; "" if there are not."""
        if self.traces == self.wanted:
            return ""
        return f"{self.traces:,} instead of {self.wanted:,} traces, because they are long; set max_traces for more"


def affordable(wanted: int, least: int, steps_of: Callable[[int], int], max_steps: int | None = None) -> Affordable:
    """The number of traces that have about `max_steps` steps together, at least `least` and at most `wanted`.

    Args:
        max_steps: `None` for `MAX_STEPS`.
        steps_of: simulates the trace with a number and returns its number of steps.
    """
    steps = max(1, sum(steps_of(wanted + pilot) for pilot in range(_PILOTS)) // _PILOTS)
    return Affordable(min(wanted, max(least, (MAX_STEPS if max_steps is None else max_steps) // steps)), wanted)
