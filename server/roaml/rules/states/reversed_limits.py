# SPDX-License-Identifier: Apache-2.0
"""The rule `reversed-limits`, which reversed_limits.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.machine import Chart, Handler, State
from roaml.model.triggers import trigger
from roaml.model.values.analyse import ChartValues
from roaml.model.values.describe import described
from roaml.model.values.domain import ValueSet
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.ranges import Limit, limits_in


def check(context: MachineContext) -> Iterator[Finding]:
    """Report the two conditions with which a machine leaves a state and comes back, if a received field may satisfy
    both: the machine then changes its state with every message."""
    for chart in context.machine.charts if context.system is not None else ():
        values = context.values.charts.get(chart.scope)
        for begin, end in _pairs(context, chart) if values is not None else ():
            if values is not None and _overlap(values, begin, end):
                yield _finding(values, begin, end)


class _Tested(Limit, frozen=True):
    """A comparison that is the whole condition of a handler of a state."""

    state: State
    handler: Handler


def _pairs(context: MachineContext, chart: Chart) -> Iterator[tuple[_Tested, _Tested]]:
    """The only two comparisons of a field in a chart: one with which the machine leaves a state, and the opposite one,
    in a state that follows and from which it returns."""
    groups: dict[object, list[_Tested]] = {}
    for state in chart.states:
        for handler in state.handlers:
            if handler.effective and handler.trigger is ProtocolPart.MESSAGE and handler.cond is not None:
                for limit in limits_in(handler.cond.tree) if not handler.cond.broken else ():
                    if limit.place.startswith("_msg."):
                        tested = _Tested(limit.node, limit.place, limit.is_above, limit.tree, state, handler)
                        groups.setdefault((trigger(context.machine, handler), limit.place), []).append(tested)
    states = {state.id.value: state for state in chart.states if state.id is not None}
    for group in groups.values():
        if len(group) != 2 or group[0].is_above is group[1].is_above or group[0].state is group[1].state:
            continue
        if all(_leads(states, one.handler, other.state) for one, other in (group, group[::-1])):
            yield group[0], group[1]


def _leads(states: Mapping[str, State], handler: Handler, goal: State) -> bool:
    """Whether a machine may enter a state after a handler."""
    todo: list[str] = _targets([handler])
    seen: set[str] = set()
    while todo:
        name = todo.pop()
        if name in seen or name not in states:
            continue
        seen.add(name)
        if states[name] is goal:
            return True
        todo += _targets(states[name].handlers)
    return False


def _targets(handlers: Sequence[Handler]) -> list[str]:
    return [target.state.value for h in handlers for target in h.targets if target.state is not None]


def _overlap(values: ChartValues, first: _Tested, second: _Tested) -> bool:
    """Whether numbers are above the one limit and below the other: more than one, if both are integers."""
    above, below = (first, second) if first.is_above else (second, first)
    low, high = _number(values.at(above.tree)), _number(values.at(below.tree))
    if low is None or high is None:
        return False
    return high - low > (1 if isinstance(low, int) and isinstance(high, int) else 0)


def _number(known: ValueSet | None) -> int | float | None:
    value = known.value if known is not None else None
    return None if isinstance(value, str | bool) else value


def _finding(values: ChartValues, begin: _Tested, end: _Tested) -> Finding:
    above, below = (begin, end) if begin.is_above else (end, begin)
    low, high = (described(known) if (known := values.at(limit.tree)) else "" for limit in (above, below))
    message = (
        f"if `{end.place}` is above {low} and below {high}, the machine leaves this state with the next message and "
        "comes back with another one; exchange the limits, or the comparisons"
    )
    related = [Related(begin.node.span, "the opposite condition")]
    return RULE.at(end.node.span, message, related=related)


RULE = Rule(
    "reversed-limits",
    Severity.WARNING,
    "A machine changes its state and back for the same value.",
    machine=check,
    whole=True,
)
