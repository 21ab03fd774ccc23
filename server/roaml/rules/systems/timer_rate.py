# SPDX-License-Identifier: Apache-2.0
"""The rule `timer-rate`, which timer_rate.md describes."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from roaml.diagnostics import Finding, Fix, Severity
from roaml.model.system import System
from roaml.model.timing import NANOSECONDS_PER_SECOND, TimerRate, period, rates
from roaml.rules.rule import MachineContext, Rule, SystemContext
from roaml.rules.support.timing import are_multiples, drift, duration, timers, tree_rates
from roaml.text import Span, TextEdit

MAX_RATE = 1000
"""The greatest rate in Hz that is not reported. Timers of ROS 2 do not keep a higher rate."""
MAX_LOWER_RATES = 20
"""The maximum number of lower rates that are tried as a correction."""


def _machine(context: MachineContext) -> Iterator[Finding]:
    if context.system is None or not context.automata:
        return
    for declaration, rate, hertz in timers(context):
        own = (context.source.path, declaration.handle.value if declaration.handle else "")
        yield from _check(context.system, rate.span, hertz, own)


def _system(context: SystemContext) -> Iterator[Finding]:
    for place, hertz, tree in tree_rates(context):
        yield from _check(context.system, place, hertz, ("", tree))


def _check(system: System, place: Span, hertz: Fraction, own: tuple[str, str]) -> Iterator[Finding]:
    """Check a rate; `own` is the path and the name of its timer."""
    end, rounded = system.parameters.max_time, period(hertz).nanoseconds
    if hertz > MAX_RATE:
        ticks = f", {end // rounded:,} ticks until `max_time`" if end else ""
        message = f"{float(hertz):g} Hz is one tick every {duration(rounded)}{ticks}; check the number, which is in Hz"
        yield RULE.at(place, message)
        return
    others = [timer for timer in rates(system) if (timer.path, timer.name) != own]
    drifting = drift(hertz, others, end)
    if drifting is not None:
        other = drifting.other
        whose = "the tree" if other.automaton is None else f"`{other.name}` of `{other.automaton.name}`"
        message = (
            f"{float(hertz):g} Hz is rounded to a period of {duration(rounded)}, so the timer drifts: after "
            f"{duration(drifting.at_ns)}, it ticks {duration(drifting.early_ns)} before {whose} "
            f"({float(other.hertz):g} Hz), which it should meet; choose a rate whose period is exact"
        )
        yield RULE.at(place, message, *_fixes(place, hertz, other))


def _fixes(place: Span, hertz: Fraction, other: TimerRate) -> Iterator[Fix]:
    """The next lower rate with an exact period that meets the other timer."""
    if hertz.denominator != 1:
        return
    for rate in range(int(hertz) - 1, max(0, int(hertz) - MAX_LOWER_RATES), -1):
        is_exact = rate * period(Fraction(rate)).nanoseconds == NANOSECONDS_PER_SECOND
        if is_exact and are_multiples(Fraction(rate), other.hertz):
            yield Fix(f"Change to {rate} Hz", (TextEdit(place, str(rate)),), preferred=False)
            return


RULE = Rule(
    "timer-rate",
    Severity.WARNING,
    "A rate is very high, or does not stay in step with another rate.",
    machine=_machine,
    system=_system,
    whole=True,
)
