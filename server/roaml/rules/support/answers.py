# SPDX-License-Identifier: Apache-2.0
"""Helpers of the rules about answers to ticks, halts, requests and goals.

They provide the graphs of a machine and the position of a plugin in the tree. A finding about a step is reported at the
handler that takes the step, or at a statement in `<onentry>` or `<onexit>` that the step executes (`place`).
"""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Iterator

from roaml.diagnostics import Fix, Related, Severity
from roaml.edit.elements import after, first_in, last_in, without_tags
from roaml.language import HL_SCXML
from roaml.language.validate import misspelled_attribute
from roaml.model.behavior.duties import Possible, always, is_suspicious, untaken
from roaml.model.behavior.explore import Behavior, BehaviorStep, Fault, FaultKind, explore
from roaml.model.behavior.instants import Instants, is_readable, promises, server_of
from roaml.model.behavior.phases import HALT, Duty, DutyKind, Phase, ProtocolEvent
from roaml.model.machine import Handler, If, Machine, RosSend, State, Statement, statements
from roaml.model.obligations.losses import Loss, losses, waiting_behind
from roaml.model.obligations.protocols import ClientProtocols
from roaml.model.system import SystemAutomaton
from roaml.model.value_types import find_handle
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext
from roaml.rules.support import misspelled
from roaml.rules.support.node_calls import statuses_at_halt, statuses_at_tick
from roaml.rules.support.removed_events import uses_removed_events
from roaml.rules.support.triggers import has_shadowed
from roaml.text import Span, TextEdit
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


def answers_at_once(context: MachineContext, response: ProtocolEvent) -> bool:
    """Whether no server that sends a response to the machine may send it later than at once."""
    servers = [server_of(context.system, a, response) for a in context.automata] if context.system is not None else []
    return not any(server is not None and any(promises(server, response)) for server in servers)


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


def misdirected(behavior: Behavior, duty: Duty) -> RosSend | None:
    """The first answer to another service, whose request never waits there, that is sent while `duty` is owed: it
    probably names the wrong service."""
    received = {s.event.name for s in behavior.steps if s.event and s.event.part is ProtocolPart.REQUEST} - {
        duty.handle
    }
    for step in behavior.steps:
        for fault in step.faults:
            is_other = fault.duty.kind is duty.kind and fault.duty.handle in received
            if fault.kind is not FaultKind.UNASKED or not is_other or not isinstance(fault.statement, RosSend):
                continue
            owed = behavior.configurations[step.target].owes(duty)
            if owed and fault.statement.handle and not _is_right_elsewhere(behavior, step, fault):
                return fault.statement
    return None


def _is_right_elsewhere(behavior: Behavior, step: BehaviorStep, fault: Fault) -> bool:
    """Whether the state that a step enters also sends the answer of a fault on a path on which it is requested. What a
    handler of requests sends itself is sent on no other path."""
    is_asked = step.event is not None and step.event.part is ProtocolPart.REQUEST
    if is_asked and any(s is fault.statement for target in step.handler.targets for s in statements(target.body)):
        return False
    answer = ProtocolEvent(SENT[fault.duty.kind], fault.duty.handle)
    state = behavior.configurations[step.target].state
    return any(
        answer in other.sent and behavior.configurations[other.target].state == state
        for other in behavior.steps
        if not any(known.statement is fault.statement for known in other.faults)
    )


def named_right(statement: RosSend, duty: Duty) -> tuple[Span, str, Fix]:
    """The place of the name in an answer to the wrong service, a message, and a fix that changes the name."""
    assert statement.handle is not None
    wrong, span = statement.handle.value, statement.handle.span
    message = (
        f"this answers `{wrong}`, but the request that waits here is one for `{duty.handle}`, whose client waits for "
        f"ever; answer `{duty.handle}`"
    )
    return span, message, Fix(f"Change to `{duty.handle}`", (TextEdit(span, duty.handle),))


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


class OpenPath(Record, frozen=True, eq=False):
    """A path on which an answer is missing.

    Attributes:
        certain: whether the answer is missing whatever the conditions in the bodies are.
        choices: whether the answer is missing only if the handler selects this one of its targets.
        received_in: the name of the state in which the event of the duty arrives.
    """

    loss: Loss
    certain: bool
    choice: bool
    received_in: str

    @property
    def step(self) -> BehaviorStep:
        return self.loss.step

    @property
    def receives(self) -> bool:
        """Whether the handler at the end of the path is the one that receives the event of the duty."""
        return not self.loss.path

    @property
    def span(self) -> Span:
        """Where the answer is missing."""
        if self.loss.overwritten is not None:
            return self.loss.overwritten.element.name_span
        element = self.step.handler.targets[self.step.choice].element
        if self.choice and element is not None:
            return element.name_span
        return self.step.handler.element.name_span

    @property
    def related(self) -> Iterator[Related]:
        """The handlers on the path."""
        for number, step in enumerate(self.loss.path):
            yield Related(step.handler.element.name_span, _QUESTIONS[self.loss.duty.kind] if number == 0 else "then")
        if self.loss.path:
            yield Related(self.step.handler.element.name_span, "without an answer")

    @property
    def order(self) -> str:
        """The order of requests under which the answer is missing, as a clause; "" if it does not depend on one."""
        between = self.loss.between
        if self.loss.race and self.step.event is not None:
            return f"if the event `{self.step.event.name}` arrives first"
        if between is None:
            return ""
        what = "goal" if between.event.part is ProtocolPart.GOAL else "request"
        name = f" of `{between.sender}`" if between.sender else ""
        due = "goal" if between.duty.kind is not DutyKind.REQUEST else "request"
        asker = f" of `{between.asker}`" if between.asker else ""
        return f"if a {what} for `{between.event.name}`{name} arrives while the {due}{asker} is pending"

    @property
    def dropped(self) -> str:
        """Why the answer is missing if no condition holds, as a clause."""
        if self.step.event is None:
            return "the machine stays in this state while no condition holds"
        return "events are dropped while this condition does not hold"

    @property
    def severity(self) -> Severity | None:
        """The severity of a finding, `None` for that of the rule: a warning if the loss depends on a condition or on
        the order in which several clients act."""
        between = self.loss.between
        if not self.certain or self.loss.race or (between is not None and not between.is_of_one_client):
            return Severity.WARNING
        return None


_QUESTIONS = {
    DutyKind.TICK: "the tick arrives",
    DutyKind.HALT: "the halt arrives",
    DutyKind.REQUEST: "the request arrives",
    DutyKind.GOAL: "the goal arrives",
    DutyKind.RESULT: "the goal is accepted",
}


def protocols(context: MachineContext) -> ClientProtocols:
    """What the clients of the machine may send."""
    if context.system is None:
        return ClientProtocols(None, ())
    known: dict[str, ClientProtocols] = context.system.__dict__.setdefault("client_protocols", {})
    path = context.source.path
    if path not in known:
        known[path] = ClientProtocols(weakref.ref(context.system), context.automata)
    return known[path]


def missed(context: MachineContext, behavior: Behavior, duty: Duty) -> Iterator[OpenPath]:
    """The paths on which the answer to a duty is missing, at most one for each handler; for a handler with several
    targets, one for each target after which it is missing, if it is sent after others.

    Paths are left out if the graph is approximate and the step uncertain, or if another finding explains them: an
    answer of the wrong kind is reported by repeated-answer, an element that cannot be read may be the answer, and a
    condition that has no effect because of earlier conditions (shadowed-transition) is probably wrong.
    """
    lost: dict[Handler, list[Loss]] = {}
    for loss in losses(behavior, duty, protocols(context)):
        step = loss.step
        wrong = any(fault.kind is FaultKind.WRONG_KIND and fault.duty == duty for fault in step.faults)
        if not wrong and (step.certain or not behavior.approximate):
            lost.setdefault(step.handler, []).append(loss)
    for handler, of_handler in lost.items():
        if all(loss.step.ignored for loss in of_handler) and has_shadowed(context.machine, behavior.chart, handler):
            continue
        unexplained = [
            loss
            for loss in of_handler
            if not _may_be_unread(context, behavior, loss) and _may_stay(context, behavior, loss.step)
        ]
        choices = {loss.step.choice for loss in unexplained if not loss.step.ignored}
        if handler.is_probabilistic and choices and len(choices) < len(handler.targets):
            for choice in sorted(choices):
                yield _worst(behavior, [loss for loss in unexplained if loss.step.choice == choice], True)
        elif unexplained:
            yield _worst(behavior, unexplained, False)


def _worst(behavior: Behavior, of_handler: list[Loss], choice: bool) -> OpenPath:
    """The path that is certain and depends on no order of requests, if there is one."""

    def rank(loss: Loss) -> tuple[bool, bool, bool]:
        return (not loss.step.certain or loss.step.ignored, loss.between is not None, loss.overwritten is not None)

    worst = min(of_handler, key=rank)
    first = (*worst.path, worst.step)[0]
    state = behavior.configurations[first.source].state
    return OpenPath(worst, worst.step.certain and not worst.step.ignored, choice, state)


def _may_stay(context: MachineContext, behavior: Behavior, step: BehaviorStep) -> bool:
    """Whether no condition holds for some values that are possible, if a step stays in its state without an event."""
    values = context.local_values.charts.get(behavior.chart.scope)
    if step.event is not None or not step.ignored or step.handler.cond is None or values is None:
        return True
    return step.handler.cond.span in values.uncovered


def place(handler: Handler, statement: Statement | None = None) -> Span:
    """The place where a fault in a step is reported: the name of `handler`, which takes the step, or the name of
    `statement` if it is not inside the handler but in an `<onentry>` or `<onexit>` that the step executes."""
    if statement is not None and not _within(statement.element.span, handler.element.span):
        return statement.element.name_span
    return handler.element.name_span


def _within(inner: Span, outer: Span) -> bool:
    return outer.start <= inner.start and inner.end <= outer.end


def _may_be_unread(context: MachineContext, behavior: Behavior, loss: Loss) -> bool:
    """Whether an element that cannot be read might be the missing answer after a step, or handle an event that leads to
    it. Only elements in the handler, in a state that waits for the answer, or in a state that ignores an event are
    considered."""
    machine, step = context.machine, loss.step
    states = {state.id.value: state.element for state in behavior.chart.states if state.id}
    source = behavior.configurations[step.source]
    names = {behavior.configurations[number].state for number in waiting_behind(behavior, loss, protocols(context))}
    if step.ignored or source.owes(loss.duty):
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
    if element.is_foreign:
        return False
    type_ = HL_SCXML.find(element.name)
    if type_ is None:
        return True
    missing = [name for name in type_.attributes if element.get(name) is None]
    return any(misspelled_attribute(element, name, type_.attributes) for name in missing)


# ------------------------------------------------------------------ the fixes


def answered(
    context: MachineContext,
    path: OpenPath,
    behavior: Behavior,
    title: str,
    lines: tuple[str, ...],
    *,
    preferred: bool,
) -> Iterator[Fix]:
    """Fixes that answer at the end of an open path. No fix is offered if no place on the path is certain.

    If states that answer are never entered, the path probably leads to the wrong state: the first fixes change its
    target. If the handler already answers in some parts of one `<if>`, the answer is added to the part that lacks it;
    if the condition of this `<if>` is constant or cannot be evaluated, the first fix answers without it. Nothing is
    added after an `<if>` that may already have answered, or to a handler that has no content.

    Args:
        lines: the elements that answer.
    """
    states = behavior.chart.states
    step, document = path.step, context.document
    target = step.handler.targets[step.choice]
    element = target.element or step.handler.element
    if step.ignored or path.loss.overwritten is not None or not element.complete:
        return
    if step.handler.trigger is ProtocolPart.GOAL_RESPONSE:
        return  # the element has no content
    name = target.state.value if target.state else ""
    entered = next((state for state in states if state.id and state.id.value == name), None)
    answering = [s for s in target.body if _may_answer(context.machine, s, path.loss.duty)]
    on_entry = entered.entry.statements if entered is not None and entered.entry else ()
    if any(_may_answer(context.machine, statement, path.loss.duty) for statement in on_entry):
        return
    if not answering:
        yield from _redirected(context, behavior, path)
        yield Fix(title, (last_in(document, element, *lines),), preferred=preferred)
    elif len(answering) == 1 and isinstance(answering[0], If):
        yield from _in_branches(context, answering[0], path.loss.duty, title, lines)


def _redirected(context: MachineContext, behavior: Behavior, path: OpenPath) -> Iterator[Fix]:
    """A fix for each state that answers and is never entered, which makes it the target of the path."""
    target = path.step.handler.targets[path.step.choice].state
    entered = {configuration.state for configuration in behavior.configurations}
    for state in behavior.chart.states if target is not None else ():
        if state.id is None or state.id.value in entered:
            continue
        bodies = (target.body for handler in state.handlers for target in handler.targets)
        executed = (*(state.entry.statements if state.entry else ()), *(s for body in bodies for s in body))
        if any(_may_answer(context.machine, statement, path.loss.duty) for statement in executed):
            assert target is not None
            yield Fix(f"Go to the state `{state.id.value}`, which answers", (TextEdit(target.span, state.id.value),))


def _in_branches(context: MachineContext, choice: If, duty: Duty, title: str, lines: tuple[str, ...]) -> Iterator[Fix]:
    document = context.document
    if not choice.element.complete:
        return
    parts = choice.parts
    for part in parts:
        if not any(_may_answer(context.machine, statement, duty) for statement in part.body):
            if part.body:
                edit = after(document, part.body[-1].element, *lines)
            elif part.element is choice.element:
                edit = first_in(document, part.element, *lines)
            else:
                edit = after(document, part.element, *lines)
            yield Fix(f"{title} in this part of the `<if>`", (edit,), preferred=False)
    if choice.otherwise is None and len(choice.branches) == 1 and _is_pointless(context, choice):
        yield without_tags(context.document, choice.element, "Answer without this condition")
    if choice.otherwise is None:
        edit = last_in(document, choice.element, "<else />", *lines)
        yield Fix(f"{title} if no condition holds", (edit,), preferred=False)


def _is_pointless(context: MachineContext, choice: If) -> bool:
    """Whether the first condition of an `<if>` is always the same for what the machines send, or names something that
    does not exist."""
    cond = choice.branches[0].cond
    if cond is None:
        return False
    conditions = (values.conditions.get(cond.span) for values in context.values.charts.values())
    constant = any(known is not None and known.alone.value is not None for known in conditions)
    return constant or any(value.problems for value in context.typed.values if value.value is cond)


def _may_answer(machine: Machine, statement: Statement, duty: Duty) -> bool:
    names = {*ELEMENTS[SENT.get(duty.kind, ProtocolPart.GOAL)]}
    for inner in statements((statement,)):
        if inner.element.name in names:
            declaration = find_handle(machine, inner) if isinstance(inner, RosSend) else None
            if declaration is None or declaration.handle is None or declaration.handle.value == duty.handle:
                return True
    return False


# ------------------------------------------------------------ ticks and halts


class UnhandledState(Record, frozen=True):
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


def running_without(behavior: Behavior, missing: ProtocolPart) -> Iterator[State]:
    """The state of a plugin that handles only halts or only ticks while the node is running, although every other state
    that handles one of both handles both; none if there are several such states. If it does not handle halts, what
    it waits for may end it before a halt arrives, unless at least two similar states handle halts.

    Args:
        missing: what the state does not handle: `BT_TICK` or `BT_HALT`.
    """
    other = ProtocolPart.BT_HALT if missing is ProtocolPart.BT_TICK else ProtocolPart.BT_TICK
    handling = [state for state in behavior.chart.states if _handles(state, other)]
    without = [state for state in handling if not _handles(state, missing)]
    everywhere = running = _running(behavior, range(behavior.size))
    initial = behavior.chart.initial.value if behavior.chart.initial else ""
    alike = [s for s in handling if s.id and s.id.value in everywhere - {initial} and _handles(s, missing)]
    if missing is ProtocolPart.BT_HALT:
        running = _running(behavior, untaken(behavior, HALT, always if len(alike) < 2 else _needs_no_time))
    if len(without) == 1 and len(handling) > 1 and without[0].id is not None and without[0].id.value in running:
        yield without[0]


def _needs_no_time(step: BehaviorStep) -> bool:
    """Whether a step does not wait for something that usually takes time."""
    return step.event is None or step.event.part not in _LASTING


_LASTING = (
    ProtocolPart.MESSAGE,
    ProtocolPart.FEEDBACK,
    ProtocolPart.RESPONSE,
    ProtocolPart.RESULT,
    ProtocolPart.TICK,
)


def _running(behavior: Behavior, numbers: Iterable[int]) -> set[str]:
    """The states of those of the configurations in which the node is running."""
    configurations = (behavior.configurations[number] for number in numbers)
    return {configuration.state for configuration in configurations if configuration.tree is Phase.RUNNING}


def _handles(state: State, part: ProtocolPart) -> bool:
    return any(handler.effective and handler.trigger is part for handler in state.handlers)


def _unhandled_by(
    context: MachineContext, behavior: Behavior, automaton: SystemAutomaton, duty: Duty, possible: Possible = always
) -> Iterator[tuple[State, Phase | None]]:
    """The states in which a tick or halt may arrive at `automaton` and is not handled, with the status of the node
    there: `RUNNING`, `ENDED`, or `None` if it has not been ticked yet."""
    assert context.system is not None
    takes, tag = _HANDLED_BY[duty.kind]
    if all(any(handler.trigger is takes for handler in state.handlers) for state in behavior.chart.states):
        return
    may_come = (statuses_at_tick if duty.kind is DutyKind.TICK else statuses_at_halt)(context.system, automaton)
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
