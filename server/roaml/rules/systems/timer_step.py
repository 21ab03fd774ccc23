# SPDX-License-Identifier: Apache-2.0
"""The rule `timer-step`, which timer_step.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from roaml.diagnostics import Finding, Related, Severity
from roaml.durations import NANOSECONDS
from roaml.expr.infer import constant_fraction
from roaml.expr.operators import Operator, OperatorKind
from roaml.expr.tree import Binary, Expr, walk
from roaml.expr.tree import Name as NameExpr
from roaml.model.machine import Assign, Chart, statements
from roaml.model.syntax import Expression, Name, PortRead
from roaml.model.timing import period
from roaml.model.values.evaluate import place_of
from roaml.model.waits import fixed_variables, scaled, tick_counts
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.timing import duration, timers
from roaml.rules.support.words import words_of
from roaml.text import Span

_UNITS = {
    **dict.fromkeys(("ns", "nanosec", "nanoseconds"), 1),
    **dict.fromkeys(("us", "microseconds"), NANOSECONDS["us"]),
    **dict.fromkeys(("ms", "millis", "milliseconds"), NANOSECONDS["ms"]),
    **dict.fromkeys(("s", "sec", "secs", "seconds"), NANOSECONDS["s"]),
}
"""The last word in the name of a variable -> the time that it counts, in ns."""

_SETTINGS = frozenset(("backoff", "delay", "duration", "interval", "limit", "max", "min", "period", "timeout"))
_OTHER = frozenset(
    (
        *("cm", "deg", "km", "m", "mm", "per", "rad", "rate", "speed", "velocity"),  # of speeds, such as `mm_s`
        *("scaled", "sim", "simulated", "virtual"),
    )
)
"""Words in the names of variables that do not count the time of a timer, although they end in a unit of time."""


def _unit(words: Sequence[str]) -> int | None:
    """The unit of the time, in ns, that a variable with these words in its name contains."""
    return _UNITS.get(words[-1]) if words and _OTHER.isdisjoint(words) else None


def check(context: MachineContext) -> Iterator[Finding]:
    if not context.automata:
        return
    rates = {d.handle.value: (rate, hertz) for d, rate, hertz in timers(context) if d.handle is not None}
    for chart in context.machine.charts if rates else ():
        fixed = fixed_variables(chart)
        steps: dict[str, list[_Step]] = {}
        for name, statement, amount in _steps(chart, fixed):
            place = place_of(statement.location.tree) if statement.location is not None else None
            words = words_of(place) if place is not None else []
            unit = _unit(words) if _SETTINGS.isdisjoint(words) else None
            if name in rates and place is not None and unit is not None and isinstance(statement.value, Expression):
                if _is_at_some_ticks(context, chart, name, statement, place):
                    continue
                steps.setdefault(name, []).append(_Step(place, statement.value.span, amount * unit))
        for name, of_timer in steps.items():
            yield from _findings(name, *rates[name], of_timer)
        yield from _ticks(context, chart, rates)


class _Step(NamedTuple):
    """A variable that a timer advances by a time in ns."""

    place: str
    span: Span
    time: Fraction


def _findings(name: str, rate: Name, hertz: Fraction, steps: Sequence[_Step]) -> Iterator[Finding]:
    ns = period(hertz).nanoseconds
    wrong = [step for step in steps if abs(step.time - ns) * 100 > ns]  # 333 ms at 3 Hz is rounded
    if len(wrong) > 1 and len(wrong) == len(steps) and len({step.time for step in wrong}) == 1:
        message = (
            f"the period of this timer is {duration(ns)}, but the variables that count its time advance by "
            f"{duration(wrong[0].time)} at each tick; change the rate or the steps"
        )
        yield RULE.at(rate.span, message, related=[Related(step.span, f"advances `{step.place}`") for step in wrong])
        return
    for step in wrong:
        message = (
            f"`{step.place}` advances by {duration(step.time)} at each tick of `{name}`, whose period is "
            f"{duration(ns)}; change the step or the rate"
        )
        yield RULE.at(step.span, message, related=[Related(rate.span, "the rate in Hz")])


def _ticks(context: MachineContext, chart: Chart, rates: Mapping[str, tuple[Name, Fraction]]) -> Iterator[Finding]:
    """Report numbers of ticks that are compared with a time, such as `n * 0.1 >= wait_s`, if they are multiplied by
    another time than the period."""
    counts = tick_counts(chart)
    expressions = (v.value for v in context.typed.values if v.place.chart is chart) if counts else ()
    for node in (n for value in expressions if isinstance(value, Expression) for n in walk(value.tree)):
        if not isinstance(node, Binary) or node.operator.kind is not OperatorKind.ORDER:
            continue
        for side, limit in ((node.left, node.right), (node.right, node.left)):
            (counter, factor), (time, other) = scaled(side), scaled(limit)
            unit, count = _unit(words_of(time)), counts.get(counter)
            if count is None or unit is None or count.timer not in rates or _unit(words_of(counter)) is not None:
                continue
            rate, hertz = rates[count.timer]
            ns, counted = period(hertz).nanoseconds, factor * count.step * unit / other
            if abs(counted - ns) * 100 > ns:
                message = (
                    f"`{counter}` counts ticks of `{count.timer}`, whose period is {duration(ns)}, but each of them is "
                    f"compared with `{time}` as {duration(counted)}; change the factor or the rate"
                )
                yield RULE.at(side.span, message, related=[Related(rate.span, "the rate in Hz")])


def _steps(chart: Chart, fixed: Mapping[str, PortRead | Fraction]) -> Iterator[tuple[str, Assign, Fraction]]:
    """The assignments in the handlers of timers that add a positive constant to a variable, each with the name of the
    timer and the constant."""
    for handler in (handler for state in chart.states for handler in state.handlers):
        if handler.trigger is ProtocolPart.TICK and handler.handle is not None:
            for statement in (s for target in handler.targets for s in statements(target.body)):
                if isinstance(statement, Assign) and isinstance(statement.value, Expression) and statement.location:
                    step = _step(statement.value.tree, place_of(statement.location.tree), fixed)
                    if step is not None and step > 0:
                        yield handler.handle.value, statement, step


def _is_at_some_ticks(context: MachineContext, chart: Chart, timer: str, statement: Assign, place: str) -> bool:
    """Whether an assignment is executed only at some ticks of a timer: in a handler or branch whose condition reads
    another variable that ticks of this timer assign, such as their number."""
    counted = {
        name
        for state in chart.states
        for handler in state.handlers
        if handler.trigger is ProtocolPart.TICK and handler.handle is not None and handler.handle.value == timer
        for target in handler.targets
        for s in statements(target.body)
        if isinstance(s, Assign) and s.location is not None and (name := place_of(s.location.tree)) is not None
    } - {place}
    own = next((v.place for v in context.typed.values if v.value is statement.value), None)
    if own is None:
        return False
    conditions = [condition for condition, _ in own.branch_conditions or ()]
    conditions += [own.handler.cond] if own.handler is not None and own.handler.cond is not None else []
    return any(place_of(node) in counted for condition in conditions for node in walk(condition.tree))


def _step(tree: Expr, place: str | None, fixed: Mapping[str, PortRead | Fraction]) -> Fraction | None:
    """The constant that `tree` adds to the value of `place`."""
    if not isinstance(tree, Binary) or tree.operator is not Operator.ADD or place is None:
        return None
    for variable, amount in ((tree.left, tree.right), (tree.right, tree.left)):
        if place_of(variable) == place:
            known = fixed.get(amount.name) if isinstance(amount, NameExpr) else constant_fraction(amount)
            return known if isinstance(known, Fraction) else None
    return None


RULE = Rule(
    "timer-step",
    Severity.WARNING,
    "A counter of time advances by another time than the period of its timer.",
    machine=check,
    whole=True,
)
