# SPDX-License-Identifier: Apache-2.0
"""Translates a machine in its place in the system to plain automata: one for the machine itself, and one for each copy
of its action threads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal, InvalidOperation

from roaml.exhaustive import assert_never
from roaml.expr.tree import Boolean, Expr
from roaml.expr.types import Type
from roaml.lower.blackboard_events import answer_of, request_of
from roaml.lower.build import both, equal, event_data, integer, name
from roaml.lower.context import LoweringContext, type_of, variables_of
from roaml.lower.data import lower_data
from roaml.lower.executed_goals import executed_goals
from roaml.lower.expressions import LoweringScope, lower_expr
from roaml.lower.interfaces import ActionEvents, ServiceEvents, topic_event, tree_event
from roaml.lower.nodes import builtin_ports
from roaml.lower.program import TranslatableSystem
from roaml.lower.statements import StatementLowering, literal_index
from roaml.model import machine as hl
from roaml.model.expand import PortConstant
from roaml.model.machine import Chart, Handler, Machine, statements
from roaml.model.syntax import Expression, PortRead, Value
from roaml.model.system import SystemAutomaton
from roaml.record import replace
from roaml.roles import ProtocolPart, SymbolKind, ValuePart
from roaml.scxml.events import Role, ScxmlEvent
from roaml.scxml.model import Automaton as PlainAutomaton
from roaml.scxml.model import Data, Send, State, Statement, Target, Transition
from roaml.scxml.names import STATUSES, TreeEventKind, named, sanitise
from roaml.text import NO_SPAN

TimerEvents = Mapping[tuple[str, str], ScxmlEvent]
"""(name of a plain automaton, handle of a timer) -> the event of the ticks of the timer."""


def copies(automaton: SystemAutomaton, machine: Machine) -> Iterator[tuple[str, Chart, int | None]]:
    """The names of the plain automata of a machine, with their charts and the numbers of their threads; the number is
    `None` for the machine itself."""
    yield automaton.name, machine.chart, None
    for thread in machine.threads:
        server = next(
            (
                use
                for use in automaton.outline.interfaces
                if thread.server and use.kind is SymbolKind.ACTION_SERVER and use.handle == thread.server.value
            ),
            None,
        )
        action = automaton.interface_name(server) if server else None
        if action is None:
            raise AssertionError("a rule reports threads without an action")
        for k in range(thread.count or 0):
            yield f"{sanitise(action)}_thread_{k}", thread.chart, k


def thread_name(machine: Machine, chart: Chart, number: int) -> str:
    """The name of an action thread for users within its machine, such as `goal thread 0`; with the name of its action
    server if the machine has threads of several servers.

    Args:
        chart: the chart of the thread.
        number: the number of the copy of the chart.
    """
    name = f"goal thread {number}"
    handles = {thread.server.value: thread.chart for thread in machine.threads if thread.server}
    server = next((handle for handle, of_server in handles.items() if of_server is chart), "")
    return f"{name} of {server}" if len(handles) > 1 and server else name


def lower_machine(
    automaton: SystemAutomaton, machine: Machine, program: TranslatableSystem, timers: TimerEvents
) -> Iterator[PlainAutomaton]:
    ports = {} if automaton.path else builtin_ports(automaton)
    for plain_name, chart, thread in copies(automaton, machine):
        events = {timer: event for (user, timer), event in timers.items() if user == plain_name}
        variables = variables_of(chart, program)
        yield _ChartLowering(
            LoweringContext(program, automaton, machine, chart, plain_name, thread, events, ports, variables)
        ).automaton()


class _ChartLowering:
    def __init__(self, context: LoweringContext) -> None:
        self.context = context
        self.goals = executed_goals(context)
        self.statements = StatementLowering(context, self.goals)
        self.state_ids = {state.id.value for state in context.chart.states if state.id}

    def automaton(self) -> PlainAutomaton:
        context, chart = self.context, self.context.chart
        assert chart.initial is not None
        states = [plain for state in chart.states for plain in self.state(state)]
        states[0] = replace(states[0], transitions=(*states[0].transitions, *self.discarded(states[0])))
        origin = context.origin(chart.element.name_span)
        data = (*self.data(), *self.goals.data(origin), *self.statements.drawn)
        thread_of, thread = "", ""
        if context.thread is not None:
            thread_of, thread = context.automaton.name, thread_name(context.machine, chart, context.thread)
        return PlainAutomaton(
            context.name, Role.MACHINE, chart.initial.value, data, tuple(states), origin, thread_of, thread
        )

    def discarded(self, state: State) -> Iterator[Transition]:
        """Transitions that are never taken. They make the machine a receiver of the cancel requests that only its
        threads handle, so that no request is delivered while the machine passes a goal on to a thread
        (docs/spec/plain-scxml.md#cancel)."""
        if self.context.thread is not None:
            return
        own = set(self.cancel_events(self.context.chart))
        of_threads = (event for thread in self.context.machine.threads for event in self.cancel_events(thread.chart))
        for event in dict.fromkeys(of_threads):
            if event not in own:
                target = Target(state.id, 1.0, (), state.origin)
                yield Transition(event, Boolean(NO_SPAN, False), (target,), state.origin)

    def cancel_events(self, chart: Chart) -> Iterator[ScxmlEvent]:
        for state in chart.states:
            for handler in state.handlers:
                if handler.trigger is ProtocolPart.CANCEL and handler.effective:
                    yield ActionEvents(self.context.channel(handler).name).cancel

    # -------------------------------------------------------------------- data

    def data(self) -> Iterator[Data]:
        seen: set[str] = set()
        for data in self.context.chart.data:
            assert data.id is not None
            if data.id.value not in seen:
                seen.add(data.id.value)
                type_ = type_of(data, self.context.program)
                origin = self.context.origin(data.element.span)
                yield from lower_data(data.id.value, type_, self.initial(data.value, type_), origin)

    def initial(self, value: Value | None, type_: Type) -> Expr | None:
        match value:
            case Expression():
                return value.tree
            case PortRead():
                held = self.context.port(value)
                assert isinstance(held, PortConstant)
                return self.context.constant(value, held)
        return None

    # ------------------------------------------------------------------ states

    def state(self, state: hl.State) -> Iterator[State]:
        """The plain states for a state: the state itself, and an additional one for each handler that reads the
        blackboard."""
        assert state.id is not None
        scope = self.context.scope()
        entry = self.statements.body(state.entry.statements, scope) if state.entry else ()
        leave = self.statements.body(state.exit.statements, scope) if state.exit else ()
        transitions: list[Transition] = []
        split: list[State] = []
        for handler in state.handlers:
            if not handler.effective:
                continue
            if self.reads_blackboard(handler):
                waiting = self.waiting_state(state.id.value, handler, len(split) + 1)
                split.append(waiting)
                transitions += self.asking(handler, waiting.id)
            else:
                transitions += self.transitions(handler)
        yield State(state.id.value, entry, leave, tuple(transitions), self.context.origin(state.element.span))
        yield from split

    # -------------------------------------------------------------- blackboard

    def reads_blackboard(self, handler: Handler) -> bool:
        return any(
            self.context.is_reference(value)
            for target in handler.targets
            for statement in statements(target.body)
            for value in values_in(statement)
        )

    def waiting_state(self, state: str, handler: Handler, number: int) -> State:
        """The state in which the machine waits for the answer of the blackboard before it executes the handler
        (docs/spec/plain-scxml.md#blackboard-read)."""
        origin = self.context.origin(handler.element.span)
        target = handler.targets[0]
        scope = LoweringScope(self.context.variables, {}, {})
        identifier = f"{state}_{handler.element.name}_{number}"
        while identifier in self.state_ids:
            identifier += "_"
        self.state_ids.add(identifier)
        assert target.state is not None
        body = self.statements.body(target.body, scope)
        event = answer_of(self.context.tree)
        answered = Transition(event, None, (Target(target.state.value, 1.0, body, origin),), origin)
        return State(identifier, (), (), (answered,), origin)

    def asking(self, handler: Handler, waiting: str) -> Iterator[Transition]:
        """The transitions for the first half of a handler that reads the blackboard. They have its trigger and
        condition, and send the request to the blackboard."""
        origin = self.context.origin(handler.element.span)
        ask = (Send(request_of(self.context.tree), (), origin),)
        body = (*self.started(handler), *ask)
        for event, cond in self.triggers(handler):
            yield Transition(event, cond, (Target(waiting, 1.0, body, origin),), origin)

    # ------------------------------------------------------------- transitions

    def transitions(self, handler: Handler) -> Iterator[Transition]:
        origin = self.context.origin(handler.element.span)
        if handler.trigger is ProtocolPart.GOAL_RESPONSE:
            yield from self.goal_response(handler)
            return
        for event, cond in self.triggers(handler):
            yield Transition(event, cond, self.targets(handler), origin)

    def goal_response(self, handler: Handler) -> Iterator[Transition]:
        origin = self.context.origin(handler.element.span)
        events = ActionEvents(self.context.channel(handler).name)
        answers = (events.accept_for(self.context.automaton), events.reject_for(self.context.automaton))
        for event, target in zip(answers, handler.targets, strict=True):
            assert target.state is not None
            yield Transition(event, None, (Target(target.state.value, 1.0, (), origin),), origin)

    def targets(self, handler: Handler) -> tuple[Target, ...]:
        scope = self.context.scope(handler)
        targets = []
        for target, probability in zip(handler.targets, probabilities(handler), strict=True):
            assert target.state is not None
            origin = self.context.origin((target.element or handler.element).span)
            body = (*self.started(handler), *self.statements.body(target.body, scope))
            targets.append(Target(target.state.value, probability, body, origin))
        return tuple(targets)

    def started(self, handler: Handler) -> Iterator[Statement]:
        """The statements that are executed before the body of a handler."""
        if handler.trigger is ProtocolPart.THREAD_START:
            origin = self.context.origin(handler.element.span)
            yield from self.goals.start(self.context.channel(handler), origin)

    def triggers(self, handler: Handler) -> Iterator[tuple[ScxmlEvent | None, Expr | None]]:
        """The events that the handler waits for, each with its condition. Most handlers wait for one event."""
        cond = self.condition(handler)
        match handler.trigger:
            case ProtocolPart.CHILD_STATUS | ProtocolPart.CHILD_HALTED:
                yield from self.child_triggers(handler, cond)
            case ProtocolPart.THREAD_START:
                assert self.context.thread is not None
                yield self.event(handler), equal(event_data("thread_id"), integer(self.context.thread))
            case ProtocolPart.CANCEL:
                is_executed = self.goals.is_executed(self.context.channel(handler))
                yield self.event(handler), cond if is_executed is None else both(cond, is_executed)
            case ProtocolPart.RESULT if handler.type.code:
                yield self.event(handler), both(cond, equal(event_data("code"), integer(handler.type.code)))
            case _:
                yield self.event(handler), cond

    def condition(self, handler: Handler) -> Expr | None:
        if handler.cond is None:
            return None
        scope = self.context.scope(handler, ValuePart.COND)
        if handler.trigger in (ProtocolPart.CHILD_STATUS, ProtocolPart.CHILD_HALTED):
            scope = replace(scope, constants=STATUSES)
        return lower_expr(handler.cond.tree, scope)

    def child_triggers(self, handler: Handler, cond: Expr | None) -> Iterator[tuple[ScxmlEvent | None, Expr | None]]:
        assert handler.child is not None
        is_status = handler.trigger is ProtocolPart.CHILD_STATUS
        answer = TreeEventKind.RESPONSE if is_status else TreeEventKind.HALT_RESPONSE
        children = self.statements.children
        if (index := literal_index(handler.child)) is not None:
            yield tree_event(children[index], answer), cond
            return
        variable = name(handler.child.value, handler.child.span)
        for i, child in enumerate(children):
            yield tree_event(child, answer), both(cond, equal(variable, integer(i)))

    def event(self, handler: Handler) -> ScxmlEvent | None:
        automaton, trigger = self.context.automaton, handler.trigger
        match trigger:
            case None:
                return None
            case ProtocolPart.EVENT:
                assert handler.event is not None
                return named(handler.event.value)
            case ProtocolPart.TICK:
                assert handler.handle is not None
                return self.context.timers[handler.handle.value]
            case ProtocolPart.BT_HALT:
                return tree_event(self.statements.address, TreeEventKind.HALT)
            case ProtocolPart.BT_TICK:
                return tree_event(self.statements.address, TreeEventKind.TICK)
        channel = self.context.channel(handler)
        service, action = ServiceEvents(channel.name), ActionEvents(channel.name)
        match trigger:
            case ProtocolPart.MESSAGE:
                return topic_event(channel.name)
            case ProtocolPart.REQUEST:
                return service.request
            case ProtocolPart.RESPONSE:
                return service.response_to(automaton)
            case ProtocolPart.GOAL:
                return action.goal
            case ProtocolPart.CANCEL:
                return action.cancel
            case ProtocolPart.FEEDBACK:
                return action.feedback_for(automaton)
            case ProtocolPart.RESULT:
                return action.result_for(automaton)
            case ProtocolPart.THREAD_START:
                return action.thread_start
            case ProtocolPart.THREAD_FREE:
                return action.thread_free
            case (
                ProtocolPart.BLACKBOARD
                | ProtocolPart.BT_HALTED
                | ProtocolPart.BT_STATUS
                | ProtocolPart.CHILD_HALT
                | ProtocolPart.CHILD_HALTED
                | ProtocolPart.CHILD_STATUS
                | ProtocolPart.CHILD_TICK
                | ProtocolPart.GOAL_ACCEPTED
                | ProtocolPart.GOAL_REJECTED
                | ProtocolPart.GOAL_RESPONSE
                | ProtocolPart.START
            ):
                raise AssertionError(f"not the trigger of a single transition: {trigger}")
            case _:
                return assert_never(trigger)


def values_in(statement: hl.Statement) -> Iterator[Value | None]:
    """The values of a statement that may come from a port."""
    match statement:
        case hl.Assign():
            yield statement.value
        case hl.Send():
            yield from (param.value for param in statement.params)
        case hl.RosSend():
            yield from (param.value for param in statement.fields)


def probabilities(handler: Handler) -> list[float]:
    """The probabilities of the targets. They add up to 1, because a missing probability is what remains
    (docs/spec/machines.md#targets)."""
    given = [_decimal(target.probability.value) if target.probability else None for target in handler.targets]
    rest = 1 - sum((p for p in given if p is not None), Decimal(0))
    known = [rest if p is None else p for p in given]
    total = sum(known, Decimal(0))
    return [float(p if total == 1 else p / total) for p in known]


def _decimal(text: str) -> Decimal:
    try:
        return Decimal(text)
    except InvalidOperation:
        raise AssertionError("a rule reports invalid probabilities") from None
