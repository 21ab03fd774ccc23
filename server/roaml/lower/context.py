# SPDX-License-Identifier: Apache-2.0
"""The context in which a chart is lowered: its place in the system, and the names that it can use."""

from __future__ import annotations

from collections.abc import Mapping

from roaml.expr.parse import parse
from roaml.expr.tree import Boolean, Expr, String
from roaml.expr.types import STRING, UNKNOWN, ScalarKind, Type, is_kind, resolve_type
from roaml.lower.data import as_type
from roaml.lower.expressions import LoweringScope
from roaml.lower.program import TranslatableSystem
from roaml.model.expand import PortConstant, PortValue, Reference
from roaml.model.machine import Chart, Data, Declaration, Handler, Machine, RosSend
from roaml.model.outline import InterfaceUse
from roaml.model.syntax import PortRead
from roaml.model.system import Channel, SystemAutomaton
from roaml.model.value_types import bindings, find_handle, port_type
from roaml.record import Record
from roaml.roles import SymbolKind, ValuePart
from roaml.scxml.events import ScxmlEvent
from roaml.text import Decoded, Location, Span


class LoweringContext(Record, frozen=True, eq=False):
    """The context in which a chart is lowered.

    Attributes:
        name: the name of the plain automaton.
        thread: the number of the copy of an action thread; `None` for the machine itself.
        timers: handle of a timer -> the event of its ticks for this chart.
        ports: port that the tree does not set -> its value.
        variables: variable of the chart -> its type.
    """

    program: TranslatableSystem
    automaton: SystemAutomaton
    machine: Machine
    chart: Chart
    name: str
    thread: int | None
    timers: Mapping[str, ScxmlEvent]
    ports: Mapping[str, str]
    variables: Mapping[str, Type]

    def origin(self, span: Span) -> Location:
        """The location of `span` in the file of the machine. A node of BehaviorTree.CPP has no file, so its location is
        the node in the tree."""
        if self.automaton.path:
            return Location(self.automaton.path, span)
        return self.program.place_of(self.automaton)

    @property
    def tree(self) -> str:
        """The name of the tree that contains the automaton; "" if it has none."""
        return self.automaton.instance.tree if self.automaton.instance is not None else ""

    def scope(self, handler: Handler | None = None, part: ValuePart = ValuePart.BODY) -> LoweringScope:
        """The names that can be used in `part` of a handler, its condition or its body; without a handler, those in
        `<onentry>` and `<onexit>`."""
        if handler is None:
            return LoweringScope(self.variables, {}, {})
        return LoweringScope(self.variables, bindings(handler, part, self.machine, self.program.environment), {})

    def port(self, read: PortRead) -> PortValue:
        """The value of a port. A port that is not set has the value ""; a rule reports it."""
        key = read.key.value if read.key else ""
        value = self.automaton.port(key)
        return PortConstant(self.ports.get(key, "")) if value is None else value

    def constant(self, read: PortRead, value: PortConstant) -> Expr:
        """The literal for a port with a constant value."""
        return literal(value.text, port_type(self.machine, read), read.span)

    def is_reference(self, value: object) -> bool:
        return isinstance(value, PortRead) and isinstance(self.port(value), Reference)

    def use(self, user: Handler | RosSend) -> InterfaceUse:
        """The outline of the declaration that a handler or sending element refers to."""
        declaration = find_handle(self.machine, user)
        assert declaration is not None
        return self.use_of(declaration)

    def use_of(self, declaration: Declaration) -> InterfaceUse:
        declared = [d for d in self.machine.declarations if d.kind is not SymbolKind.TIMER]
        return self.automaton.outline.interfaces[declared.index(declaration)]

    def channel(self, user: Handler | RosSend) -> Channel:
        channel = self.program.system.channel(self.automaton, self.use(user))
        assert channel is not None
        return channel


def variables_of(chart: Chart, program: TranslatableSystem) -> dict[str, Type]:
    """Variable of a chart -> its type; if ids are equal, the first declaration is used."""
    types: dict[str, Type] = {}
    for data in chart.data:
        if data.id is not None:
            types.setdefault(data.id.value, type_of(data, program))
    return types


def type_of(data: Data, program: TranslatableSystem) -> Type:
    name = data.type.name if data.type else None
    return (resolve_type(name, program.environment.struct) if name else None) or UNKNOWN


def literal(text: str, type_: Type, span: Span) -> Expr:
    """The text of a port as a value of its type. Strings have no quotes (docs/spec/trees.md#port-values)."""
    if type_ in (STRING, UNKNOWN):
        return String(span, text)
    if is_kind(type_, ScalarKind.BOOL):
        return Boolean(span, text.strip() == "true")
    tree, _ = parse(Decoded(text, span.start))
    return as_type(tree, type_)
