# SPDX-License-Identifier: Apache-2.0
"""Fields whose values are the constants of their interface, and the variables that hold them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction

from roaml.expr.infer import constant
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, walk
from roaml.interfaces.registry import NotFound
from roaml.model.machine import Assign, Chart, Declaration, Handler, bodies, statements
from roaml.model.ros import Enumeration
from roaml.model.syntax import Expression
from roaml.model.value_types import INTERFACE_KINDS, find_handle, section_of
from roaml.model.values.analyse import DataChannel, data_place
from roaml.model.values.evaluate import place_of
from roaml.record import Record
from roaml.roles import ProtocolPart
from roaml.rules.rule import MachineContext, listing
from roaml.rules.support.constant_conditions import ConstantPart
from roaml.text import Span


class Enumerated(Record, frozen=True):
    """A field with its constants: the name of its interface, and the values that machines send besides."""

    field: str
    interface: str
    constants: Enumeration
    others: frozenset[float] = frozenset()

    def has(self, number: float | Fraction) -> bool:
        return number in self.others or any(number == value for _, value in self.constants)

    @property
    def described(self) -> str:
        values = listing([f"{name}={value}" for name, value in self.constants])
        return f"the constants of `{self.field}` in `{self.interface}` are {values}"


def enumerations(context: MachineContext, declaration: Declaration, part: ProtocolPart) -> dict[str, Enumerated]:
    """The enumerated fields of what arrives at, or is sent through, a declaration."""
    kind, type_ = INTERFACE_KINDS.get(declaration.kind), declaration.type
    found = context.interface(kind, type_.value) if kind is not None and type_ is not None else None
    if found is None or isinstance(found, NotFound):
        return {}
    section = section_of(part)
    return {f: Enumerated(f, found.name, values) for name, f, values in found.enumerations if name == section}


def never_named(context: MachineContext, reported: Collection[Span]) -> Iterator[ConstantPart]:
    """The comparisons of a field, or of a variable that only holds it, with a number that no constant of the field
    has."""
    arriving = {
        handler: _arriving(context, handler)
        for chart in context.machine.charts
        for state in chart.states
        for handler in state.handlers
    }
    if not any(arriving.values()):
        return
    for value in context.typed.values:
        tree = value.value.tree if isinstance(value.value, Expression) and not value.value.broken else None
        if tree is None or value.value.span in reported:
            continue
        chart = value.place.chart
        known = _held(chart, arriving) | (arriving.get(value.place.handler, {}) if value.place.handler else {})
        for node in walk(tree) if known else ():
            if isinstance(node, Binary) and node.operator in _EQUALITY and node.span not in reported:
                yield from _compared(node, known)


_EQUALITY = {Operator.EQUAL: "never", Operator.NOT_EQUAL: "always"}


def _compared(node: Binary, known: Mapping[str, Enumerated]) -> Iterator[ConstantPart]:
    for side, other in ((node.left, node.right), (node.right, node.left)):
        place = place_of(side)
        number = constant(other)
        if place is not None and place in known and number is not None and not known[place].has(number):
            message = f"this comparison is {_EQUALITY[node.operator]} true: {known[place].described}"
            yield ConstantPart(node.span, message)


def _arriving(context: MachineContext, handler: Handler) -> dict[str, Enumerated]:
    """Place -> the enumerated field that a handler receives there."""
    declaration = find_handle(context.machine, handler) if handler.trigger is not None else None
    prefix = data_place(handler.trigger) if handler.trigger is not None else None
    if declaration is None or handler.trigger is None or not prefix:
        return {}
    handle = declaration.handle.value if declaration.handle is not None else ""
    sent = context.values.arriving.get(DataChannel(handler.trigger, handle), {})
    fields = {}
    for name, field in enumerations(context, declaration, handler.trigger).items():
        known = sent[name].only if name in sent else None
        others = frozenset(v for v in known or () if isinstance(v, int | float) and not isinstance(v, bool))
        fields[f"{prefix}.{name}"] = Enumerated(field.field, field.interface, field.constants, others)
    return fields


def _held(chart: Chart, arriving: Mapping[Handler, Mapping[str, Enumerated]]) -> dict[str, Enumerated]:
    """The variables to which all assignments store the same enumerated field, or constants."""
    given: dict[str, list[Enumerated | None]] = {}
    numbers: dict[str, set[float]] = {}
    for _, handler, body in bodies(chart):
        for statement in statements(body):
            name = place_of(statement.location.tree) if isinstance(statement, Assign) and statement.location else None
            if name is None or not isinstance(statement, Assign):
                continue
            tree = statement.value.tree if isinstance(statement.value, Expression) else None
            number = constant(tree) if tree is not None else None
            if number is not None:
                numbers.setdefault(name, set()).add(number)
            else:
                place = place_of(tree) if tree is not None else None
                field = arriving[handler].get(place) if handler is not None and place is not None else None
                given.setdefault(name, []).append(field)
    for data in chart.data:
        begin = constant(data.value.tree) if isinstance(data.value, Expression) else None
        if data.id is not None and begin is not None:
            numbers.setdefault(data.id.value, set()).add(begin)
    return {
        name: Enumerated(first.field, first.interface, first.constants, first.others | frozenset(numbers.get(name, ())))
        for name, fields in given.items()
        if (first := fields[0]) is not None and all(field == first for field in fields)
    }
