# SPDX-License-Identifier: Apache-2.0
"""The rule `lost-messages`, which lost_messages.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.tree import Member, walk
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.machine import Chart, Handler, State
from roaml.model.syntax import Expression
from roaml.model.system import ChannelEndpoint
from roaml.model.timing import TimerRate, rates
from roaml.model.triggers import trigger
from roaml.model.value_types import find_handle
from roaml.model.values.domain import TRUE
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.interfaces import declared
from roaml.rules.support.timing import duration


def check(context: MachineContext) -> Iterator[Finding]:
    """Report topics whose messages arrive faster than the machine returns to a state that handles them."""
    if context.system is None or not context.automata:
        return
    timers = list(rates(context.system))
    own = {timer.name: timer for timer in timers if timer.path == context.source.path}
    arrival = {
        declaration.handle.value: _fastest(timers, channel.sources)
        for declaration, _, channel in declared(context, SymbolKind.SUBSCRIBER)
        if declaration.handle is not None
    }
    for chart in context.machine.charts:
        yield from _lost(context, chart, own, {name: sent for name, sent in arrival.items() if sent is not None})


def _fastest(timers: list[TimerRate], sources: Iterable[ChannelEndpoint]) -> TimerRate | None:
    """The timer with the highest rate that makes a machine publish to a topic at one tick after the other."""
    sending = []
    for endpoint in sources:
        sent = ProtocolEvent(ProtocolPart.MESSAGE, endpoint.use.handle)
        for chart in endpoint.automaton.outline.charts:
            causes = {tick.name for tick, second in chart.repeated_reactions if second == sent}
            sending += [t for t in timers if t.automaton is endpoint.automaton and t.name in causes]
    return max(sending, key=lambda timer: timer.hertz, default=None)


_TICK = ProtocolPart.TICK


def _lost(
    context: MachineContext, chart: Chart, own: dict[str, TimerRate], arrival: dict[str, TimerRate]
) -> Iterator[Finding]:
    states = {state.id.value: state for state in chart.states if state.id is not None}
    for state in chart.states:
        for handler in state.handlers:
            declaration = find_handle(context.machine, handler) if handler.trigger is ProtocolPart.MESSAGE else None
            sent = arrival.get(declaration.handle.value) if declaration and declaration.handle else None
            if sent is None or len(handler.targets) != 1 or handler.targets[0].state is None:
                continue
            if handler.cond is not None and not _may_hold_for_each(context, chart, handler.cond):
                continue
            after = states.get(handler.targets[0].state.value)
            wait = _wait(context, after, handler, own) if after is not None else None
            if after is not None and after.id is not None and wait is not None and sent.hertz > wait.hertz:
                sender = sent.automaton.name if sent.automaton is not None else ""
                message = (
                    f"`{sender}` sends such messages every {duration(sent.period.nanoseconds)}, but after one the "
                    f"machine waits in `{after.id.value}` for the timer `{wait.name}`, which ticks every "
                    f"{duration(wait.period.nanoseconds)}: the messages that arrive there are lost; handle them in "
                    f"`{after.id.value}`, or send fewer"
                )
                yield RULE.at(handler.element.name_span, message, related=[Related(after.id.span, "waits here")])


def _may_hold_for_each(context: MachineContext, chart: Chart, cond: Expression) -> bool:
    """Whether a condition may hold for one message after the other: not if it chooses between a few known messages,
    such as the colors of a light, which probably alternate."""
    values = context.values.charts.get(chart.scope)
    seen = values.at(cond.tree) if values is not None else None
    fields = (values.at(node) for node in walk(cond.tree) if isinstance(node, Member)) if values is not None else ()
    return seen == TRUE or not any(field is not None and field.only is not None for field in fields)


def _wait(context: MachineContext, state: State, handler: Handler, own: dict[str, TimerRate]) -> TimerRate | None:
    """The fastest timer that ends the wait in a state; `None` if something else may end it, or if the state handles the
    message."""
    handlers = [other for other in state.handlers if other.effective]
    topic = trigger(context.machine, handler)
    if any(trigger(context.machine, other) == topic or other.trigger is None for other in handlers):
        return None
    if not handlers or any(other.trigger is not _TICK for other in handlers):
        return None
    names = {d.handle.value for other in handlers if (d := find_handle(context.machine, other)) and d.handle}
    return max((own[name] for name in names if name in own), key=lambda timer: timer.hertz, default=None)


RULE = Rule(
    "lost-messages", Severity.WARNING, "Messages arrive faster than they are handled.", machine=check, whole=True
)
