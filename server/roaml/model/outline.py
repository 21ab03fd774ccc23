# SPDX-License-Identifier: Apache-2.0
"""The outline of a machine: the names and types that the rest of the system uses, without positions.

If two versions of a file have equal outlines, the other files need not be checked again. So typing inside a transition
rechecks only one file.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property

from roaml.expr.tree import Expr, Member, walk
from roaml.expr.tree import Name as NameExpr
from roaml.expr.types import EMPTY_ARRAY, UNKNOWN, Array, Type
from roaml.language import HL_SCXML
from roaml.model.behavior.statuses import ANY_STATUS, TickStatuses, tick_statuses
from roaml.model.behavior.summary import ChartOutline, summarised
from roaml.model.gaps import Gap, PlacedGap, reads_of_ports
from roaml.model.machine import (
    Assign,
    CallChild,
    Chart,
    Declaration,
    Handler,
    Machine,
    ReturnHalted,
    ReturnStatus,
    RosSend,
    Send,
    SetOutput,
    Statement,
    statements,
)
from roaml.model.message_constants import (
    FieldChoice,
    NamedConstant,
    NumberedConstant,
    SentConstants,
    field_choices,
    named_constants,
    numbered_constants,
    sent_constants,
)
from roaml.model.port_checks import PortChoice, PortRefusal, port_choices, port_refusals
from roaml.model.syntax import Expression, Name, PortRead, Value
from roaml.model.value_types import HOLDING, TypedMachine, ValueUse, find_handle
from roaml.model.waits import PortWait, port_waits
from roaml.record import Record
from roaml.roles import Direction, ProtocolPart, SymbolKind
from roaml.xml_syntax import Element


class PortOutline(Record, frozen=True):
    """A port of a plugin. `type` is the type as written; `read` and `written` state whether the machine reads or writes
    the port, and `stored` whether it stores the value in a variable, a field or a parameter."""

    key: str
    type: str
    direction: Direction
    read: bool
    written: bool
    stored: bool = False


class SentField(Record, frozen=True):
    """A field or parameter that is sent, with its type."""

    name: str
    type: Type


class InterfaceUse(Record, frozen=True):
    """A declared ROS interface and its uses by the machine.

    Attributes:
        name: the topic, service or action as written; "" if the value of the port `port` provides it.
        sends, receives: the parts of the interface that the machine sends and receives.
        fields: for each part that is sent, its fields with the types of their values, including fields that are not
            set.
        awaited: for a subscriber, whether the machine can reach a state in which it waits only for this topic.
        reads: for a subscriber, whether callbacks read its messages.
    """

    kind: SymbolKind
    handle: str
    name: str
    port: str
    type: str
    sends: frozenset[ProtocolPart]
    receives: frozenset[ProtocolPart]
    fields: tuple[tuple[ProtocolPart, tuple[SentField, ...]], ...]
    awaited: bool = False
    reads: bool = False


class EventSent(Record, frozen=True):
    """A `<send>`. A parameter whose value is a struct is listed once, without its members."""

    event: str
    params: tuple[SentField, ...]


class EventReceived(Record, frozen=True):
    """A transition on an event.

    Attributes:
        reads: the parameters that are read.
        forwarded: whether the types of parameters that the transition sends depend on parameters of the event.
    """

    event: str
    reads: frozenset[str]
    forwarded: bool


class TimerOutline(Record, frozen=True):
    """A declared timer.

    Attributes:
        rate: the rate in Hz, as written; "" if a port provides it.
        port: the port that provides the rate; "" if there is none.
        users: the number of charts with a callback of the timer.
    """

    name: str
    rate: str
    port: str
    users: int


class ThreadOutline(Record, frozen=True):
    server: str
    count: int


class PluginOutline(Record, frozen=True):
    """The part that a machine has in a behavior tree.

    Attributes:
        ticked, halted: whether it handles ticks and halts.
        answers_tick, answers_halt: whether it answers ticks and halts.
        children: the greatest literal child index that it ticks or halts, plus 1; 0 if there is none.
        any_child: whether it ticks or halts children by a variable index.
        ticked_children: the literal indices of the children that it ticks; `None` if it may tick any child.
        halts_children: whether it halts children and waits for their answer.
        acts_on_first_halt: whether a halt before its first tick does more than confirm the halt.
        port_waits: the ports that set how long it takes until it can return SUCCESS.
        port_refusals, port_choices: the values of ports that it refuses, and among which it distinguishes.
        statuses: the statuses that it can return.
    """

    ticked: bool
    halted: bool
    answers_tick: bool
    answers_halt: bool
    children: int
    any_child: bool
    ticked_children: frozenset[int] | None
    halts_children: bool
    acts_on_first_halt: bool = False
    port_waits: tuple[PortWait, ...] = ()
    port_refusals: tuple[PortRefusal, ...] = ()
    port_choices: tuple[PortChoice, ...] = ()
    statuses: TickStatuses = ANY_STATUS


class MachineOutline(Record, frozen=True, dict=True):
    """The outline of a machine.

    Attributes:
        gaps: the facts that its unreadable parts may contain.
        all_ports: whether `ports` is complete: all declarations of ports can be read.
        charts: the outline of the behaviour of each chart; it is empty for a chart that is too large to be analysed.
        choices, constants: the constants with which it compares fields, and which it sends in fields.
        numbered: its constants with a number, if its name contains a number.
        named: its variables in upper case that always have the same integer.
    """

    name: str
    root: str
    plain: bool
    gaps: frozenset[Gap]
    ports: tuple[PortOutline, ...]
    interfaces: tuple[InterfaceUse, ...]
    sent: tuple[EventSent, ...]
    received: tuple[EventReceived, ...]
    timers: tuple[TimerOutline, ...]
    threads: tuple[ThreadOutline, ...]
    plugin: PluginOutline
    all_ports: bool = True
    charts: tuple[ChartOutline, ...] = ()
    choices: tuple[FieldChoice, ...] = ()
    constants: tuple[SentConstants, ...] = ()
    numbered: frozenset[NumberedConstant] = frozenset()
    named: frozenset[NamedConstant] = frozenset()

    @property
    def takes_part_in_tree(self) -> bool:
        """Whether the machine takes part in the behavior tree, or sends or receives plain events of the tree
        (docs/spec/files.md#removed-tree-events)."""
        plugin = self.plugin
        takes = plugin.ticked or plugin.halted
        answers = plugin.answers_tick or plugin.answers_halt
        calls = plugin.children > 0 or plugin.any_child
        events = (*(sent.event for sent in self.sent), *(received.event for received in self.received))
        return takes or answers or calls or bool(self.ports) or any(event.startswith("bt_") for event in events)

    def port(self, key: str) -> PortOutline | None:
        return next((port for port in self.ports if port.key == key), None)

    def use(self, kind: SymbolKind, handle: str) -> InterfaceUse | None:
        """The first declaration with this kind and handle; `None` if there is none."""
        return self._uses.get((kind, handle))

    @cached_property
    def _uses(self) -> Mapping[tuple[SymbolKind, str], InterfaceUse]:
        return {(use.kind, use.handle): use for use in reversed(self.interfaces)}


def outline(machine: Machine, typed: TypedMachine, gaps: Iterable[PlacedGap]) -> MachineOutline:
    """The outline of a machine whose gaps are `gaps`."""
    types = {value.element: value.sent for value in typed.values if value.use in (ValueUse.PARAMETER, ValueUse.FIELD)}
    reads, forwarding = _reads(typed), _forwarding(typed)
    known_gaps = frozenset(placed.gap for placed in gaps)
    return MachineOutline(
        machine.name.value if machine.name else "",
        machine.root,
        machine.plain,
        known_gaps,
        _ports(machine, typed),
        _interfaces(machine, typed, types),
        tuple(
            dict.fromkeys(
                EventSent(
                    statement.event.value,
                    tuple(SentField(p.name.value, types.get(p.element, UNKNOWN)) for p in statement.params if p.name),
                )
                for chart in machine.charts
                for statement in chart.executed
                if isinstance(statement, Send) and statement.event
            )
        ),
        tuple(
            EventReceived(handler.event.value, frozenset(reads[handler]), handler in forwarding)
            for handler in _handlers(machine)
            if handler.trigger is ProtocolPart.EVENT and handler.event
        ),
        _timers(machine),
        tuple(
            ThreadOutline(thread.server.value if thread.server else "", thread.count or 1) for thread in machine.threads
        ),
        _plugin(machine, typed, ANY_STATUS if known_gaps else tick_statuses(machine)),
        _declares_all_ports(machine),
        tuple(summarised(machine, chart) for chart in machine.charts),
        () if known_gaps else field_choices(machine, typed),
        sent_constants(machine),
        frozenset(known for known, _ in numbered_constants(machine, typed)),
        frozenset(known for chart in machine.charts for known in named_constants(chart)),
    )


def _handlers(machine: Machine) -> Iterator[Handler]:
    for chart in machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.effective:
                    yield handler


def _executed(machine: Machine) -> Iterator[Statement]:
    for chart in machine.charts:
        yield from chart.executed


def _declares_all_ports(machine: Machine) -> bool:
    """Whether every port declaration has a key and none is misspelled."""
    strange = [e for e in machine.element.elements if e.name not in HL_SCXML.elements and not e.is_foreign]
    return all(port.key for port in machine.ports) and not any(e.get("key") for e in strange)


def _ports(machine: Machine, typed: TypedMachine) -> tuple[PortOutline, ...]:
    read = {value.key.value for value in reads_of_ports(machine, typed) if value.key}
    holders = (v.value for v in typed.values if v.use in (*HOLDING, ValueUse.PARAMETER))
    stored = {_port_key(value) for value in holders if isinstance(value, PortRead)}
    written = {s.key.value for s in _executed(machine) if isinstance(s, SetOutput) and s.key}
    return tuple(
        PortOutline(
            port.key.value,
            port.type.text if port.type else "",
            port.direction,
            port.key.value in read,
            port.key.value in written,
            port.key.value in stored,
        )
        for port in machine.ports
        if port.key
    )


def _interfaces(machine: Machine, typed: TypedMachine, types: dict[Element, Type]) -> tuple[InterfaceUse, ...]:
    sends: defaultdict[Element, set[ProtocolPart]] = defaultdict(set)
    receives: defaultdict[Element, set[ProtocolPart]] = defaultdict(set)
    fields: defaultdict[Element, dict[ProtocolPart, dict[str, Type]]] = defaultdict(dict)
    for statement in _executed(machine):
        if isinstance(statement, RosSend) and (declaration := find_handle(machine, statement)):
            part = statement.part
            sends[declaration.element].add(part)
            known = fields[declaration.element].setdefault(part, {})
            for field in statement.fields:
                if field.name:
                    known.setdefault(field.name.value, types.get(field.element, UNKNOWN))
            for path, type_ in typed.unset.get(statement.element, ()):
                known.setdefault(path, EMPTY_ARRAY if isinstance(type_, Array) else type_)
    for handler in _handlers(machine):
        if handler.trigger and (declaration := find_handle(machine, handler)):
            receives[declaration.element].add(handler.trigger)
    read = {declaration.element for declaration in _read_messages(machine, typed)}
    charts = [_Waiting(machine, chart) for chart in machine.charts]
    return tuple(
        InterfaceUse(
            declaration.kind,
            declaration.handle.value if declaration.handle else "",
            declaration.interface.value if isinstance(declaration.interface, Name) else "",
            _port_key(declaration.interface),
            declaration.type.value if declaration.type else "",
            frozenset(sends[declaration.element]),
            frozenset(receives[declaration.element]),
            tuple(
                (part, tuple(SentField(name, type_) for name, type_ in known.items()))
                for part, known in fields[declaration.element].items()
            ),
            declaration.kind is SymbolKind.SUBSCRIBER and any(chart.awaits(declaration) for chart in charts),
            declaration.element in read,
        )
        for declaration in machine.declarations
        if declaration.kind is not SymbolKind.TIMER
    )


def _read_messages(machine: Machine, typed: TypedMachine) -> Iterator[Declaration]:
    """The subscribers whose callbacks read the message."""
    for value in typed.values:
        handler = value.place.handler
        if handler is None or handler.trigger is not ProtocolPart.MESSAGE or not isinstance(value.value, Expression):
            continue
        if any(isinstance(node, NameExpr) and node.name == "_msg" for node in walk(value.value.tree)):
            declaration = find_handle(machine, handler)
            if declaration is not None:
                yield declaration


class _Waiting:
    """The events that the states of a chart wait for.

    Attributes:
        states: state -> the declarations that its effective handlers refer to, and the states that they lead to. States
            without any handler are left out.
        sole: each declaration that is the only one for which some state waits.
        is_stuck: whether some state has handlers, but no effective handler.
    """

    def __init__(self, machine: Machine, chart: Chart) -> None:
        self.initial = chart.initial.value if chart.initial else ""
        self.states = {
            state.id.value: [
                (find_handle(machine, handler), {target.state.value for target in handler.targets if target.state})
                for handler in state.handlers
                if handler.effective
            ]
            for state in chart.states
            if state.id and state.handlers
        }
        declarations = [{declaration for declaration, _ in waits} for waits in self.states.values()]
        self.sole = {declaration for waits in declarations if len(waits) == 1 for declaration in waits}
        self.is_stuck = not all(declarations)

    def awaits(self, subscriber: Declaration) -> bool:
        """Whether the chart can reach a state that it leaves only when a message of the topic arrives, and reach this
        state without a message of the topic."""
        if subscriber not in self.sole and not self.is_stuck:
            return False
        pending, seen = [self.initial], {self.initial}
        while pending:
            waits = self.states.get(pending.pop())
            if waits is None:
                continue
            others = [targets for declaration, targets in waits if declaration is not subscriber]
            if not others:
                return True
            new = set().union(*others) - seen
            seen |= new
            pending += new
        return False


def _timers(machine: Machine) -> tuple[TimerOutline, ...]:
    users = {
        name: sum(
            any(
                handler.trigger is ProtocolPart.TICK and handler.handle and handler.handle.value == name
                for state in chart.states
                for handler in state.handlers
            )
            for chart in machine.charts
        )
        for name in {d.handle.value for d in machine.declarations if d.kind is SymbolKind.TIMER and d.handle}
    }
    return tuple(
        TimerOutline(
            declaration.handle.value,
            declaration.rate.value if isinstance(declaration.rate, Name) else "",
            _port_key(declaration.rate),
            users[declaration.handle.value],
        )
        for declaration in machine.declarations
        if declaration.kind is SymbolKind.TIMER and declaration.handle
    )


def _port_key(value: Name | PortRead | None) -> str:
    return value.key.value if isinstance(value, PortRead) and value.key else ""


def _plugin(machine: Machine, typed: TypedMachine, answers: TickStatuses) -> PluginOutline:
    values = (v.value for v in typed.values if v.use is not ValueUse.LOCATION)
    expressions = (value for value in values if isinstance(value, Expression))
    triggers = {handler.trigger for handler in _handlers(machine)}
    statements = list(_executed(machine))
    calls = [statement for statement in statements if isinstance(statement, CallChild)]
    indexes = [_index(call.child) for call in calls if call.child]
    literal = [index for index in indexes if index is not None]
    ticked = [_index(call.child) for call in calls if not call.halts]
    return PluginOutline(
        ProtocolPart.BT_TICK in triggers,
        ProtocolPart.BT_HALT in triggers,
        any(isinstance(statement, ReturnStatus) for statement in statements),
        any(isinstance(statement, ReturnHalted) for statement in statements),
        max(literal, default=-1) + 1,
        len(literal) < len(indexes),
        None if None in ticked else frozenset(index for index in ticked if index is not None),
        any(call.halts for call in calls if call.child) and ProtocolPart.CHILD_HALTED in triggers,
        _acts_on_first_halt(machine),
        tuple(dict.fromkeys(port_waits(machine))),
        tuple(dict.fromkeys(port_refusals(machine))),
        tuple(port_choices(machine, expressions)),
        answers,
    )


def _acts_on_first_halt(machine: Machine) -> bool:
    """Whether a halt in the initial state of a machine does more than confirm the halt, pass it on to a child, and give
    variables their initial values, which they still have."""
    chart = machine.chart
    name = chart.initial.value if chart.initial else ""
    initial = {data.id.value: _text(data.value) for data in chart.data if data.id}
    handlers = (h for state in chart.states if state.id and state.id.value == name for h in state.handlers)
    for handler in handlers:
        if handler.trigger is ProtocolPart.BT_HALT:
            moves = any(target.state is None or target.state.value != name for target in handler.targets)
            done = [statement for target in handler.targets for statement in statements(target.body)]
            passes_on = any(isinstance(statement, CallChild) and statement.halts for statement in done)
            acts = (s for s in done if not isinstance(s, ReturnHalted | CallChild) and not _is_reset(s, initial))
            return (moves and not passes_on) or any(acts)
    return False


def _is_reset(statement: Statement, initial: Mapping[str, str | None]) -> bool:
    """Whether a statement assigns to a variable its initial value, as written."""
    if not isinstance(statement, Assign) or statement.location is None:
        return False
    value = _text(statement.value)
    return value is not None and value == initial.get(statement.location.text.strip())


def _text(value: Value | None) -> str | None:
    return value.text.strip() if isinstance(value, Expression) else None


def _index(child: Name | None) -> int | None:
    """The index of a child if it is a literal; otherwise `None`."""
    return int(child.value[:6]) if child and child.value.isascii() and child.value.isdigit() else None


def _reads(typed: TypedMachine) -> defaultdict[Handler, set[str]]:
    """Handler of a plain event -> the names in `_event.data.NAME` that it reads."""
    reads: defaultdict[Handler, set[str]] = defaultdict(set)
    for value in typed.values:
        handler = value.place.handler
        if handler is not None and handler.trigger is ProtocolPart.EVENT and isinstance(value.value, Expression):
            reads[handler].update(event_parameters(value.value.tree))
    return reads


def _forwarding(typed: TypedMachine) -> set[Handler]:
    """The handlers of plain events on whose data the types of sent parameters depend."""
    return {
        value.place.handler
        for value in typed.values
        if value.place.handler is not None
        and value.use is ValueUse.PARAMETER
        and isinstance(value.value, Expression)
        and any(event_parameters(value.value.tree))
    }


def event_parameters(tree: Expr) -> Iterator[str]:
    """The names after `_event.data.` in an expression."""
    for node in walk(tree):
        match node:
            case Member(object=Member(object=NameExpr(name="_event"), name="data")) if node.name:
                yield node.name
