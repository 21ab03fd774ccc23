# SPDX-License-Identifier: Apache-2.0
"""The parameters of a system (docs/spec/systems.md#parameters)."""

from __future__ import annotations

from roaml.record import Record, replace

DEFAULT_MAX_ARRAY_SIZE = 100
DEFAULT_TICK_RATE = 1.0
DEFAULT_RANDOM_VALUES = 100
MAX_RANDOM_VALUES = 10_000
"""The maximum of `random_values`. It is limited because each value is a destination of an edge in JANI."""
NANOSECONDS = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}
"""Unit of time -> its length in ns, the longest first."""


class Parameters(Record, frozen=True):
    """The parameters with which a system is translated.

    Attributes:
        max_time: the bound of the clock in ns; `None` if it is not given or invalid.
        tick_rate: the rate of ticks of the behavior tree, in Hz.
        random_values: the number n of the values of `Math.random()`: 0, 1/n, 2/n, … (docs/spec/expressions.md#random).
    """

    max_time: int | None = None
    max_array_size: int = DEFAULT_MAX_ARRAY_SIZE
    tick_rate: float = DEFAULT_TICK_RATE
    tick_if_not_running: bool = False
    random_values: int = DEFAULT_RANDOM_VALUES


class Overrides(Record, frozen=True):
    """Parameters that replace those of a system file. A parameter that is `None` replaces nothing; see `Parameters`."""

    max_time: int | None = None
    max_array_size: int | None = None

    def applied(self, parameters: Parameters) -> Parameters:
        max_time = parameters.max_time if self.max_time is None else self.max_time
        size = parameters.max_array_size if self.max_array_size is None else self.max_array_size
        return replace(parameters, max_time=max_time, max_array_size=size)


NO_OVERRIDES = Overrides()


def duration(text: str) -> int | None:
    """The duration in `text`, in ns; `None` if `text` is not a duration above 0, such as `100 s` or `250ms`."""
    number = text.strip().rstrip("abcdefghijklmnopqrstuvwxyz")
    unit = text.strip().removeprefix(number)
    value = integer(number.strip())
    return value * NANOSECONDS[unit] if value and unit in NANOSECONDS else None


def integer(text: str) -> int | None:
    return int(text[:18]) if text.isascii() and text.isdigit() else None
