# SPDX-License-Identifier: Apache-2.0
"""Durations as users write them, such as `100 s`, and the reaction time of machines."""

from __future__ import annotations

from roaml.record import Record

NANOSECONDS = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}
"""Unit of time in models -> its length in ns, the longest first."""
UNITS = {"h": 3600 * 10**9, "min": 60 * 10**9, **NANOSECONDS}
"""Unit of time in texts of users -> its length in ns."""
DEFAULT_MAX_TIME = 600 * 10**9
"""The time, in ns, for which a tree without a system runs unless an option limits it."""
ANY, INSTANT = "any", "instant"
REACTION_TIME = "a reaction time must be `any`, `instant`, or a duration such as `20 ms`"


def duration(text: str) -> int | None:
    """The duration in `text`, in ns; `None` if `text` is not a duration above 0, such as `100 s` or `5min`."""
    return _nanoseconds(text) or None


def duration_text(nanoseconds: int) -> str:
    """A duration as `duration` reads it, in the largest unit of which it is a whole number."""
    unit = next(unit for unit, length in NANOSECONDS.items() if nanoseconds % length == 0)
    return f"{nanoseconds // NANOSECONDS[unit]} {unit}"


def moment(seconds: float) -> str:
    """A time of a run, to the ms: `2.000 s`. Every report and view states times of runs with this function, or with
    `short_moment`, so that equal times agree. Halves are rounded up, as `toFixed` of JavaScript does in the editor."""
    is_half = (seconds * 16).is_integer()  # of all halves of a ms, only multiples of 1/16 s are floats
    return f"{seconds + 1e-6 if is_half else seconds:.3f} s"


def short_moment(seconds: float) -> str:
    """The same time as `moment`, without zeros at its end: `2 s`."""
    return f"{moment(seconds)[:-2].rstrip('0').rstrip('.')} s"


class ReactionTime(Record, frozen=True):
    """An assumption about the time that a machine waits before it takes a possible step
    (docs/spec/semantics.md#reaction-time).

    Attributes:
        nanoseconds: the maximum; 0 if machines react at once, `None` if there is no maximum.
    """

    nanoseconds: int | None = None

    @property
    def is_any(self) -> bool:
        return self.nanoseconds is None

    @property
    def is_instant(self) -> bool:
        return self.nanoseconds == 0

    @property
    def text(self) -> str:
        """The assumption as `reaction_time` reads it."""
        if self.nanoseconds is None:
            return ANY
        return duration_text(self.nanoseconds) if self.nanoseconds else INSTANT

    def steps(self, step: int) -> int:
        """The maximum in steps of a clock, rounded up; only for a duration above 0.

        Args:
            step: the length of a step of the clock, in ns.
        """
        assert self.nanoseconds
        return -(-self.nanoseconds // step)


ANY_TIME = ReactionTime()
AT_ONCE = ReactionTime(0)


def reaction_time(text: str) -> ReactionTime | None:
    """The reaction time that `text` names: `any`, `instant`, or a duration such as `20 ms`; a duration of 0 is
    `instant`. `None` for other texts."""
    word = text.strip()
    if word in (ANY, INSTANT):
        return ANY_TIME if word == ANY else AT_ONCE
    nanoseconds = _nanoseconds(word)
    return None if nanoseconds is None else ReactionTime(nanoseconds)


def _nanoseconds(text: str) -> int | None:
    number = text.strip().rstrip("abcdefghijklmnopqrstuvwxyz")
    unit = text.strip().removeprefix(number)
    value = integer(number.strip())
    return value * UNITS[unit] if value is not None and unit in UNITS else None


def integer(text: str) -> int | None:
    """The number in `text`, of which the first 18 digits are used; `None` if `text` has other characters."""
    return int(text[:18]) if text.isascii() and text.isdigit() else None
