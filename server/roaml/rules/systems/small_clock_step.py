# SPDX-License-Identifier: Apache-2.0
"""The rule `small-clock-step`, which small_clock_step.md describes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from roaml.diagnostics import Finding, Fix, Related, Severity, Symbol
from roaml.durations import NANOSECONDS
from roaml.facts import Facts
from roaml.model.timing import NANOSECONDS_PER_SECOND, TimerRate, period, rates
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.rules.rule import Rule, SystemContext
from roaml.rules.support.timing import drift
from roaml.text import TextEdit

MAX_STEPS_OF_PERIOD = 10
"""The maximum number of clock steps in the shortest period that is not reported."""
MAX_STEPS = 1000
"""The maximum number of clock steps in `max_time` that is not reported."""
MAX_CHANGE = Fraction(1, 5)
"""The maximum relative change of the period of a timer whose rate is suggested, included."""
MAX_DIVISORS = 1000
"""The maximum number of parts of a period for which multiples are tried as periods of another timer."""
MAX_DECIMALS = 9
"""The maximum number of decimals of a suggested rate."""
MAX_NAMED = 4
"""The maximum number of periods that a message names."""


class BetterRate(Facts, frozen=True):
    """The facts of a finding: the rate, in Hz, with which the timer `timer` of the machine in `path` makes the clock
    steps large enough. `path` is "" for the timer that ticks the tree, and if there is no such rate."""

    path: str
    timer: str
    rate: str


class _Group(Record, frozen=True):
    """The timers with the period `nanoseconds`."""

    nanoseconds: int
    timers: tuple[TimerRate, ...]

    @property
    def first(self) -> TimerRate:
        return self.timers[0]

    @property
    def is_single(self) -> bool:
        """Whether all are one declaration, which instances of a machine may share."""
        return len({(timer.path, timer.name) for timer in self.timers}) == 1

    def __str__(self) -> str:
        if not self.is_single:
            return f"the timers of {_hertz(self.first.hertz)} Hz"
        automaton = self.first.automaton
        return "`bt_tick_rate`" if automaton is None else f"`{self.first.name}` of `{automaton.name}`"


class _Suggestion(Record, frozen=True):
    """A rate of some timers; `nanoseconds` is its period, and `step_ns` the step of the clock with it."""

    group: _Group
    rate: str
    nanoseconds: int
    step_ns: int


def check(context: SystemContext) -> Iterator[Finding]:
    end = context.file.parameters.max_time
    groups = _groups(rates(context.system))
    if not groups or end is None:
        return
    timers = list(rates(context.system))
    if any(drift(timer.hertz, timers, end) is not None for timer in timers):
        return  # timer-rate reports the rate that has no exact period
    step = math.gcd(*(group.nanoseconds for group in groups))
    steps = -(-end // step)
    if groups[0].nanoseconds <= MAX_STEPS_OF_PERIOD * step or steps <= MAX_STEPS:
        return
    suggestion = _suggestion(groups)
    message = (
        f"the clock advances in steps of {_duration(step)}, the greatest common divisor of the periods of the timers "
        f"({_listed(groups)}); `max_time` has {steps:,} steps, so traces are long and the states many; choose rates "
        "whose periods are multiples of each other"
    )
    if suggestion is not None:
        message += (
            f", for example {suggestion.rate} Hz ({_duration(suggestion.nanoseconds)}) for {suggestion.group}, with "
            f"steps of {_duration(suggestion.step_ns)}"
        )
    element = context.file.parameter("max_time") or context.file.element
    related = [
        Related(
            Symbol(group.first.path, SymbolKind.TIMER, group.first.name), f"a period of {_duration(group.nanoseconds)}"
        )
        for group in groups[:MAX_NAMED]
        if group.first.automaton is not None
    ]
    fixes = _fixes(context, suggestion)
    yield RULE.at(element.name_span, message, *fixes, related=related, facts=_facts(suggestion))


def _fixes(context: SystemContext, suggestion: _Suggestion | None) -> Iterator[Fix]:
    """A fix if the rate is in the system file."""
    element = context.file.parameter("bt_tick_rate")
    value = element.get("value") if element is not None else None
    if suggestion is None or value is None:
        return
    if suggestion.group.is_single and suggestion.group.first.automaton is None:
        edit = TextEdit(value.value_span, suggestion.rate)
        yield Fix(f"Tick the tree at {suggestion.rate} Hz", (edit,), preferred=False)


def _facts(suggestion: _Suggestion | None) -> BetterRate:
    if suggestion is None or not suggestion.group.is_single or not suggestion.group.first.is_literal:
        return BetterRate("", "", "")
    timer = suggestion.group.first
    return BetterRate(timer.path, timer.name, suggestion.rate)


def _groups(timers: Iterable[TimerRate]) -> list[_Group]:
    """The timers of each period, the shortest first."""
    groups: dict[int, list[TimerRate]] = {}
    for timer in timers:
        groups.setdefault(timer.period.nanoseconds, []).append(timer)
    return [_Group(nanoseconds, tuple(groups[nanoseconds])) for nanoseconds in sorted(groups)]


# ------------------------------------------------------------------ suggestions


def _suggestion(groups: Sequence[_Group]) -> _Suggestion | None:
    """The rate of the timers of one period that makes the steps large enough: one with the largest steps, relative to
    the shortest period, then the one that changes a period least. `None` if no change of one rate suffices."""
    for steps in range(1, MAX_STEPS_OF_PERIOD + 1):
        best: tuple[Fraction, _Suggestion] | None = None
        for group in groups:
            others = [other.nanoseconds for other in groups if other is not group]
            exact = NANOSECONDS_PER_SECOND / group.first.hertz
            for ns in _periods_near(exact, others, steps):
                change = abs(ns - exact) / exact
                rate = _rate(ns) if change <= MAX_CHANGE and (best is None or change < best[0]) else None
                if rate is not None:
                    best = change, _Suggestion(group, rate, ns, math.gcd(ns, *others))
        if best is not None:
            return best[1]
    return None


def _periods_near(exact: Fraction, others: Sequence[int], steps: int) -> Iterator[int]:
    """The periods next to `exact` with which the shortest of all periods has at most `steps` clock steps."""
    common, shortest = math.gcd(*others), min(others)
    least = min(Fraction(shortest), exact * (1 - MAX_CHANGE)) / steps
    for divisor in range(1, min(math.floor(common / least), MAX_DIVISORS) + 1):
        if common % divisor == 0:
            step = common // divisor
            below = math.floor(exact / step) * step
            for ns in (below, below + step):
                if ns > 0 and min(ns, shortest) <= steps * math.gcd(ns, common):
                    yield ns


def _rate(nanoseconds: int) -> str | None:
    """The shortest decimal number whose period is `nanoseconds`, as a rate in Hz."""
    for decimals in range(MAX_DECIMALS + 1):
        units = NANOSECONDS_PER_SECOND * 10**decimals // nanoseconds
        if units and period(Fraction(units, 10**decimals)).nanoseconds == nanoseconds:
            whole, rest = divmod(units, 10**decimals)
            return f"{whole}.{rest:0{decimals}d}" if decimals else str(whole)
    return None


# ------------------------------------------------------------------ texts


def _listed(groups: Sequence[_Group]) -> str:
    shown = [
        f"{_duration(group.nanoseconds)} of {group}" + (f", {_hertz(group.first.hertz)} Hz" if group.is_single else "")
        for group in groups[:MAX_NAMED]
    ]
    more = len(groups) - MAX_NAMED
    return "; ".join(shown) + (f"; and {more} more" if more > 0 else "")


def _hertz(rate: Fraction) -> str:
    return f"{float(rate):.6g}"


def _duration(nanoseconds: int) -> str:
    """A duration in the largest unit in which it is a whole number."""
    unit, factor = next((u, f) for u, f in NANOSECONDS.items() if nanoseconds % f == 0)
    return f"{nanoseconds // factor:,} {'µs' if unit == 'us' else unit}"


RULE = Rule(
    "small-clock-step",
    Severity.WARNING,
    "The periods of the timers have a small common divisor, so the clock advances in many small steps.",
    system=check,
    facts=BetterRate,
)
