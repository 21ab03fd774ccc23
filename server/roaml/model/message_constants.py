# SPDX-License-Identifier: Apache-2.0
"""The constants that machines send in fields of messages, requests and goals, and those with which the receivers
compare the fields. Where the sender sends one constant that nothing expects, instead of one that is expected, it is
probably wrong.

Also the constants with a number in machines whose names contain one, such as the text `'door_2'` and the 2 that
`CloseDoor2` sends in the field `door`. Machines that are copies of each other have them at the same places.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from roaml.expr.infer import constant, constant_fraction
from roaml.expr.operators import Operator
from roaml.expr.tree import Binary, Expr, Member, String, walk
from roaml.expr.tree import Name as NameExpr
from roaml.model.machine import Assign, Chart, Handler, If, Machine, Param, RosSend, Send, Statement, bodies, statements
from roaml.model.syntax import Expression, PortRead
from roaml.model.value_types import TypedMachine, TypedValue, ValueUse, find_handle
from roaml.model.waits import fixed_variables
from roaml.record import Record
from roaml.regex import regex
from roaml.roles import ProtocolPart

_DATA = {ProtocolPart.MESSAGE: "_msg.", ProtocolPart.REQUEST: "_req.", ProtocolPart.GOAL: "_goal."}


class MessageField(NamedTuple):
    """A field of what arrives at, or is sent through, the declaration `handle`."""

    part: ProtocolPart
    handle: str
    path: str


class FieldChoice(Record, frozen=True):
    """A machine compares a field with `constants`, uses it for nothing else, and does nothing with other values."""

    field: MessageField
    constants: frozenset[Fraction]


class SentConstants(Record, frozen=True):
    """The constants that a machine sends in a field: `constants`, and those to which the tree sets `ports`. It sends
    nothing else if `complete`."""

    field: MessageField
    constants: frozenset[Fraction]
    ports: frozenset[str]
    complete: bool


# ------------------------------------------------------------------ receivers


def field_choices(machine: Machine, typed: TypedMachine) -> tuple[FieldChoice, ...]:
    handlers = (handler for chart in machine.charts for state in chart.states for handler in state.handlers)
    if not any(handler.trigger in _DATA for handler in handlers):
        return ()
    uses = _Uses(machine)
    for value in typed.values:
        if isinstance(value.value, Expression) and value.use is not ValueUse.LOCATION:
            uses.add(value, value.value.tree)
    for chart in machine.charts:
        uses.others |= set(_with_default(machine, chart))
    acted = set(_acted_on(machine, uses.readers))
    return tuple(choice for choice in uses.choices() if (choice.field.part, choice.field.handle) not in acted)


class _Uses:
    """The uses of fields and of the variables that hold them. A variable is a field without a part."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.assigned = {
            statement.element: statement.location.tree.name
            for chart in machine.charts
            for statement in chart.statements
            if isinstance(statement, Assign) and statement.location is not None
            if isinstance(statement.location.tree, NameExpr)
        }
        self.compared: dict[object, set[Fraction]] = {}
        self.held: dict[object, set[MessageField]] = {}
        self.others: set[object] = set()
        self.readers: set[Handler] = set()
        """The handlers that read a field of what they handle."""

    def add(self, value: TypedValue, tree: Expr) -> None:
        inner = {id(node.object) for node in walk(tree) if isinstance(node, Member)}
        known: set[int] = set()
        for node in walk(tree):
            if isinstance(node, Binary) and node.operator is Operator.EQUAL:
                for side, other in ((node.left, node.right), (node.right, node.left)):
                    number = constant_fraction(other)
                    if number is not None:
                        known.add(id(side))
                        key = _key(self.machine, value, side)
                        self.compared.setdefault(key, set()).add(number)
                        if isinstance(key, MessageField) and value.place.handler is not None:
                            self.readers.add(value.place.handler)
        for node in walk(tree):
            if not isinstance(node, NameExpr | Member) or id(node) in inner or id(node) in known:
                continue
            key = _key(self.machine, value, node)
            if isinstance(key, MessageField) and value.place.handler is not None:
                self.readers.add(value.place.handler)
            target = self.assigned.get(value.element) if node is tree and value.use is ValueUse.ASSIGNED else None
            if target is not None and isinstance(key, MessageField):
                self.held.setdefault((value.place.chart.scope, target), set()).add(key)
            else:
                self.others.add(key)

    def choices(self) -> Iterator[FieldChoice]:
        fields: dict[MessageField, set[Fraction]] = {}
        opaque = {key for key in self.others if isinstance(key, MessageField)}
        for key, numbers in self.compared.items():
            if isinstance(key, MessageField):
                fields.setdefault(key, set()).update(numbers)
        for variable, held in self.held.items():
            for field in held:
                if variable in self.others or len(held) > 1:
                    opaque.add(field)
                else:
                    fields.setdefault(field, set()).update(self.compared.get(variable, ()))
        for field, numbers in fields.items():
            if numbers and field not in opaque:
                yield FieldChoice(field, frozenset(numbers))


def _key(machine: Machine, value: TypedValue, node: Expr) -> object:
    """The field that a node reads, or its chart and the name of its variable."""
    names: list[str] = []
    while isinstance(node, Member):
        names.append(node.name)
        node = node.object
    root = node.name if isinstance(node, NameExpr) else ""
    handler = value.place.handler
    if names and handler is not None and handler.trigger is not None and _DATA.get(handler.trigger) == f"{root}.":
        declaration = find_handle(machine, handler)
        if declaration is not None and declaration.handle is not None:
            return MessageField(handler.trigger, declaration.handle.value, ".".join(reversed(names)))
    return (value.place.chart.scope, root)


def _with_default(machine: Machine, chart: Chart) -> Iterator[object]:
    """The fields and variables for whose other values a machine does something, too."""
    for _, handler, body in bodies(chart):
        for statement in statements(body):
            if isinstance(statement, If) and statement.otherwise is not None:
                for branch in statement.branches:
                    yield from _named(machine, chart, handler, branch.cond)
    for state in chart.states:
        unconditional = {
            (handler.trigger, find_handle(machine, handler)) for handler in state.handlers if handler.cond is None
        }
        for handler in state.handlers:
            if (handler.trigger, find_handle(machine, handler)) in unconditional:
                yield from _named(machine, chart, handler, handler.cond)


def _acted_on(machine: Machine, readers: Collection[Handler]) -> Iterator[tuple[ProtocolPart, str]]:
    """The part and handle of what a state handles without a condition: it does something, whatever the fields are."""
    for chart in machine.charts:
        for state in chart.states:
            for handler in state.handlers:
                if handler.cond is not None or handler in readers or handler.trigger not in _DATA:
                    continue
                declaration = find_handle(machine, handler)
                own = state.id.value if state.id is not None else ""
                leaves = any(target.state is not None and target.state.value != own for target in handler.targets)
                if declaration is None or declaration.handle is None or handler.trigger is None:
                    continue
                if leaves or any(target.body for target in handler.targets):
                    yield handler.trigger, declaration.handle.value


def _named(machine: Machine, chart: Chart, handler: Handler | None, cond: Expression | None) -> Iterator[object]:
    """The fields of the event of a handler, and the variables, in a condition."""
    declaration = find_handle(machine, handler) if handler is not None and handler.trigger in _DATA else None
    handle = declaration.handle.value if declaration is not None and declaration.handle is not None else ""
    for node in walk(cond.tree) if cond is not None else ():
        if isinstance(node, NameExpr):
            yield (chart.scope, node.name)
        elif isinstance(node, Member) and handler is not None and handler.trigger is not None:
            yield MessageField(handler.trigger, handle, _path(node))


def _path(node: Expr) -> str:
    names: list[str] = []
    while isinstance(node, Member):
        names.append(node.name)
        node = node.object
    return ".".join(reversed(names))


# -------------------------------------------------------------------- senders


def sent_constants(machine: Machine) -> tuple[SentConstants, ...]:
    sent: dict[MessageField, list[tuple[Fraction | None, str]]] = {}
    for chart in machine.charts:
        fixed = fixed_variables(chart)
        for statement in chart.executed:
            for field, param in sent_fields(machine, statement):
                sent.setdefault(field, []).append(_constant(param, fixed))
    return tuple(
        SentConstants(
            field,
            frozenset(number for number, _ in values if number is not None),
            frozenset(port for _, port in values if port),
            all(number is not None or port for number, port in values),
        )
        for field, values in sent.items()
    )


def sent_fields(machine: Machine, statement: Statement) -> Iterator[tuple[MessageField, Param]]:
    """The fields of messages, requests and goals that a statement sends."""
    if isinstance(statement, RosSend) and statement.part in _DATA:
        declaration = find_handle(machine, statement)
        if declaration is not None and declaration.handle is not None:
            for param in statement.fields:
                if param.name is not None:
                    yield MessageField(statement.part, declaration.handle.value, param.name.value), param


def constant_of(param: Param, fixed: Mapping[str, PortRead | Fraction]) -> Fraction | None:
    """The constant that a field contains, also as the value of a variable that never changes; `None` if there is none.

    Args:
        fixed: the result of `fixed_variables`.
    """
    return _constant(param, fixed)[0]


def _constant(param: Param, fixed: Mapping[str, PortRead | Fraction]) -> tuple[Fraction | None, str]:
    """The constant that a field contains, and the port whose value it contains; `None` and "" if there is none."""
    value = param.value
    held: object = value
    if isinstance(value, Expression) and isinstance(value.tree, NameExpr):
        held = fixed.get(value.tree.name)
    if isinstance(held, PortRead):
        return None, held.key.value if held.key else ""
    if isinstance(held, Fraction):
        return held, ""
    return (constant_fraction(value.tree) if isinstance(value, Expression) else None), ""


def unexpected(sent: Iterable[Fraction], expected: frozenset[Fraction]) -> tuple[Fraction, Fraction] | None:
    """The only constant that is sent and not expected, and the only one that is expected and never sent. `None` if
    there are several or none, or if the expected constants are not successive, so that the receiver may be wrong. A
    smaller constant than those that are expected, such as 0 or -1, usually means that there is nothing to do."""
    known = frozenset(sent)
    surplus, missing = known - expected, expected - known
    if len(surplus) != 1 or len(missing) != 1 or len(expected) < 3 or not _is_regular(expected):
        return None
    return (next(iter(surplus)), next(iter(missing))) if max(surplus) > max(expected) else None


def _is_regular(numbers: frozenset[Fraction]) -> bool:
    """Whether the numbers are successive."""
    return max(numbers) - min(numbers) == len(numbers) - 1


# ---------------------------------------------------- machines with numbers

_NUMBER = regex(r"\d+")


class NumberedConstant(Record, frozen=True):
    """A constant with a number.

    Attributes:
        field: the name of the field that gets the number; "" for a text.
        text: the text with `#` for its number; "" for a field.
    """

    field: str
    text: str
    number: str


def numbered_constants(machine: Machine, typed: TypedMachine) -> Iterator[tuple[NumberedConstant, Expr]]:
    """The texts with one number, and the fields that get a number, in a machine whose name contains a number."""
    if machine.name is None or not _NUMBER.search(machine.name.value):
        return
    for tree in (v.value.tree for v in typed.values if isinstance(v.value, Expression) and not v.value.broken):
        for node in walk(tree):
            if isinstance(node, String) and len(numbers := _NUMBER.findall(node.value)) == 1:
                yield NumberedConstant("", _NUMBER.sub("#", node.value), numbers[0]), node
    for param in _params(machine):
        if param.name is not None and isinstance(param.value, Expression) and not param.value.broken:
            number = constant(param.value.tree)
            if number is not None:
                yield NumberedConstant(param.name.value, "", str(number)), param.value.tree


# ------------------------------------------------------------ named constants


class NamedConstant(NamedTuple):
    """A variable in upper case that always has the same integer, such as `SKILL_SUCCESS`."""

    name: str
    number: int


def named_constants(chart: Chart) -> Iterator[NamedConstant]:
    if any(data.id is not None and data.id.value.isupper() for data in chart.data):
        for name, number in fixed_variables(chart).items():
            if name.isupper() and isinstance(number, Fraction) and number.denominator == 1:
                yield NamedConstant(name, int(number))


def _params(machine: Machine) -> Iterator[Param]:
    for chart in machine.charts:
        for statement in chart.statements:
            match statement:
                case Send(params=params) | RosSend(fields=params):
                    yield from params
