# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about time: timers of a machine, durations in trees, and texts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction

from roaml.durations import NANOSECONDS, duration_text
from roaml.exact_number import exact_number
from roaml.libraries.programs.assembly import programs
from roaml.model.expand import PortConstant
from roaml.model.machine import Declaration
from roaml.model.syntax import Expression, Name
from roaml.model.system import System, SystemAutomaton
from roaml.model.system_file import TICK_RATE
from roaml.model.timing import NANOSECONDS_PER_SECOND, TimerRate, period, rate
from roaml.model.tree import TreeNode
from roaml.model.waits import CountedWait, ending_waits, waits
from roaml.record import Record
from roaml.roles import SymbolKind
from roaml.rules.rule import MachineContext, SystemContext, TreeContext
from roaml.rules.support.instances import instances
from roaml.rules.support.settings import constant_settings, integer_of
from roaml.text import Span


def timers(context: MachineContext) -> Iterator[tuple[Declaration, Name, Fraction]]:
    """The timers of a machine whose declaration contains a valid rate, with the rate as written and in Hz."""
    for declaration in context.machine.declarations:
        rate = declaration.rate
        if declaration.kind is SymbolKind.TIMER and isinstance(rate, Name):
            hertz = exact_number(rate.value)
            if hertz is not None and 0 < hertz <= NANOSECONDS_PER_SECOND:
                yield declaration, rate, hertz


def durations(context: TreeContext) -> Iterator[tuple[TreeNode, str, int]]:
    """The nodes of the trees of a system whose programs measure time, each with its port and the time in ns. 0 is left
    out."""
    seen: set[tuple[TreeNode, str]] = set()
    for node, port, text in constant_settings(context):
        name = node.plugin.value if node.plugin is not None else ""
        program = programs().get(name)
        if program is not None and port in program.timed_ports and (node, port) not in seen:
            seen.add((node, port))
            milliseconds = integer_of(text)
            if milliseconds is not None and milliseconds > 0:
                yield node, port, milliseconds * NANOSECONDS["ms"]


def port_durations(context: TreeContext) -> Iterator[tuple[TreeNode, SystemAutomaton, str, Fraction, int]]:
    """The executed nodes whose plugins count ticks of a timer up to the value of a port: node, automaton, port, the
    rate of the timer in Hz, and the time until the node can return SUCCESS, in ns."""
    for node, automaton in instances(context):
        for wait in automaton.outline.plugin.port_waits:
            value = automaton.port(wait.port)
            limit = exact_number(value.text) if isinstance(value, PortConstant) else None
            hertz = _rate_of(automaton, wait.timer)
            if limit is not None and limit > 0 and hertz is not None:
                ticks = math.ceil(limit * wait.ticks_per_unit)
                yield node, automaton, wait.port, hertz, ticks * period(hertz).nanoseconds


def _rate_of(automaton: SystemAutomaton, name: str) -> Fraction | None:
    timer = next((timer for timer in automaton.outline.timers if timer.name == name), None)
    return rate(automaton, timer.rate, timer.port) if timer is not None else None


def counted_waits(context: MachineContext) -> Iterator[tuple[CountedWait, Fraction, int]]:
    """The comparisons of a machine with a number that first hold after some ticks of a timer, with the rate of the
    timer in Hz and the time in ns; in the automaton in which it is least."""
    for chart in context.machine.charts:
        values = (v.value for v in context.typed.values if v.place.chart is chart)
        yield from _timed(context, waits(chart, (value for value in values if isinstance(value, Expression))))


def ending_counts(context: MachineContext) -> Iterator[tuple[CountedWait, Fraction, int]]:
    """The same for the conditions that hold until the number is reached, and behind which something else is done."""
    for chart in context.machine.charts:
        yield from _timed(context, ending_waits(context.machine, chart))


def _timed(context: MachineContext, found: Iterable[CountedWait]) -> Iterator[tuple[CountedWait, Fraction, int]]:
    for wait in found:
        hertz = [rate for a in context.automata if (rate := _rate_of(a, wait.timer)) is not None]
        if not wait.port and wait.limit > 0 and hertz and len(hertz) == len(context.automata):
            ticks = math.ceil(wait.ticks(wait.limit))
            yield wait, max(hertz), ticks * period(max(hertz)).nanoseconds


def tick_period(context: TreeContext) -> int | None:
    """The shortest time between two ticks of a tree of a system, in ns; `None` without a system."""
    if context.system is None:
        return None
    names = [root.tree for root in context.system.roots]
    rates = {context.system.tick_rate(name) for name in names} or {context.system.parameters.tick_rate}
    return min(period(Fraction(str(rate))).nanoseconds for rate in rates)


def running_first(system: System) -> dict[int, int]:
    """The nodes of the trees whose plugins never return SUCCESS at their first tick: number of the node -> the time
    until the next tick, in ns."""
    times: dict[int, int] = {}
    for automaton in system.automata:
        statuses = automaton.outline.plugin.statuses
        if automaton.instance is not None and automaton.path and _SUCCESS in statuses.ever - statuses.first:
            rate = Fraction(str(system.tick_rate(automaton.instance.tree)))
            times[automaton.instance.number] = period(rate).nanoseconds
    return times


_SUCCESS = "SUCCESS"


def tree_rates(context: SystemContext) -> Iterator[tuple[Span, Fraction, str]]:
    """The rates in Hz that a system file states for its trees, with their places, and the name of a tree with this
    rate."""
    element, system = context.file.parameter("bt_tick_rate"), context.system
    value = element.get("value") if element is not None else None
    common = next((root.tree for root in system.roots if not system.has_own_rate(root.tree)), None)
    if value is not None and common is not None:
        yield value.value_span, Fraction(str(context.file.parameters.tick_rate)), common
    for listed in context.files:
        own = listed.input.element.get(TICK_RATE)
        if own is not None and listed.input.tick_rate is not None:
            yield own.value_span, Fraction(str(listed.input.tick_rate)), listed.input.tree


class Drift(Record, frozen=True):
    """A timer that should tick at the same time as `other` at the time `at_ns`, but ticks `early_ns` earlier."""

    other: TimerRate
    at_ns: int
    early_ns: Fraction


def drift(hertz: Fraction, others: Iterable[TimerRate], end: int | None) -> Drift | None:
    """The drift of a timer whose rate has no exact period, against the timer with an exact period that it should meet
    first; `None` if there is none before `end`, the end of the traces in ns."""
    exact, rounded = NANOSECONDS_PER_SECOND / hertz, period(hertz).nanoseconds
    if exact == rounded or end is None:
        return None
    meetings: list[tuple[Fraction, TimerRate]] = []
    for other in others:
        if other.period.nanoseconds == NANOSECONDS_PER_SECOND / other.hertz:
            meetings.append((_common_multiple(exact, NANOSECONDS_PER_SECOND / other.hertz), other))
    at, first = min(meetings, key=lambda meeting: meeting[0], default=(None, None))
    if at is None or first is None or at > end:
        return None
    return Drift(first, int(at), at - at / exact * rounded)


def _common_multiple(first: Fraction, second: Fraction) -> Fraction:
    """The least common multiple of two durations."""
    denominator = math.lcm(first.denominator, second.denominator)
    return Fraction(math.lcm(int(first * denominator), int(second * denominator)), denominator)


def are_multiples(hertz: Fraction, other: Fraction) -> bool:
    """Whether one of two rates is a multiple of the other."""
    return (hertz / other).denominator == 1 or (other / hertz).denominator == 1


def duration(nanoseconds: int | Fraction) -> str:
    """A duration in the largest unit in which it is a whole number; otherwise in ms, rounded."""
    if nanoseconds != int(nanoseconds):
        return f"{float(nanoseconds) / NANOSECONDS['ms']:.6g} ms"
    return duration_text(int(nanoseconds))
