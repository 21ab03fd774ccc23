# SPDX-License-Identifier: Apache-2.0
"""The rule `trapping-state`, which trapping_state.md describes."""

from __future__ import annotations

from collections.abc import Iterator

from roaml.diagnostics import Finding, Related, Severity
from roaml.model.behavior.instants import can_arrive_again
from roaml.model.behavior.phases import ProtocolEvent
from roaml.model.machine import Chart, Handler, State
from roaml.model.triggers import Trigger, trigger
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, Rule
from roaml.rules.support.triggers import received_event
from roaml.rules.support.words import words_of

_IGNORED = (ProtocolPart.MESSAGE, ProtocolPart.EVENT)
"""What is discarded in a state without a handler. Other rules report requests, goals, ticks and halts."""

_ACTIVE = (*_IGNORED, ProtocolPart.TICK)
"""What a state handles that is not an intended end. An end may still answer requests."""


def check(context: MachineContext) -> Iterator[Finding]:
    """Report states that are never left, if events that other states handle continue to arrive there."""
    if not context.automata:
        return
    for number, chart in enumerate(context.machine.charts):
        reached = _reached(chart)
        for state in reached:
            if len(reached) > 1 and _is_trap(state):
                lost = next(_lost(context, number, state, reached), None)
                if lost is not None:
                    intended = _is_named(state, _ENDS) or _is_named(lost[0], _STARTS) or _waits_for(lost[0])
                    yield _finding(state, *lost, Severity.INFORMATION if intended else None)
                else:
                    yield from _idle(state)


def _idle(state: State) -> Iterator[Finding]:
    """Report a state that does nothing, although a condition of one of its handlers selects what it reacts to."""
    handlers = [handler for handler in state.handlers if handler.effective]
    selecting = [handler for handler in handlers if handler.cond is not None and handler.trigger in _IGNORED]
    has_effect = any(target.body for handler in handlers for target in handler.targets)
    if state.id is None or not selecting or has_effect or (state.exit and state.exit.statements):
        return
    target = selecting[0].targets[0].state
    if target is not None:
        message = (
            f"no transition leaves `{state.id.value}`, and its handlers contain nothing, so the condition of this one "
            "has no effect; change the target"
        )
        yield RULE.at(target.span, message)


_ENDS = frozenset(
    (
        *("aborted", "broken", "crashed", "dead", "done", "emergency", "empty", "end", "ended", "error", "failed"),
        *("failure", "fault", "finished", "halted", "lost", "off", "shutdown", "stopped", "terminated"),
        *("arrived", "completed", "delivered", "docked", "landed", "parked", "reached", "succeeded"),
    )
)
_STARTS = frozenset(["boot", "booting", "init", "initial", "initializing", "start", "starting", "startup", "unknown"])
"""Words in the names of states that are probably never left, or never entered again, intentionally."""


def _is_named(state: State, words: frozenset[str]) -> bool:
    return state.id is not None and not words.isdisjoint(words_of(state.id.value))


def _waits_for(state: State) -> bool:
    """Whether the name of a state says what it waits for, such as `waiting_for_map`: it is probably entered once. A
    machine that is only `waiting` does so again and again."""
    words = words_of(state.id.value) if state.id is not None else []
    return len(words) > 1 and words[0] in ("wait", "waiting")


def _finding(state: State, other: State, handler: Handler, severity: Severity | None) -> Finding:
    assert state.id is not None
    received = handler.handle or handler.event
    name = received.value if received is not None else ""
    message = (
        f"no transition leaves `{state.id.value}`, and `{name}`, which other states handle, still arrives; "
        "change a target, or handle it here"
    )
    targets = [target.state for own in state.handlers for target in own.targets if target.state is not None]
    span = targets[0].span if len(targets) == 1 else state.id.span
    place = f"`{other.id.value}` handles it here" if other.id is not None else "it is handled here"
    return RULE.at(span, message, related=[Related(handler.element.name_span, place)], severity=severity)


def _is_trap(state: State) -> bool:
    """Whether a state still handles messages, events or timers, and all of its handlers lead back to it."""
    handlers = [handler for handler in state.handlers if handler.effective]
    targets = [target.state.value if target.state else "" for handler in handlers for target in handler.targets]
    own = state.id.value if state.id is not None else None
    return any(handler.trigger in _ACTIVE for handler in handlers) and all(target == own for target in targets)


def _lost(context: MachineContext, number: int, state: State, reached: list[State]) -> Iterator[tuple[State, Handler]]:
    """The handlers in other states for events that have no handler in `state` and may arrive again and again."""
    handled = {trigger(context.machine, handler) for handler in state.handlers}
    seen: set[Trigger] = set()
    for other in reached:
        for handler in other.handlers:
            key = trigger(context.machine, handler)
            if handler.trigger not in _IGNORED or key is None or key in handled or key in seen:
                continue
            seen.add(key)
            event = received_event(context.machine, handler)
            if event is not None and any(_repeats(context, number, event, i) for i in range(len(context.automata))):
                yield other, handler


def _repeats(context: MachineContext, number: int, event: ProtocolEvent, automaton: int) -> bool:
    assert context.system is not None
    return can_arrive_again(context.system, context.automata[automaton], number, event, frozenset())


def _reached(chart: Chart) -> list[State]:
    """The states that can be entered, in the order of the machine."""
    states = {state.id.value: state for state in chart.states if state.id is not None}
    todo = [chart.initial.value] if chart.initial is not None else []
    reached: set[str] = set()
    while todo:
        name = todo.pop()
        if name in states and name not in reached:
            reached.add(name)
            todo += [t.state.value for h in states[name].handlers if h.effective for t in h.targets if t.state]
    return [state for name, state in states.items() if name in reached]


RULE = Rule(
    "trapping-state",
    Severity.WARNING,
    "A state is never left, although events that other states handle still arrive.",
    machine=check,
    whole=True,
)
