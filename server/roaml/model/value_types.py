# SPDX-License-Identifier: Apache-2.0
"""Every value in a machine with its type, its required type, and its errors.

The result is computed in one pass over the machine; rules, hover and completion read it. An `Environment` provides the
types that other files determine; the pass itself reads only one machine.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator, Mapping
from typing import Protocol

from roaml.expr.infer import Problem, RandomUsed, infer
from roaml.expr.tree import Number, walk
from roaml.expr.types import (
    BASE_TYPES,
    BOOL,
    INT,
    UNKNOWN,
    Struct,
    StructKind,
    Type,
    leaves,
    member_type,
    resolve_type,
    same_kind,
    unwrap,
)
from roaml.interfaces.types import Kind
from roaml.interruption import checkpoint
from roaml.language.grammar import Binding
from roaml.model.initial import InitialProblem, check_bound, check_initial
from roaml.model.machine import (
    Assign,
    Chart,
    Data,
    Declaration,
    Handler,
    If,
    Machine,
    Param,
    RosSend,
    Send,
    SetOutput,
    State,
    Statement,
)
from roaml.model.ros import InterfaceType
from roaml.model.syntax import Expression, Name, PortRead, Value
from roaml.record import Record, field, replace
from roaml.roles import ProtocolPart, SymbolKind, ValuePart
from roaml.scxml.names import STATUSES
from roaml.xml_syntax import Element


class Environment(Protocol):
    """The part of a system that determines the types in a machine."""

    def struct(self, name: str) -> Type | None:
        """The struct named `name`; `None` if there is none."""

    def interface(self, kind: str, name: str) -> InterfaceType | None:
        """The ROS type `name`, as written in the model, of the kind msg, srv or action; `None` if it is not found."""

    def published(self, topic: str) -> tuple[InterfaceType, ...]:
        """The known types with which other machines publish on the topic `topic`, which is named as written."""

    def event_data(self, event: str) -> Struct | None:
        """The parameters that the senders of a plain event send; `None` if they are unknown."""


class ValueUse(enum.Enum):
    """The purpose of a value."""

    CONDITION = "condition of a transition"
    BRANCH = "condition of an if"
    ASSIGNED = "assigned value"
    LOCATION = "assigned location"
    PARAMETER = "event parameter"
    FIELD = "field"
    ARGUMENT = "goal or thread id"
    OUTPUT = "output port"
    INITIAL = "initial value"
    BOUND = "bound"


CONDITIONS = (ValueUse.CONDITION, ValueUse.BRANCH)
HOLDING = (ValueUse.ASSIGNED, ValueUse.FIELD, ValueUse.OUTPUT, ValueUse.INITIAL)
"""The uses that store a value in a variable or field with a type."""


class BranchConditions(Record, frozen=True, eq=False):
    """A condition of an enclosing `<if>`, whether it holds, and the earlier conditions as a linked list.

    Each branch of an `<if>` has the conditions of all branches before it, so earlier conditions are shared in memory.
    """

    condition: Expression
    holds: bool
    before: BranchConditions | None

    def __iter__(self) -> Iterator[tuple[Expression, bool]]:
        """The conditions and whether they hold, the innermost and latest first."""
        node: BranchConditions | None = self
        while node is not None:
            yield node.condition, node.holds
            node = node.before


class ValuePlace(Record, frozen=True, eq=False):
    """The place of a value in a machine.

    Attributes:
        part: the part of the machine that contains the value.
        late: whether further steps, such as the sending of an event or the evaluation of a condition of an `<if>`, are
            between the arrival of the event and the evaluation of this value, so that the event data may be newer
            (docs/spec/machines.md#event-data-lifetime).
        branch_conditions: the conditions of enclosing `<if>` elements, which are known to hold or not to hold; `None`
            if there are none.
    """

    chart: Chart
    state: State | None
    handler: Handler | None
    part: ValuePart
    late: bool = False
    branch_conditions: BranchConditions | None = None


class TypedValue(Record, frozen=True, eq=False):
    """A value with its type and problems.

    Attributes:
        required: the required type; `None` if any type is allowed.
        target: a phrase for the field, parameter, location or variable that receives the value; "" if there is none.
        sent: the type of the value in the translation, if it is sent. In the translation, `2.0` is an int
            (docs/spec/expressions.md#whole-reals).
    """

    use: ValueUse
    value: Value
    type: Type
    required: Type | None
    problems: tuple[Problem | InitialProblem, ...]
    element: Element
    place: ValuePlace
    target: str = ""
    sent: Type = UNKNOWN


class TypedMachine(Record, frozen=True, eq=False):
    """A machine with the types of its values.

    Attributes:
        values: all values, in document order within each chart.
        variables: scope of a chart -> the types of its data; if ids are equal, the first declaration is used.
        unset: sending element -> the fields that it should set but does not set; see `unset_fields`.
    """

    values: tuple[TypedValue, ...]
    variables: Mapping[str, Mapping[str, Type]]
    unset: Mapping[Element, tuple[tuple[str, Type], ...]]


def type_machine(
    machine: Machine, environment: Environment, without_events: TypedMachine | None = None
) -> TypedMachine:
    """Determine the types and problems of all values of a machine.

    Args:
        without_events: the result for the same machine in the same environment without event data. Values that cannot
            depend on event data are copied from it.
    """
    typer = _Typer(machine, environment)
    for value in without_events.values if without_events else ():
        handler = value.place.handler
        if handler is not None and handler.trigger is not ProtocolPart.EVENT:
            typer.taken_over.setdefault(handler, []).append(value)
    for chart in machine.charts:
        typer.chart(chart)
    sent = (s for chart in machine.charts for s in chart.statements if isinstance(s, RosSend))
    unset = {
        statement.element: fields for statement in sent if (fields := unset_fields(statement, machine, environment))
    }
    return TypedMachine(tuple(typer.values), typer.variables, unset)


# ------------------------------------------------------------- event variables

GOAL_ID = BASE_TYPES["int32"]
STATUS = BASE_TYPES["int8"]


def bindings(handler: Handler, part: ValuePart, machine: Machine, environment: Environment) -> dict[str, Type]:
    """The event variables available in the `part` (`COND` or `BODY`) of a handler, with their types."""
    return {binding.name: event_variable(binding, handler, machine, environment) for binding in bound_in(handler, part)}


def bound_in(handler: Handler, part: ValuePart) -> tuple[Binding, ...]:
    """The event variables available in a part of a handler (docs/spec/machines.md#event-variables). A transition
    without an event has none."""
    if handler.trigger is None:
        return ()
    return tuple(binding for binding in handler.type.binds if binding.only in (None, part))


def event_variable(binding: Binding, handler: Handler, machine: Machine, environment: Environment) -> Type:
    if handler.trigger is None:
        return UNKNOWN
    match binding.name:
        case "_action":
            return Struct("", (("goal_id", GOAL_ID),), "goal handle", StructKind.HANDLER)
        case "_bt":
            return Struct("", (("status", STATUS),), "answer of the child", StructKind.HANDLER)
        case "_event":
            return Struct("", (("data", _event_data(handler, environment)),), "event", StructKind.HANDLER)
        case "_wrapped_result":
            part = interface_part(handler.trigger, find_handle(machine, handler), environment)
            return Struct("", (("code", STATUS), ("result", part)), "wrapped result", StructKind.HANDLER)
    return interface_part(handler.trigger, find_handle(machine, handler), environment)


def _event_data(handler: Handler, environment: Environment) -> Type:
    match handler.trigger:
        case ProtocolPart.CHILD_STATUS:
            return Struct("", (("status", STATUS),), "event data", StructKind.HANDLER)
        case ProtocolPart.THREAD_FREE:
            return Struct("", (("thread_id", GOAL_ID),), "event data", StructKind.HANDLER)
        case ProtocolPart.EVENT:
            data = environment.event_data(handler.event.value) if handler.event else None
            return UNKNOWN if data is None else data
    return Struct("", (), "event data", StructKind.HANDLER)


def section_of(part: ProtocolPart) -> str:
    """The name of the section of a ROS definition that contains the fields of `part`."""
    return "goal" if part is ProtocolPart.THREAD_START else part.value


INTERFACE_KINDS: Mapping[SymbolKind, Kind] = {
    SymbolKind.PUBLISHER: "msg",
    SymbolKind.SUBSCRIBER: "msg",
    SymbolKind.SERVICE_CLIENT: "srv",
    SymbolKind.SERVICE_SERVER: "srv",
    SymbolKind.ACTION_CLIENT: "action",
    SymbolKind.ACTION_SERVER: "action",
}

CHANNEL_KINDS: Mapping[SymbolKind, SymbolKind] = {
    SymbolKind.PUBLISHER: SymbolKind.TOPIC,
    SymbolKind.SUBSCRIBER: SymbolKind.TOPIC,
    SymbolKind.SERVICE_CLIENT: SymbolKind.SERVICE,
    SymbolKind.SERVICE_SERVER: SymbolKind.SERVICE,
    SymbolKind.ACTION_CLIENT: SymbolKind.ACTION,
    SymbolKind.ACTION_SERVER: SymbolKind.ACTION,
}
"""Kind of declaration -> the kind of channel that it uses."""


def find_handle(machine: Machine, user: Handler | RosSend) -> Declaration | None:
    """The declaration to which a handler or sending element refers; `None` if there is none. A declaration of the
    required kind takes precedence over other declarations with the same handle."""
    if user.handle is None:
        return None
    kinds = user.type.attributes["name"].refers
    named = machine.declarations_by_handle.get(user.handle.value, ())
    right = [d for d in named if d.kind in kinds]
    return right[0] if right else (named[0] if named else None)


def interface_part(part: ProtocolPart, declaration: Declaration | None, environment: Environment) -> Type:
    """The struct of the fields of `part` of the declared interface; `UNKNOWN` if it cannot be determined."""
    if declaration is None or declaration.type is None or declaration.kind not in INTERFACE_KINDS:
        return UNKNOWN
    interface = environment.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)
    section = section_of(part)
    own = dict(interface.parts).get(section, UNKNOWN) if interface else UNKNOWN
    if (
        declaration.kind is SymbolKind.SUBSCRIBER
        and isinstance(declaration.interface, Name)
        and isinstance(own, Struct)
    ):
        return _with_published(own, environment.published(declaration.interface.value))
    return own


def _with_published(own: Struct, published: tuple[InterfaceType, ...]) -> Struct:
    """The message of a subscriber with the fields of its own type and of the types that are published
    (docs/spec/ros.md#topics).

    If the types differ, a rule warns, but the fields of all types exist in the translation. If both types have a field
    with different types of values, it has the type that is published, because a published value is stored in it.
    """
    members = dict(own.members)
    sent = [part for other in published if isinstance(part := dict(other.parts).get("message", UNKNOWN), Struct)]
    for message in sent:
        for name, type_ in message.members:
            if name not in members or (own not in sent and not _same_leaves(members[name], type_)):
                members[name] = type_
    return own if members == dict(own.members) else replace(own, members=tuple(members.items()))


def _same_leaves(left: Type, right: Type) -> bool:
    """Whether all leaves of two fields have the same names and kinds."""
    mine, theirs = dict(leaves(left)), dict(leaves(right))
    return mine.keys() == theirs.keys() and all(same_kind(mine[path], theirs[path]) for path in mine)


def unset_fields(statement: RosSend, machine: Machine, environment: Environment) -> tuple[tuple[str, Type], ...]:
    """The dotted paths and types of the fields that a sending element should set but does not set.

    The translation sends these fields with the default values of ROS: 0, false or empty (docs/spec/files.md#dialects).
    In the current dialect, a rule reports them as errors.
    """
    interface = _interface_of(statement, machine, environment)
    if interface is None:
        return ()
    types, part = leaf_fields(statement, machine, environment), section_of(statement.part)
    given = {field.name.value for field in statement.fields if field.name}
    return tuple((path, types[path]) for path in interface.required(part) if path not in given)


def leaf_fields(statement: RosSend, machine: Machine, environment: Environment) -> dict[str, Type]:
    """The dotted paths of the leaf fields that a sending element can set, with their types in the ROS definition; empty
    if the definition is not known."""
    interface = _interface_of(statement, machine, environment)
    part = section_of(statement.part)
    return {".".join(path): type_ for path, type_ in leaves(interface.part(part))} if interface is not None else {}


def _interface_of(statement: RosSend, machine: Machine, environment: Environment) -> InterfaceType | None:
    """The interface whose fields a sending element sets; `None` if it is not known."""
    declaration = find_handle(machine, statement)
    if declaration is None or declaration.type is None or "field" not in statement.type.children:
        return None
    if declaration.kind not in statement.type.attributes["name"].refers:
        return None
    return environment.interface(INTERFACE_KINDS[declaration.kind], declaration.type.value)


# -------------------------------------------------------------------- the pass


class _Typer(Record, eq=False):
    machine: Machine
    environment: Environment
    values: list[TypedValue] = field(default_factory=list)
    variables: dict[str, dict[str, Type]] = field(default_factory=dict)
    taken_over: dict[Handler, list[TypedValue]] = field(default_factory=dict)

    def chart(self, chart: Chart) -> None:
        variables: dict[str, Type] = {}
        for data in chart.data:
            if data.id is not None:
                variables.setdefault(data.id.value, self.declared(data))
        self.variables[chart.scope] = variables
        place = ValuePlace(chart, None, None, ValuePart.DATA)
        for data in chart.data:
            self.data(data, place)
        for state in chart.states:
            checkpoint()
            for body, part in ((state.entry, ValuePart.ENTRY), (state.exit, ValuePart.EXIT)):
                if body is not None:
                    _Body(self, variables, {}, ValuePlace(chart, state, None, part)).run(body.statements)
            late = state.exit is not None and any(not isinstance(s, Assign) for s in state.exit.statements)
            for handler in state.handlers:
                self.handler(handler, chart, state, variables, late)

    def declared(self, data: Data) -> Type:
        if data.type is None or data.type.name is None:
            return UNKNOWN
        return resolve_type(data.type.name, self.environment.struct) or UNKNOWN

    def data(self, data: Data, place: ValuePlace) -> None:
        required = self.declared(data)
        target = data.id.value if data.id else ""
        for value, use in ((data.value, ValueUse.INITIAL), (data.lower, ValueUse.BOUND), (data.upper, ValueUse.BOUND)):
            if isinstance(value, Expression):
                check = check_bound if use is ValueUse.BOUND else check_initial
                problems = () if value.broken else check(value.tree, required)
                self.values.append(TypedValue(use, value, required, required, problems, data.element, place, target))
            elif value is not None:
                self.port(use, value, required, data.element, place, target)

    def port(
        self, use: ValueUse, value: PortRead, required: Type | None, element: Element, place: ValuePlace, target: str
    ) -> None:
        type_ = port_type(self.machine, value)
        self.values.append(TypedValue(use, value, type_, required, (), element, place, target, type_))

    def handler(self, handler: Handler, chart: Chart, state: State, variables: Mapping[str, Type], late: bool) -> None:
        if not handler.effective:
            return
        if handler in self.taken_over:
            self.values += self.taken_over[handler]
            return
        if handler.cond is not None:
            known = bindings(handler, ValuePart.COND, self.machine, self.environment)
            if "_bt" in known:
                known |= dict.fromkeys(STATUSES, STATUS)
            body = _Body(self, variables, known, ValuePlace(chart, state, handler, ValuePart.COND))
            body.value(ValueUse.CONDITION, handler.cond, BOOL, handler.element)
        known = bindings(handler, ValuePart.BODY, self.machine, self.environment)
        for target in handler.targets:
            _Body(self, variables, known, ValuePlace(chart, state, handler, ValuePart.BODY, late)).run(target.body)


GOAL_STATUSES = {4: "STATUS_SUCCEEDED", 5: "STATUS_CANCELED", 6: "STATUS_ABORTED"}
"""Code of a result -> its name in `action_msgs/GoalStatus` of ROS 2."""


def port_type(machine: Machine, read: PortRead) -> Type:
    for port in machine.ports:
        if port.key and read.key and port.key.value == read.key.value and port.type and port.type.name:
            return BASE_TYPES.get(port.type.name.base, UNKNOWN) if not port.type.name.dimensions else UNKNOWN
    return UNKNOWN


_SENT = (ValueUse.PARAMETER, ValueUse.FIELD, ValueUse.OUTPUT)


class _Body:
    """Determines the types in one sequence of statements, in the order of their execution."""

    def __init__(
        self, typer: _Typer, variables: Mapping[str, Type], known: Mapping[str, Type], place: ValuePlace
    ) -> None:
        self.typer = typer
        self.variables = variables
        self.known = known
        self.place = place

    def scope(self, name: str) -> Type | None:
        return self.known.get(name) or self.variables.get(name)

    def run(self, body: tuple[Statement, ...]) -> None:
        for statement in body:
            self.statement(statement)

    def statement(self, statement: Statement) -> None:
        match statement:
            case Assign():
                self.assign(statement)
                if self.draws(statement.value):
                    self.later()
                return
            case Send():
                for param in statement.params:
                    self.param(ValueUse.PARAMETER, param, None)
            case RosSend():
                self.communicate(statement)
            case SetOutput():
                self.output(statement)
            case If():
                self.choice(statement)
        self.later()

    def draws(self, value: Value | None) -> bool:
        """Whether the value whose type was determined last calls `Math.random()`."""
        problems = self.typer.values[-1].problems if isinstance(value, Expression) else ()
        return any(isinstance(problem, RandomUsed) for problem in problems)

    def later(self) -> None:
        if not self.place.late:
            self.place = replace(self.place, late=True)

    def value(
        self, use: ValueUse, value: Value | None, required: Type | None, element: Element, target: str = ""
    ) -> None:
        if isinstance(value, Expression):
            type_, problems = infer(value.tree, self.scope)
            if value.broken:
                type_ = UNKNOWN
            sent = type_
            if use in _SENT and any(isinstance(node, Number) and node.is_real for node in walk(value.tree)):
                sent, _ = infer(value.tree, self.scope, reprinted=True)
            self.typer.values.append(
                TypedValue(use, value, type_, required, problems, element, self.place, target, sent)
            )
        elif value is not None:
            self.typer.port(use, value, required, element, self.place, target)

    def assign(self, statement: Assign) -> None:
        required: Type | None = None
        target = ""
        if statement.location is not None:
            self.value(ValueUse.LOCATION, statement.location, None, statement.element)
            required, target = self.typer.values[-1].type, statement.location.text
        self.value(ValueUse.ASSIGNED, statement.value, required, statement.element, target)

    def param(self, use: ValueUse, param: Param, required: Type | None) -> None:
        self.late_value(use, param.value, required, param.element, param.name.value if param.name else "")

    def late_value(
        self, use: ValueUse, value: Value | None, required: Type | None, element: Element, target: str
    ) -> None:
        """Determine the type of a value that is sent. It is evaluated in the step that sends it, after the step in
        which the event arrived."""
        self.later()
        self.value(use, value, required, element, target)

    def communicate(self, statement: RosSend) -> None:
        declaration = find_handle(self.typer.machine, statement)
        part = interface_part(statement.part, declaration, self.typer.environment)
        for param in statement.fields:
            required = _leaf(part, param.name.value) if param.name else None
            self.param(ValueUse.FIELD, param, required)
        for expression, name in ((statement.goal_id, "goal_id"), (statement.thread_id, "thread_id")):
            self.late_value(ValueUse.ARGUMENT, expression, INT, statement.element, name)

    def output(self, statement: SetOutput) -> None:
        required = port_type(self.typer.machine, PortRead(statement.key, statement.element.span))
        target = statement.key.value if statement.key else ""
        self.late_value(ValueUse.OUTPUT, statement.value, required, statement.element, target)

    def choice(self, statement: If) -> None:
        """Determine the types in an `<if>`. Even its first condition is evaluated in a separate step, so the condition
        is late (see `ValuePlace`)."""
        before = self.place
        self.later()
        outer = known = self.place.branch_conditions
        for branch in statement.branches:
            self.value(ValueUse.BRANCH, branch.cond, BOOL, branch.element)
            holds = BranchConditions(branch.cond, True, known) if branch.cond else known
            self.place = replace(self.place, branch_conditions=holds)
            self.run(branch.body)
            known = BranchConditions(branch.cond, False, known) if branch.cond else known
            self.place = replace(self.place, branch_conditions=outer)
        if statement.otherwise is not None:
            self.place = replace(self.place, branch_conditions=known)
            self.run(statement.otherwise.body)
        self.place = replace(before, late=True)


def _leaf(part: Type, path: str) -> Type | None:
    """The type of the leaf field at a dotted path; `None` if the field does not exist, `UNKNOWN` if `part` is
    unknown."""
    type_ = part
    for name in path.split("."):
        member = member_type(type_, name)
        if member is None:
            return UNKNOWN if unwrap(type_)[0] == UNKNOWN else None
        type_ = member
    return type_
