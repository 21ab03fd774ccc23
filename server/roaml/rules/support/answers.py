# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about answers to ticks, halts, requests and goals.

They provide the graphs of a machine and the position of a plugin in the tree. A finding about a step is reported at the
handler that takes the step, or at a statement in `<onentry>` or `<onexit>` that the step executes (`place`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from roaml.diagnostics import Related
from roaml.language import HL_SCXML
from roaml.model.behavior.duties import Possible, always, dead_ends, is_suspicious, untaken, waiting_behind
from roaml.model.behavior.explore import Behavior, BehaviorStep, FaultKind, explore
from roaml.model.behavior.instants import Instants, is_readable
from roaml.model.behavior.phases import Duty, DutyKind, Phase
from roaml.model.machine import Handler, Machine, RosSend, State, Statement
from roaml.model.system import System, SystemAutomaton
from roaml.model.value_types import find_handle
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext
from roaml.rules.support import misspelled
from roaml.rules.support.removed_events import uses_removed_events
from roaml.rules.support.triggers import has_shadowed
from roaml.text import Span
from roaml.xml_syntax import Element

SENT = {
    DutyKind.TICK: ProtocolPart.BT_STATUS,
    DutyKind.HALT: ProtocolPart.BT_HALTED,
    DutyKind.REQUEST: ProtocolPart.RESPONSE,
    DutyKind.RESULT: ProtocolPart.RESULT,
}
"""The kind of duty -> the event that answers it. The decision on a goal is not included, because two events can answer
it."""
_HANDLED_BY = {DutyKind.TICK: (ProtocolPart.BT_TICK, "bt_tick"), DutyKind.HALT: (ProtocolPart.BT_HALT, "bt_halt")}
ELEMENTS = {
    ProtocolPart.BT_STATUS: ("bt_return_status",),
    ProtocolPart.BT_HALTED: ("bt_return_halted",),
    ProtocolPart.RESPONSE: ("ros_service_send_response",),
    ProtocolPart.GOAL: ("ros_action_accept_goal", "ros_action_reject_goal"),
    ProtocolPart.RESULT: ("ros_action_succeed", "ros_action_aborted", "ros_action_canceled"),
}


def behaviors(context: MachineContext) -> Iterator[Behavior]:
    """The graphs of the machine and its threads, without those that are too large or have no initial state.

    A graph distinguishes the values of variables only if a fault is likely, because that makes it larger.
    """
    for chart in context.machine.charts:
        behavior = explore(context.machine, chart)
        if behavior is not None and is_suspicious(behavior):
            behavior = explore(context.machine, chart, fine=True)
        if behavior is not None:
            yield behavior


def plugins(context: MachineContext) -> list[SystemAutomaton]:
    """The automata of the machine in the tree; none if the machine still uses the events that were removed from the
    language."""
    if uses_removed_events(context.machine):
        return []
    return [automaton for automaton in context.automata if automaton.instance is not None]


def is_spelled(context: MachineContext, duty: Duty) -> bool:
    """Whether the answers to a duty are probably spelled correctly: no unknown element of the machine resembles one."""
    names = ELEMENTS[SENT.get(duty.kind, ProtocolPart.GOAL)]
    elements = list(context.machine.element.walk())
    return not any(misspelled.among(elements, name, HL_SCXML) for name in names)


def answered_in(machine: Machine, duty: Duty) -> set[str]:
    """The scopes of those charts of a machine (its own chart and its threads) that send answers to a duty."""
    names = ELEMENTS[SENT.get(duty.kind, ProtocolPart.GOAL)]
    scopes = set()
    for chart in machine.charts:
        for statement in chart.executed:
            if statement.element.name in names:
                declaration = find_handle(machine, statement) if isinstance(statement, RosSend) else None
                if not duty.handle or (declaration and declaration.handle and declaration.handle.value == duty.handle):
                    scopes.add(chart.scope)
    return scopes


def missed(context: MachineContext, behavior: Behavior, duty: Duty) -> Iterator[tuple[BehaviorStep, bool]]:
    """The steps after which the answer to a duty is missing, at most one for each handler. The flag of a step states
    whether the answer is missing on all paths.

    Steps are left out if the graph is approximate and the step uncertain, or if another finding explains them: an
    answer of the wrong kind is reported by repeated-answer, an element that cannot be read may be the answer, and a
    condition that has no effect because of earlier conditions (shadowed-transition) is probably wrong.
    """
    steps: dict[Handler, list[BehaviorStep]] = {}
    for step in dead_ends(behavior, duty):
        wrong = any(fault.kind is FaultKind.WRONG_KIND and fault.duty == duty for fault in step.faults)
        if not wrong and (step.certain or not behavior.approximate):
            steps.setdefault(step.handler, []).append(step)
    for handler, handler_steps in steps.items():
        if all(step.ignored for step in handler_steps) and has_shadowed(context.machine, behavior.chart, handler):
            continue
        unexplained = [step for step in handler_steps if not _may_be_unread(context.machine, behavior, duty, step)]
        if unexplained:
            certain = [step for step in unexplained if step.certain and not step.ignored]
            yield (certain or unexplained)[0], bool(certain)


def place(handler: Handler, statement: Statement | None = None) -> Span:
    """The place where a fault in a step is reported: the name of `handler`, which takes the step, or the name of
    `statement` if it is not inside the handler but in an `<onentry>` or `<onexit>` that the step executes."""
    if statement is not None and not _within(statement.element.span, handler.element.span):
        return statement.element.name_span
    return handler.element.name_span


def _within(inner: Span, outer: Span) -> bool:
    return outer.start <= inner.start and inner.end <= outer.end


def target_of(step: BehaviorStep) -> Iterator[Related]:
    """The target that a step leads to, if its handler chooses one of several targets; nothing for other steps, and if
    the step ignores the event."""
    if step.handler.is_probabilistic and not step.ignored:
        element = step.handler.targets[step.choice].element
        if element is not None:
            yield Related(element.name_span, "on this path")


def _may_be_unread(machine: Machine, behavior: Behavior, duty: Duty, step: BehaviorStep) -> bool:
    """Whether an element that cannot be read might be the missing answer after a step, or handle an event that leads to
    it. Only elements in the handler, in a state that waits for the answer, or in a state that ignores an event are
    considered."""
    states = {state.id.value: state.element for state in behavior.chart.states if state.id}
    source = behavior.configurations[step.source]
    names = {behavior.configurations[number].state for number in waiting_behind(behavior, duty, step)}
    if step.ignored or source.owes(duty):
        names.add(source.state)
    elements = [step.handler.element, *(states[name] for name in names if name in states)]
    unresolved = {
        user.element
        for chart in machine.charts
        for user in (*chart.executed, *(handler for state in chart.states for handler in state.handlers))
        if isinstance(user, RosSend | Handler) and "name" in user.type.attributes
        if find_handle(machine, user) is None
    }
    return any(e in unresolved or _is_misspelled(e) for element in elements for e in element.walk())


def _is_misspelled(element: Element) -> bool:
    """Whether an element is unknown, or one of its attributes is probably a misspelled known one."""
    if element.prefix:
        return False
    type_ = HL_SCXML.find(element.name)
    if type_ is None:
        return True
    missing = [name for name in type_.attributes if element.get(name) is None]
    return any(misspelled.attribute(element, name, type_.attributes) for name in missing)


# ------------------------------------------------------------ place in the tree

_SWITCHES = frozenset(f"Switch{cases}" for cases in range(2, 7))
_ASKS_ONCE = _SWITCHES | {
    *("Sequence", "Fallback", "SequenceWithMemory", "SequenceStar", "IfThenElse", "Parallel", "ParallelAll"),
    *("Inverter", "ForceSuccess", "ForceFailure", "RunOnce", "Delay", "Timeout", "BlackboardCheckInt"),
}
"""Nodes that do not tick an ended child again until they have ended themselves (docs/spec/nodes.md)."""
_PASSES_HALTS = frozenset(("Inverter", "RetryUntilSuccessful", "ForceSuccess", "ForceFailure", "Delay", "RunOnce"))
"""Nodes that halt their child only when they are halted."""
_INTERRUPTS = _SWITCHES | {"Parallel", "Timeout", "BlackboardCheckInt"}
"""Nodes that halt running children without being halted."""
_INTERRUPTS_LATER = frozenset(("ReactiveSequence", "ReactiveFallback", "WhileDoElse"))
"""Nodes that tick their first child at every tick, and halt running later children depending on its status."""


def is_ticked_again(system: System, automaton: SystemAutomaton) -> bool:
    """Whether a node may be ticked again after it has ended."""
    if system.parameters.tick_if_not_running:
        return True
    return any(above.path or above.outline.name not in _ASKS_ONCE for above in ancestors(system, automaton))


def is_halted(system: System, automaton: SystemAutomaton, *, running: bool) -> bool:
    """Whether a node may be halted while it is running (if `running`) or while it is not running."""
    child = automaton
    for parent in ancestors(system, automaton):
        if parent.path:  # the parent is a plugin of the user
            return parent.outline.plugin.halts_children
        name = parent.outline.name
        if name in _INTERRUPTS or (not running and name not in _PASSES_HALTS):
            return True
        if name in _INTERRUPTS_LATER and not _is_first(parent, child):
            return True
        child = parent
    return False


def _is_first(parent: SystemAutomaton, child: SystemAutomaton) -> bool:
    assert parent.instance is not None
    assert child.instance is not None
    return parent.instance.children[0] == child.instance.number


def ancestors(system: System, automaton: SystemAutomaton) -> Iterator[SystemAutomaton]:
    """The nodes above a node, the nearest first."""
    number = automaton.instance.parent if automaton.instance else None
    while number is not None and (above := system.by_instance.get(number)) is not None:
        yield above
        number = above.instance.parent if above.instance else None


class UnhandledState(NamedTuple):
    """A state in which a tick or halt may arrive and is not handled.

    Attributes:
        name, span: the identifier of the state, and its place.
        tree_status: the status of the node: `RUNNING`, `ENDED`, or `None` if it has not been ticked yet.
        needs_time: whether the machine leaves the state, but only after time has passed.
    """

    state: State
    name: str
    span: Span
    tree_status: Phase | None
    needs_time: bool


def unhandled_states(
    context: MachineContext, behavior: Behavior, automata: Iterable[SystemAutomaton], duty: Duty
) -> Iterator[UnhandledState]:
    """The states in which at least one node of the plugin does not handle a tick or halt, without duplicates."""
    seen: set[State] = set()
    for automaton in automata:
        ways: list[tuple[Possible, bool]] = [(always, False)]
        if context.system is not None and is_readable(context.system, automaton):
            ways.append((Instants(context.system, automaton).possible, True))
        for possible, needs_time in ways:
            for state, tree_status in _unhandled_by(context, behavior, automaton, duty, possible):
                if state not in seen and state.id is not None:
                    seen.add(state)
                    yield UnhandledState(state, state.id.value, state.id.span, tree_status, needs_time)


def _unhandled_by(
    context: MachineContext, behavior: Behavior, automaton: SystemAutomaton, duty: Duty, possible: Possible = always
) -> Iterator[tuple[State, Phase | None]]:
    """The states in which a tick or halt may arrive at `automaton` and is not handled, with the status of the node
    there: `RUNNING`, `ENDED`, or `None` if it has not been ticked yet."""
    assert context.system is not None
    takes, tag = _HANDLED_BY[duty.kind]
    if all(any(handler.trigger is takes for handler in state.handlers) for state in behavior.chart.states):
        return
    may_come = _coming(context.system, automaton, duty)
    tree_status: dict[str, Phase | None] = {}
    for number in untaken(behavior, duty, possible):
        configuration = behavior.configurations[number]
        if configuration.tree in may_come:
            tree_status.setdefault(configuration.state, configuration.tree)
    for state in behavior.chart.states:
        if state.id is None or state.id.value not in tree_status or _is_for_errors(behavior, state):
            continue
        if not misspelled.among(state.element.walk(), tag, HL_SCXML):
            yield state, tree_status.pop(state.id.value)


def _is_for_errors(behavior: Behavior, state: State) -> bool:
    """Whether a state has no transitions and is entered only if a condition holds. A plugin that checks its ports
    enters this kind of state intentionally."""
    if any(handler.effective for handler in state.handlers):
        return False
    entering = [
        step
        for step in behavior.steps
        if state.id is not None and behavior.configurations[step.target].state == state.id.value
    ]
    return bool(entering) and all(step.handler.cond is not None or not step.certain for step in entering)


def _coming(system: System, automaton: SystemAutomaton, duty: Duty) -> frozenset[Phase | None]:
    """The statuses that a node may have when a tick or halt arrives."""
    if duty.kind is DutyKind.TICK:
        again = is_ticked_again(system, automaton)
        return frozenset((None, Phase.RUNNING, Phase.ENDED) if again else (None, Phase.RUNNING))
    at_rest = (None, Phase.ENDED) if is_halted(system, automaton, running=False) else ()
    return frozenset((*at_rest, *((Phase.RUNNING,) if is_halted(system, automaton, running=True) else ())))
