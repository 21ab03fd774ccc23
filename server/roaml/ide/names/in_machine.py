# SPDX-License-Identifier: Apache-2.0
"""The names in a state machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Symbol
from roaml.expr.infer import infer
from roaml.expr.tree import (
    ArrayLiteral,
    Call,
    Expr,
    Index,
    Member,
    ObjectLiteral,
    walk,
)
from roaml.expr.tree import Name as NameExpr
from roaml.expr.types import BASE_TYPES, UNKNOWN, Array, Struct, StructKind, Type, resolve_type, unwrap
from roaml.ide.names.occurrence import Access, Occurrence, base_span, fields, parameter, variable, without_slash
from roaml.interfaces.registry import split_type_name
from roaml.interfaces.types import Kind
from roaml.language import HL_SCXML
from roaml.model.machine import (
    Assign,
    CallChild,
    Chart,
    Data,
    Declaration,
    Handler,
    If,
    Machine,
    ReturnStatus,
    RosSend,
    Send,
    SetOutput,
    Statement,
    bodies,
    statements,
)
from roaml.model.syntax import Expression, Name, PortRead, TypeRef, Value
from roaml.model.value_types import CHANNEL_KINDS, INTERFACE_KINDS, Environment, bindings, find_handle, interface_part
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import ProtocolPart, SymbolKind, ValuePart
from roaml.scxml.names import STATUSES, sanitise
from roaml.text import Span

_EVENT_VARIABLES = frozenset(binding.name for element in HL_SCXML.elements.values() for binding in element.binds)
_WORD = regex(r"\S+")


def interface_symbol(owner: str, kind: SymbolKind, name: str) -> Symbol:
    """The symbol of the topic, service or action `name` of a declaration of `kind`. The symbol of a topic contains its
    sanitised name."""
    channel_kind = CHANNEL_KINDS[kind]
    return Symbol(owner, channel_kind, sanitise(name) if channel_kind is SymbolKind.TOPIC else name)


def is_implicit(declaration: Declaration) -> bool:
    """Whether a declaration lacks the attribute `name`, so that the name of the interface is used as the handle."""
    return declaration.handle is not None and declaration.handle is declaration.interface


def in_machine(
    text: str,
    machine: Machine,
    path: str,
    owner: str,
    types: Mapping[str, Mapping[str, Type]],
    environment: Environment,
) -> Iterator[Occurrence]:
    """The occurrences of names in a state machine.

    Args:
        owner: the system file, or the machine's own file if it is analysed alone.
        types: the types of the variables, by the scope of their chart.
        environment: the types that other files of the system declare.
    """
    return _Machine(text, machine, path, owner, types, environment).all()


class _Machine(Record, frozen=True):
    """Finds the occurrences in a machine. The attributes are the arguments of `in_machine`."""

    text: str
    machine: Machine
    path: str
    owner: str
    types: Mapping[str, Mapping[str, Type]]
    environment: Environment

    def all(self) -> Iterator[Occurrence]:
        machine = self.machine
        if machine.name:
            yield Occurrence(machine.name.span, Symbol(self.path, SymbolKind.MACHINE, machine.name.value), defines=True)
        for port in machine.ports:
            yield from self.port(port.key, Access.TEXT, defines=True)
        for declaration in machine.declarations:
            yield from self.declaration(declaration)
        for thread in machine.threads:
            servers = [d for d in machine.declarations if d.kind is SymbolKind.ACTION_SERVER]
            yield from self.handle(thread.server, _named(servers, thread.server))
        for chart in machine.charts:
            yield from self.chart(chart)

    # ---------------------------------------------------------- declarations

    def declaration(self, declaration: Declaration) -> Iterator[Occurrence]:
        if declaration.handle is not None and not is_implicit(declaration):
            symbol = Symbol(self.path, declaration.kind, declaration.handle.value)
            yield Occurrence(declaration.handle.span, symbol, defines=True)
        if isinstance(declaration.rate, PortRead):
            yield from self.port(declaration.rate.key, Access.READ)
        if isinstance(declaration.interface, PortRead):
            yield from self.port(declaration.interface.key, Access.READ)
        elif declaration.interface is not None:
            yield from self.interface(declaration.interface, declaration, defines=True)
        if declaration.type is not None and declaration.kind in INTERFACE_KINDS:
            kind: Kind = INTERFACE_KINDS[declaration.kind]
            names = split_type_name(declaration.type.value, kind)
            if names is not None:
                yield Occurrence(declaration.type.span, Symbol("", SymbolKind.ROS_TYPE, "/".join(names), kind))

    def interface(self, name: Name, declaration: Declaration, *, defines: bool = False) -> Iterator[Occurrence]:
        symbol = interface_symbol(self.owner, declaration.kind, name.value)
        is_source = declaration.kind in (SymbolKind.PUBLISHER, SymbolKind.SERVICE_SERVER, SymbolKind.ACTION_SERVER)
        span = without_slash(name) if symbol.kind is SymbolKind.TOPIC else name.span
        yield Occurrence(span, symbol, defines and is_source)

    def handle(
        self, name: Name | None, declaration: Declaration | None, access: Access = Access.TEXT
    ) -> Iterator[Occurrence]:
        """The occurrence of a handle. If the name of the interface is used as the handle, it is an occurrence of the
        interface."""
        if name is None or declaration is None:
            return
        if is_implicit(declaration):
            for part in self.interface(name, declaration):
                yield Occurrence(part.span, part.symbol, access=access)
        else:
            yield Occurrence(name.span, Symbol(self.path, declaration.kind, name.value), access=access)

    def port(self, key: Name | None, access: Access, *, defines: bool = False) -> Iterator[Occurrence]:
        if key is not None:
            yield Occurrence(key.span, Symbol(self.path, SymbolKind.PORT, key.value), defines, access)

    # ---------------------------------------------------------------- charts

    def chart(self, chart: Chart) -> Iterator[Occurrence]:
        yield from self.state(chart, chart.initial)
        for data in chart.data:
            yield from self.data(chart, data)
        for state in chart.states:
            yield from self.state(chart, state.id, defines=True)
            for handler in state.handlers:
                yield from self.handler(chart, handler)
        for _, owner, body in bodies(chart):
            known = bindings(owner, ValuePart.BODY, self.machine, self.environment) if owner else {}
            for statement in statements(body):
                yield from self.statement(_Scope(self, chart, owner, known), statement)

    def state(self, chart: Chart, name: Name | None, *, defines: bool = False) -> Iterator[Occurrence]:
        if name is not None:
            yield Occurrence(name.span, Symbol(self.path, SymbolKind.STATE, name.value, chart.scope), defines)

    def data(self, chart: Chart, data: Data) -> Iterator[Occurrence]:
        if data.id is not None:
            symbol = variable(self.path, data.id.value, chart.scope)
            yield Occurrence(data.id.span, symbol, defines=True, access=Access.WRITE)
            if data.comment_type and data.type is not None:
                # `TYPE id:type` in a comment: the id directly precedes the type.
                start = self.text.rfind(data.id.value, 0, data.type.span.start)
                yield Occurrence(Span(start, start + len(data.id.value)), symbol)
        yield from type_use(self.owner, data.type)
        required_type: Type = UNKNOWN
        if data.type is not None and data.type.name is not None:
            required_type = resolve_type(data.type.name, self.environment.struct) or UNKNOWN
        scope = _Scope(self, chart, None, {})
        for value in (data.value, data.lower, data.upper):
            yield from self.value(scope, value)
            if isinstance(value, Expression):
                yield from self.keys(value.tree, required_type)

    def keys(self, expr: Expr, required_type: Type) -> Iterator[Occurrence]:
        """The occurrences of members in an initial value."""
        if isinstance(expr, ArrayLiteral) and isinstance(required_type, Array):
            for element in expr.elements:
                yield from self.keys(element, required_type.element)
        if isinstance(expr, ObjectLiteral) and isinstance(required_type, Struct):
            for member in expr.members:
                lead = self.text[member.key_span.start : member.key_span.end].find(member.key)
                type_ = required_type.member(member.key)
                if type_ is not None and lead >= 0:
                    start = member.key_span.start + lead
                    symbol = Symbol(self.owner, SymbolKind.MEMBER, member.key, required_type.name)
                    yield Occurrence(Span(start, start + len(member.key)), symbol, access=Access.WRITE)
                    yield from self.keys(member.value, type_)

    def handler(self, chart: Chart, handler: Handler) -> Iterator[Occurrence]:
        if handler.trigger is ProtocolPart.EVENT and handler.event is not None:
            yield from self.events(handler.event)
        yield from self.handle(handler.handle, find_handle(self.machine, handler), Access.READ)
        for target in handler.targets:
            yield from self.state(chart, target.state)
        yield from self.word(_Scope(self, chart, handler, {}), handler.child)
        if handler.cond is not None:
            known = bindings(handler, ValuePart.COND, self.machine, self.environment)
            yield from _Scope(self, chart, handler, known).names(handler.cond)

    def events(self, written: Name) -> Iterator[Occurrence]:
        if "*" in written.value or len(written.value) != written.span.end - written.span.start:
            return
        for word in _WORD.finditer(written.value):
            span = Span(written.span.start + word.start(), written.span.start + word.end())
            yield Occurrence(span, Symbol(self.owner, SymbolKind.EVENT, word[0]), access=Access.READ)

    # ------------------------------------------------------------ statements

    def statement(self, scope: _Scope, statement: Statement) -> Iterator[Occurrence]:
        match statement:
            case Assign():
                if statement.location is not None:
                    yield from scope.names(statement.location, written=True)
                yield from self.value(scope, statement.value)
            case Send():
                yield from self.send(scope, statement)
            case If():
                for branch in statement.branches:
                    if branch.cond is not None:
                        yield from scope.names(branch.cond)
            case RosSend():
                yield from self.ros_send(scope, statement)
            case ReturnStatus():
                if statement.status is not None and statement.status.value not in STATUSES:
                    yield from self.word(scope, statement.status)
            case CallChild():
                yield from self.word(scope, statement.child)
            case SetOutput():
                yield from self.port(statement.key, Access.WRITE)
                yield from self.value(scope, statement.value)
            case _:
                pass

    def send(self, scope: _Scope, send: Send) -> Iterator[Occurrence]:
        if send.event is not None:
            symbol = Symbol(self.owner, SymbolKind.EVENT, send.event.value)
            yield Occurrence(send.event.span, symbol, defines=True, access=Access.WRITE)
        for param in send.params:
            if param.name is not None and send.event is not None:
                symbol = parameter(self.owner, send.event.value, param.name.value)
                yield Occurrence(param.name.span, symbol, defines=True, access=Access.WRITE)
            yield from self.value(scope, param.value)

    def ros_send(self, scope: _Scope, statement: RosSend) -> Iterator[Occurrence]:
        declaration = find_handle(self.machine, statement)
        yield from self.handle(statement.handle, declaration, Access.WRITE)
        part = interface_part(statement.part, declaration, self.environment)
        for field in statement.fields:
            if field.name is not None:
                yield from fields(field.name, part, Access.WRITE)
            yield from self.value(scope, field.value)
        for argument in (statement.goal_id, statement.thread_id):
            yield from self.value(scope, argument)

    def word(self, scope: _Scope, name: Name | None) -> Iterator[Occurrence]:
        """The occurrence of a variable in text that is a number or the name of a variable."""
        if name is not None and not name.value.lstrip("+-").isdigit():
            symbol = variable(self.path, name.value, scope.chart.scope)
            yield Occurrence(name.span, symbol, access=Access.READ)

    def value(self, scope: _Scope, value: Value | None) -> Iterator[Occurrence]:
        if isinstance(value, PortRead):
            yield from self.port(value.key, Access.READ)
        elif value is not None:
            yield from scope.names(value)


class _Scope:
    """The scope of an expression: the meaning of its names. `known` are the event variables with their types."""

    def __init__(self, machine: _Machine, chart: Chart, handler: Handler | None, known: Mapping[str, Type]) -> None:
        self.machine = machine
        self.chart = chart
        self.handler = handler
        self.known = known
        self.variables = machine.types.get(chart.scope, {})

    def names(self, expression: Expression, *, written: bool = False) -> Iterator[Occurrence]:
        target = _base(expression.tree) if written else None
        nodes = walk(expression.tree)
        called = [node.function for node in nodes if isinstance(node, Call)]
        for node in nodes:
            if isinstance(node, NameExpr):
                if node.name not in self.variables and any(node is function for function in called):
                    continue  # a distribution
                yield from self.name(node, Access.WRITE if node is target else Access.READ)
            elif isinstance(node, Member) and node.name:
                yield from self.member(node, Access.WRITE if written and target else Access.READ)

    def name(self, node: NameExpr, access: Access) -> Iterator[Occurrence]:
        declared = node.name in self.variables
        if node.name in self.known or (not declared and (node.name in _EVENT_VARIABLES or node.name == "Math")):
            return
        if "_bt" in self.known and node.name in STATUSES:
            return
        yield Occurrence(node.span, variable(self.machine.path, node.name, self.chart.scope), access=access)

    def member(self, node: Member, access: Access) -> Iterator[Occurrence]:
        event = self.handler.event if self.handler and self.handler.trigger is ProtocolPart.EVENT else None
        if event is not None and _is_event_data(node.object) and "_event" in self.known:
            symbol = parameter(self.machine.owner, event.value, node.name)
            yield Occurrence(node.name_span, symbol, access=Access.READ)
            return
        inner, _ = unwrap(infer(node.object, self.type_of_name)[0])
        if not isinstance(inner, Struct) or inner.member(node.name) is None:
            return
        if inner.kind is StructKind.DECLARED:
            yield Occurrence(
                node.name_span, Symbol(self.machine.owner, SymbolKind.MEMBER, node.name, inner.name), access=access
            )
        elif inner.name:
            yield Occurrence(node.name_span, Symbol("", SymbolKind.FIELD, node.name, inner.name), access=Access.READ)

    def type_of_name(self, name: str) -> Type | None:
        return self.known.get(name) or self.variables.get(name)


def type_use(owner: str, type_: TypeRef | None) -> Iterator[Occurrence]:
    """The occurrence of a struct in the name of a type."""
    if type_ is not None and type_.name is not None and type_.name.base not in BASE_TYPES:
        yield Occurrence(base_span(type_.span, type_.name.base), Symbol(owner, SymbolKind.STRUCT, type_.name.base))


def _base(expr: Expr) -> Expr:
    """The name at the beginning of a location."""
    while isinstance(expr, (Member, Index)):
        expr = expr.object
    return expr


def _is_event_data(expr: Expr) -> bool:
    match expr:
        case Member(object=NameExpr(name="_event"), name="data"):
            return True
    return False


def _named(declarations: list[Declaration], name: Name | None) -> Declaration | None:
    if name is None:
        return None
    return next((d for d in declarations if d.handle and d.handle.value == name.value), None)
