# SPDX-License-Identifier: Apache-2.0
"""Timers and the clock that makes them fire (docs/spec/plain-scxml.md#time).

- All times are integers. Only the periods are rounded, as in the reference translator.
- Every automaton that uses a timer has a separate event for its ticks. If only one automaton uses it, the event has the
  name of the timer.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction

from roaml.expr.operators import Operator
from roaml.expr.tree import Call, Expr, Member
from roaml.expr.types import BASE_TYPES
from roaml.lower.build import binary, equal, integer, name
from roaml.lower.interfaces import topic_event
from roaml.lower.machine import copies
from roaml.lower.program import TranslatableSystem
from roaml.lower.tree import tick_timer
from roaml.model.machine import Chart, Declaration, Machine
from roaml.model.syntax import Name, PortRead
from roaml.model.system import CLOCK_TOPIC, SystemAutomaton
from roaml.model.timing import NANOSECONDS_PER_SECOND, Period, period, rate
from roaml.record import Record
from roaml.roles import ProtocolPart, SymbolKind
from roaml.scxml.events import EventRole, Role, ScxmlEvent
from roaml.scxml.model import Assign, Branch, Data, If, Param, Send, State, Statement, Target, Transition
from roaml.scxml.model import Automaton as PlainAutomaton
from roaml.scxml.names import CLOCK, CLOCK_STEP, FIELD_PREFIX, TIME_IS_OVER, TIMER_PREFIX, safe_name
from roaml.text import NO_SPAN, Location


class Timer(Record, frozen=True):
    """A timer of one automaton.

    Attributes:
        user: the name of the plain automaton that it triggers.
        handle: its name in that automaton.
        event: the event of its ticks; `None` if no handler waits for them.
    """

    user: str
    handle: str
    event: ScxmlEvent | None
    period: Period
    origin: Location


def timers_of(program: TranslatableSystem, members: Iterable[tuple[SystemAutomaton, Machine]]) -> list[Timer]:
    """All timers in the order of their declarations: those of the ROS nodes, those of the trees, and those of the nodes
    of the tree."""
    declared: list[tuple[str, str, Fraction, bool, Location]] = []
    in_tree: list[tuple[str, str, Fraction, bool, Location]] = []
    for automaton, machine in members:
        (declared if automaton.instance is None else in_tree).extend(_declared(automaton, machine, program))
    for root in program.system.roots:
        rate = Fraction(str(program.system.tick_rate(root.tree)))
        declared.append((*tick_timer(program, root), rate, True, program.node(root.number)))
    declared += in_tree
    handles = [handle for _, handle, _, used, _ in declared if used]
    return [
        Timer(user, handle, _event(user, handle, handles.count(handle) == 1) if used else None, period(rate), origin)
        for user, handle, rate, used, origin in declared
    ]


def _event(user: str, handle: str, alone: bool) -> ScxmlEvent:
    name = f"{TIMER_PREFIX}{handle}" if alone else f"{TIMER_PREFIX}{handle}__{safe_name(user)}"
    return ScxmlEvent(name, EventRole.TIMER_TICK)


def _declared(
    automaton: SystemAutomaton, machine: Machine, program: TranslatableSystem
) -> Iterator[tuple[str, str, Fraction, bool, Location]]:
    """For each timer of a machine: its user, its handle, its rate in Hz, whether a handler waits for it, and its
    place."""
    for declaration in machine.declarations:
        if declaration.kind is SymbolKind.TIMER:
            assert declaration.handle is not None
            handle = declaration.handle.value
            origin = Location(automaton.path, declaration.element.span)
            users = [user for user, chart, _ in copies(automaton, machine) if handle in _awaited(chart)]
            for user in users or [automaton.name]:
                yield user, handle, _rate(declaration, automaton), bool(users), origin


def _awaited(chart: Chart) -> set[str]:
    """The handles of the timers for which a chart has callbacks."""
    return {
        handler.handle.value
        for state in chart.states
        for handler in state.handlers
        if handler.trigger is ProtocolPart.TICK and handler.handle and handler.effective
    }


def _rate(declaration: Declaration, automaton: SystemAutomaton) -> Fraction:
    text = declaration.rate.value if isinstance(declaration.rate, Name) else ""
    port = declaration.rate.key.value if isinstance(declaration.rate, PortRead) and declaration.rate.key else ""
    hertz = rate(automaton, text, port)
    assert hertz is not None, "a rule reports invalid rates"
    return hertz


# ------------------------------------------------------------------- the clock


STEP = ScxmlEvent(CLOCK_STEP, EventRole.CLOCK_STEP)


def clock_step(timers: Iterable[Timer]) -> int:
    """The length of a step of the clock, in ns; 0 if there are no timers."""
    return math.gcd(*(timer.period.nanoseconds for timer in timers))


def clock(timers: list[Timer], max_time: int, origin: Location) -> PlainAutomaton:
    """The automaton that advances the time and triggers timers. `max_time`, in ns, is its maximum time."""
    unit = min(timer.period.unit for timer in timers)
    periods = [timer.period.nanoseconds // unit for timer in timers]
    step = clock_step(timers) // unit
    end = -(-max_time // unit)
    now = name("current_time")
    ticks = [
        _tick(timer.event, equal(binary(now, Operator.REMAINDER, integer(period)), integer(0)), timer.origin)
        for timer, period in zip(timers, periods, strict=True)
        if timer.event is not None
    ]
    advance = (
        Assign(now, binary(now, Operator.ADD, integer(step)), origin),
        Send(topic_event(CLOCK_TOPIC), tuple(_clock_message(now, NANOSECONDS_PER_SECOND // unit, origin)), origin),
        *ticks,
    )
    idle = State(
        "idle",
        (Send(STEP, (), origin),),
        (),
        (
            Transition(
                STEP,
                binary(now, Operator.LESS, integer(end)),
                (Target("idle", 1.0, advance, origin),),
                origin,
            ),
            Transition(STEP, None, (Target(TIME_IS_OVER, 1.0, (), origin),), origin),
        ),
        origin,
    )
    timeout = State(TIME_IS_OVER, (), (), (), origin)
    data = Data("current_time", BASE_TYPES["int64"], integer(0), origin)
    return PlainAutomaton(CLOCK, Role.CLOCK, "idle", (data,), (idle, timeout), origin)


def _tick(event: ScxmlEvent, due: Expr, origin: Location) -> Statement:
    return If((Branch(due, (Send(event, (), origin),), origin),), (), origin)


def _clock_message(now: Expr, units_per_second: int, origin: Location) -> Iterable[Param]:
    seconds: Expr = now
    nanoseconds: Expr = integer(0)
    if units_per_second > 1:
        count = integer(units_per_second)
        floor = Member(NO_SPAN, name("Math"), "floor", NO_SPAN)
        seconds = Call(NO_SPAN, floor, (binary(now, Operator.DIVIDE, count),))
        rest = binary(now, Operator.REMAINDER, count)
        nanoseconds = binary(rest, Operator.MULTIPLY, integer(NANOSECONDS_PER_SECOND // units_per_second))
    yield Param(f"{FIELD_PREFIX}sec", seconds, origin)
    yield Param(f"{FIELD_PREFIX}nanosec", nanoseconds, origin)
