# SPDX-License-Identifier: Apache-2.0
"""The rule `answer-needs-time`, which answer_needs_time.md describes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from roaml.diagnostics import Finding, Related, Severity, Symbol
from roaml.facts import Facts
from roaml.model.behavior.duties import distances, entering, unfinished
from roaml.model.behavior.explore import Behavior, BehaviorStep
from roaml.model.behavior.instants import EventDelay, Instants, is_readable
from roaml.model.behavior.phases import HALT, TICK, Duty, DutyKind, ProtocolEvent
from roaml.model.machine import Handler
from roaml.model.system import System, SystemAutomaton
from roaml.record import replace
from roaml.roles import ProtocolPart, SymbolKind
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.answers import behaviors, place, plugins
from roaml.rules.support.asynchronous import rewritten
from roaml.rules.support.event_names import channel_named, named


class DependsOnOrder(Facts, frozen=True):
    """The wait begins only if requests arrive in a certain order."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report ticks and halts that are not answered in the instant in which they arrive: the clock of the model cannot
    advance before the answer (docs/spec/semantics.md#time)."""
    system = context.system
    if system is None:
        return
    reported: set[tuple[Handler, Duty]] = set()
    for automaton in plugins(context):
        if not is_readable(system, automaton):
            continue
        instants = Instants(system, automaton)
        for behavior in behaviors(context):
            if behavior.chart is not context.machine.chart:
                continue
            for duty in (TICK, HALT):
                slow = unfinished(behavior, duty, instants.possible) - unfinished(behavior, duty)
                for step in entering(behavior, slow):
                    awaited = _awaited(behavior, step, slow, instants)
                    if awaited is None or not instants.possible(step):
                        continue
                    for handler in _beginning(behavior, step, duty):
                        if (handler, duty) not in reported:
                            reported.add((handler, duty))
                            yield _finding(context, system, handler, duty, instants.delay(awaited), automaton)


def _beginning(behavior: Behavior, step: BehaviorStep, duty: Duty) -> Iterable[Handler]:
    """The handlers in which the wait begins.

    This is the handler of `step`. If `step` receives the decision on a goal, whose handler has no content, these are
    the handlers that lead to `step` and in which the tick or halt arrives.
    """
    if step.event is None or step.event.part is not ProtocolPart.GOAL_RESPONSE:
        return (step.handler,)
    sources, waiting = {step.source}, [step.source]
    handlers: dict[Handler, None] = {}
    while waiting:
        here = waiting.pop()
        for candidate in behavior.steps:
            if candidate.target != here:
                continue
            if not behavior.configurations[candidate.source].owes(duty):
                handlers[candidate.handler] = None
            elif candidate.source not in sources:
                sources.add(candidate.source)
                waiting.append(candidate.source)
    return handlers


def _awaited(behavior: Behavior, first: BehaviorStep, slow: frozenset[int], instants: Instants) -> ProtocolEvent | None:
    """The first event that needs time to arrive on a path from the step `first` to the answer, or `None` if there is
    none."""
    outgoing, left = behavior.outgoing(), distances(behavior, slow)
    seen, waiting = {first.target}, [first.target]
    while waiting:
        here = waiting.pop(0)
        for step in outgoing[here]:
            if not instants.possible(step):
                nearer = left.get(step.target, len(left)) < left.get(step.source, len(left))
                if nearer and not step.ignored and step.event is not None and not instants.can_arrive(step.event):
                    return step.event
            elif step.target in slow and step.target not in seen:
                seen.add(step.target)
                waiting.append(step.target)
    return None


def _finding(
    context: MachineContext, system: System, handler: Handler, duty: Duty, delay: EventDelay, automaton: SystemAutomaton
) -> Finding:
    reason = "; ".join(_reasons(system, delay))
    what = "status of a tick" if duty is TICK else "confirmation of a halt"
    message = f"the {what} waits for {named(system, automaton, delay.event)}"
    message += f", which takes time: {reason}" if reason else ""
    advice = "return RUNNING here, and the status at a later tick" if duty is TICK else "confirm the halt here"
    if _not_taken(delay):
        advice = "handle the request in that state as well"
    message += f"; the clock stops when the next tick is due, so both may wait for ever; {advice}"
    fixes = rewritten(context, handler) if duty is TICK and not _not_taken(delay) else ()
    facts = DependsOnOrder() if _not_taken(delay) else None
    return RULE.at(place(handler), message, *fixes, related=_related(delay), facts=facts)


def unobserved(finding: Finding, runs: int) -> Finding:
    """The finding, if it depends on an order that does not occur in simulated runs.

    Args:
        runs: the number of runs.
    """
    message = f"{finding.message} (this occurs in none of {runs} simulated runs of this system)"
    return replace(finding, message=message, severity=Severity.INFORMATION)


def _not_taken(delay: EventDelay) -> bool:
    return delay.promise is not None and not delay.promise.taken


def _reasons(system: System, delay: EventDelay | None) -> Iterator[str]:
    """One phrase for each link of the chain of machines that wait for each other, except the last link: why the event
    of the link does not arrive before the event of the next link."""
    while delay is not None and delay.next is not None:
        then = delay.next
        timed = then.event.part is ProtocolPart.TICK
        cause = f"its timer `{then.event.name}` fires" if timed else named(system, then.automaton, then.event)
        only = f"only {'when' if timed else 'after'} {cause}"
        if delay.promise is not None and delay.server is not None:
            name, channel = delay.server.automaton.name, channel_named(system, delay.automaton, delay.event)
            doing, state = _DOING[delay.event.part], delay.promise.state
            if not delay.promise.taken:
                question = "request for" if delay.promise.duty.kind is DutyKind.REQUEST else "goal for"
                yield f"`{name}` does not handle the {question} {channel} in its state `{state}` before {cause}"
            else:
                yield f"`{name}` {doing} {channel} in its state `{state}` {only}"
        else:
            yield f"`{then.automaton.name}` sends it {only}"
        delay = then


_DOING = {
    ProtocolPart.RESPONSE: "answers",
    ProtocolPart.GOAL_RESPONSE: "decides on the goals of",
    ProtocolPart.RESULT: "sends the result of",
}


def _related(delay: EventDelay) -> Iterator[Related]:
    link: EventDelay | None = delay
    while link is not None:
        if link.promise is not None and link.server is not None:
            path, promise = link.server.automaton.path, link.promise
            yield Related(Symbol(path, SymbolKind.STATE, promise.state, promise.scope), "the machine waits here")
        elif link.next is None and link.event.part is ProtocolPart.TICK:
            yield Related(Symbol(link.automaton.path, SymbolKind.TIMER, link.event.name), "the timer")
        link = link.next


RULE = Rule(
    "answer-needs-time",
    Severity.WARNING,
    "A tick or halt ends only after time has passed, which can stop the clock for ever.",
    machine=check,
    whole=True,
    facts=DependsOnOrder,
)
