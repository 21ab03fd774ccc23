# SPDX-License-Identifier: Apache-2.0
"""The rule `time-stops`, which time_stops.md describes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from roaml.diagnostics import Finding, Related, Severity
from roaml.expr.tree import Expr
from roaml.model.behavior.exchanges import Reaction, endless_exchange
from roaml.model.behavior.explore import EVENT_VARIABLES, explore
from roaml.model.behavior.instants import is_readable
from roaml.model.behavior.knowledge import variables_in
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.machine import Assign, Chart, Handler, RosSend, Send, State, Statement, statements
from roaml.model.system import System, SystemAutomaton
from roaml.model.value_types import find_handle
from roaml.model.values.domain import TRUE
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import place
from roaml.rules.support.event_names import named

_FOR_EVER = "no time passes any more with the reaction time `instant`"


def check(context: MachineContext) -> Iterator[Finding]:
    system = context.system
    if system is None:
        return
    reaction_time = system.parameters.reaction_time
    if not system.has_timer or reaction_time is None or not reaction_time.is_instant:
        for chart in context.machine.charts:
            yield from _stuck(context, chart)
        return
    for chart in context.machine.charts:
        yield from _eventless(context, chart)
    yield from _exchanges(context, system)


# ------------------------------------------------------- transitions without event


def _eventless(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """Report the transitions without event after which only such transitions follow, and those that repeat
    themselves."""
    states = {state.id.value: state for state in chart.states if state.id}
    endless = _endless(context, chart, states)
    following = {name: _following(name, states, endless) for name in endless}
    reported: set[str] = set()
    for name, state in states.items():
        cycle = (
            [other for other in endless if other in following[name] and name in following[other]]
            if name in endless
            else []
        )
        if cycle and reported.isdisjoint(cycle):
            reported.update(cycle)
            taken = next(h for h in state.handlers if _is_eventless(h) and _is_always_taken(context, chart, h))
            where = f"state `{name}`" if len(cycle) == 1 else "states " + ", ".join(f"`{other}`" for other in cycle)
            message = (
                f"the machine never waits in the {where}: a transition without event is always possible, so {_FOR_EVER}"
            )
            yield RULE.at(taken.element.name_span, f"{message}; {_ADVICE}")
        repeated = None if name in endless else _repeated(state)
        if repeated is not None and repeated.cond is not None:
            message = (
                "this transition changes nothing that its condition reads, so it is repeated for ever once the "
                f"condition is true, and {_FOR_EVER}"
            )
            yield RULE.at(repeated.cond.span, f"{message}; {_ADVICE}")


def _stuck(context: MachineContext, chart: Chart) -> Iterator[Finding]:
    """Report the first transitions that repeat themselves in states without other handlers, which are wrong with each
    reaction time. Conditions with another mistake are not judged."""
    mistaken = {value.value.span for value in context.typed.values if value.problems}
    for state in chart.states:
        repeated = _repeated(state) if all(_is_eventless(handler) for handler in state.handlers) else None
        if repeated is None or repeated is not state.handlers[0] or repeated.cond is None:
            continue
        if repeated.cond.span not in mistaken:
            message = (
                "this transition changes nothing that its condition reads, so it is repeated for ever once the "
                "condition is true, and the state is never left; let it lead to another state, or change the condition"
            )
            yield RULE.at(repeated.cond.span, message)


_ADVICE = "let the transition wait for an event or a timer, or lead to a state that does"


def _is_eventless(handler: Handler) -> bool:
    return handler.effective and handler.trigger is None and handler.event is None and handler.handle is None


def _is_always_taken(context: MachineContext, chart: Chart, handler: Handler) -> bool:
    if handler.cond is None:
        return True
    values = context.values.charts.get(chart.scope)
    results = None if values is None else values.conditions.get(handler.cond.span)
    return results is not None and results.alone == TRUE


def _endless(context: MachineContext, chart: Chart, states: Mapping[str, State]) -> Collection[str]:
    """The largest set of states in which an eventless transition is always possible and leads to a state of the set;
    in the order of the document."""
    endless = list(states)
    changed = True
    while changed:
        remaining = [name for name in endless if _stays(context, chart, states[name], endless)]
        changed = len(remaining) < len(endless)
        endless = remaining
    return endless


def _stays(context: MachineContext, chart: Chart, state: State, endless: Collection[str]) -> bool:
    """Whether a transition without event is always taken in a state, and each that may be taken leads to a state of
    `endless`."""
    for handler in state.handlers:
        if _is_eventless(handler):
            if not all(target.state is not None and target.state.value in endless for target in handler.targets):
                return False
            if _is_always_taken(context, chart, handler):
                return True
    return False


def _following(first: str, states: Mapping[str, State], endless: Collection[str]) -> set[str]:
    """The states of `endless` that the machine may enter after the state `first`, without an event."""
    following: set[str] = set()
    waiting = [first]
    while waiting:
        handlers = [handler for handler in states[waiting.pop()].handlers if _is_eventless(handler)]
        targets = {t.state.value for handler in handlers for t in handler.targets if t.state} & set(endless)
        waiting += targets - following
        following |= targets
    return following


def _repeated(state: State) -> Handler | None:
    """The first transition without event of a state that leads to the state itself and changes no variable of its
    condition or of those before it; `None` if there is none."""
    conditions: list[Expr] = []
    for handler in state.handlers:
        if not _is_eventless(handler):
            continue
        if handler.cond is None or handler.cond.broken:
            return None
        conditions.append(handler.cond.tree)
        if state.id is None or any(t.state is None or t.state.value != state.id.value for t in handler.targets):
            continue
        around = [body.statements for body in (state.entry, state.exit) if body is not None]
        executed = [s for body in (*around, *(t.body for t in handler.targets)) for s in statements(body)]
        changed = variables_in(s.location.tree for s in executed if isinstance(s, Assign) and s.location is not None)
        read = variables_in(conditions)
        if not read & (changed | EVENT_VARIABLES):
            return handler
    return None


# ------------------------------------------------------- events that follow each other


def _exchanges(context: MachineContext, system: System) -> Iterator[Finding]:
    """Report the reaction that keeps an exchange of events alive, in one of its machines: a client, if there is one,
    otherwise the first machine of the system."""
    reported: set[Handler] = set()
    for automaton in context.automata:
        if not is_readable(system, automaton):
            continue
        received = {event for chart in automaton.outline.charts for event, _ in chart.certain_reactions}
        for event in sorted(received):
            links = endless_exchange(system, automaton, event)
            if not links or _reporting(system, links) != (id(automaton), event):
                continue
            found = _reaction(context, links[0])
            if found is not None and found[0] not in reported:
                reported.add(found[0])
                yield _finding(system, links, *found)


def _reporting(system: System, links: tuple[Reaction, ...]) -> tuple[int, ProtocolEvent]:
    """The automaton that is responsible for an exchange, and the event to which it reacts."""
    order = {id(automaton): number for number, automaton in enumerate(system.automata)}
    asking = [link for link in links if link.sent.part in (ProtocolPart.REQUEST, ProtocolPart.GOAL)]
    link = min(asking or links, key=lambda link: (order[id(link.automaton)], link.received))
    return id(link.automaton), link.received


def _reaction(context: MachineContext, link: Reaction) -> tuple[Handler, Statement | None] | None:
    """The first handler that reacts to the received event of a link, with the statement that sends the other one."""
    for chart in context.machine.charts:
        behavior = explore(context.machine, chart)
        for step in behavior.steps if behavior is not None else ():
            if step.event == link.received and not step.ignored:
                body = step.handler.targets[step.choice].body
                return step.handler, next((s for s in statements(body) if _sends(context, s, link.sent)), None)
    return None


def _sends(context: MachineContext, statement: Statement, event: ProtocolEvent) -> bool:
    match statement:
        case Send(event=name):
            return event.part is ProtocolPart.EVENT and name is not None and name.value == event.name
        case RosSend():
            declaration = find_handle(context.machine, statement)
            handle = declaration.handle if declaration is not None else statement.handle
            return statement.part is event.part and handle is not None and handle.value == event.name
        case _:
            return False


def _finding(system: System, links: tuple[Reaction, ...], handler: Handler, statement: Statement | None) -> Finding:
    rounds = ", ".join(_described(system, link) for link in links)
    message = (
        f"an exchange of events never ends: {rounds}; {_FOR_EVER}; wait for a timer before the event is sent again"
    )
    span = place(handler) if statement is None else statement.element.name_span
    related = [
        Related(automaton.symbol(use), f"`{automaton.name}` reacts with another event")
        for automaton in dict.fromkeys(_others(links))
        for use in automaton.outline.interfaces[:1]
    ]
    return RULE.at(span, message, related=related)


def _others(links: tuple[Reaction, ...]) -> Iterator[SystemAutomaton]:
    yield from (link.automaton for link in links if link.automaton is not links[0].automaton)


def _described(system: System, link: Reaction) -> str:
    received, sent = named(system, link.automaton, link.received), named(system, link.automaton, link.sent)
    return f"`{link.automaton.name}` sends {sent} whenever it has received {received}"


RULE = Rule(
    "time-stops", Severity.WARNING, "Machines take steps for ever without time passing.", machine=check, whole=True
)
