# SPDX-License-Identifier: Apache-2.0
"""Periods of timers, and the unit of the clock of a system (docs/spec/plain-scxml.md#time)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

from roaml.durations import NANOSECONDS
from roaml.exact_number import exact_number
from roaml.model.expand import PortConstant
from roaml.model.system import System, SystemAutomaton
from roaml.record import Record

NANOSECONDS_PER_SECOND = 10**9


class Period(Record, frozen=True):
    """A period of `count` units of `unit` ns."""

    count: int
    unit: int

    @property
    def nanoseconds(self) -> int:
        return self.count * self.unit


def period(rate: Fraction) -> Period:
    """The period of a rate in Hz, rounded down, but at least 1 ns. Its unit is the largest one in which the period is
    exact or has a count of at least 101."""
    exact = NANOSECONDS_PER_SECOND / rate
    for unit in NANOSECONDS.values():
        count = exact / unit
        if count.denominator == 1 or count >= 101:
            return Period(math.floor(count), unit)
    return Period(max(1, math.floor(exact)), 1)


class TimerRate(Record, frozen=True):
    """A timer with a valid rate.

    Attributes:
        automaton: the automaton that uses it; `None` for the timer that ticks the tree.
        name: the name of its declaration; "" for the timer that ticks the tree.
        hertz: its rate in Hz.
        is_literal: whether its declaration contains the rate, instead of a port.
    """

    automaton: SystemAutomaton | None
    name: str
    hertz: Fraction
    is_literal: bool = True

    @property
    def path(self) -> str:
        """The path of the machine that declares it; "" for the timer that ticks the tree."""
        return self.automaton.path if self.automaton is not None else ""

    @property
    def period(self) -> Period:
        return period(self.hertz)


def rates(system: System) -> Iterator[TimerRate]:
    """All timers of a system, including the timer that ticks the tree; timers with an invalid rate are left out."""
    for root in system.roots:
        yield TimerRate(None, root.tree, Fraction(str(system.tick_rate(root.tree))))
    for automaton in system.automata:
        for timer in automaton.outline.timers:
            hertz = rate(automaton, timer.rate, timer.port)
            if hertz is not None:
                yield TimerRate(automaton, timer.name, hertz, not timer.port)


def periods(system: System) -> Iterator[Period]:
    """The periods of all timers that `rates` returns."""
    return (timer.period for timer in rates(system))


def rate(automaton: SystemAutomaton, text: str, port: str) -> Fraction | None:
    """The rate of a timer in Hz: the value of the port `port` of the automaton; without a port, the number in `text`.
    `None` if the rate is invalid."""
    value = automaton.port(port) if port else PortConstant(text)
    if not isinstance(value, PortConstant):
        return None
    hertz = exact_number(value.text)
    return hertz if hertz is not None and 0 < hertz <= NANOSECONDS_PER_SECOND else None
