# SPDX-License-Identifier: Apache-2.0
"""Converts a property in JANI to a property in XML, with the ports whose variables it uses."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from xml.sax.saxutils import escape, quoteattr

from roaml.durations import NANOSECONDS
from roaml.expr.format import format_expr
from roaml.expr.operators import Operator, UnaryOperator
from roaml.expr.tree import Binary, Boolean, Expr, Name, Number, Unary
from roaml.expr.types import BASE_TYPES, Scalar, ScalarKind, Type, leaves
from roaml.ide.new_property import port_tags
from roaml.ide.property_conversion.forms import PatternForm, needs_first, operands
from roaml.ide.property_conversion.to_jani import NotConvertibleError
from roaml.jani import expressions as jani
from roaml.jani.expressions import Expression
from roaml.jani.operators import BinaryOperator
from roaml.jani.operators import UnaryOperator as JaniUnary
from roaml.model.globals import GlobalVariable
from roaml.model.property_file import PortKind, PortVariableKind, build_property_file
from roaml.model.property_ports import FindInterface, LinkedPort, PortLinker, part_of
from roaml.model.ros import InterfaceType
from roaml.model.system import System
from roaml.observers.properties import CLOSE, LEFT, OPEN, RIGHT, Pattern, PatternProperty, Window
from roaml.record import Record, field
from roaml.scxml.names import FIELD_PREFIX, flag_of, flagged_by
from roaml.smc.normal_form import negated
from roaml.text import Span
from roaml.xml_syntax import parse

_NOWHERE = Span(0, 0)
_BINARY = {
    BinaryOperator.OR: Operator.OR,
    BinaryOperator.AND: Operator.AND,
    BinaryOperator.EQUAL: Operator.EQUAL,
    BinaryOperator.NOT_EQUAL: Operator.NOT_EQUAL,
    BinaryOperator.LESS: Operator.LESS,
    BinaryOperator.LESS_EQUAL: Operator.LESS_EQUAL,
    BinaryOperator.GREATER: Operator.GREATER,
    BinaryOperator.GREATER_EQUAL: Operator.GREATER_EQUAL,
    BinaryOperator.ADD: Operator.ADD,
    BinaryOperator.SUBTRACT: Operator.SUBTRACT,
    BinaryOperator.MULTIPLY: Operator.MULTIPLY,
    BinaryOperator.REMAINDER: Operator.REMAINDER,
}


class NeededVariable(Record, frozen=True):
    """A variable of a port. `port` is the start tag of the port without the angle brackets; `element` is that of the
    variable without its id."""

    port: str
    element: str


class XmlProperty(Record):
    """A property in XML.

    Attributes:
        lines: the lines of the element.
        variables: the variables of ports that the property uses, by their ids.
    """

    lines: list[str] = field(default_factory=list)
    variables: dict[str, NeededVariable] = field(default_factory=dict)


def xml_property(
    name: str, expect: str, form: PatternForm, ports: EventPorts, step: int | None, taken: Mapping[NeededVariable, str]
) -> XmlProperty | None:
    """The property in XML; `None` if a condition has no equivalent.

    Args:
        expect: the expectation; "" if there is none.
        step: the step of the clock in ns; `None` if there is no clock.
        taken: the variables of the file, with their ids. Other variables get new ids.
    """
    conditions = _Conditions(ports, dict(taken))
    property_ = form.property
    try:
        converted = {name: format_expr(tree) for name, tree in conditions.converted(property_, form.conditions).items()}
    except NotConvertibleError:
        return None
    pattern = conditions.pattern or property_.pattern
    events = [f"<event>{escape(converted[side])}</event>" for side in (LEFT, RIGHT) if side in converted]
    scope = "".join(
        f" {attribute}={quoteattr(converted[side])}"
        for attribute, side in (("event", OPEN), ("until", CLOSE))
        if side in converted
    )
    lines = ["<events>", *(f"    {event}" for event in events), "</events>"] if pattern.is_binary else events
    lines.append(f'<scope type="{property_.scope.value}"{scope} />')
    if not property_.window.is_unbounded:
        if step is None:
            return None
        lines.append(_interval(property_.window, step))
    expected = f" expect={quoteattr(expect)}" if expect else ""
    head = f'<property id={quoteattr(name)} pattern="{pattern.value}"{expected}>'
    return XmlProperty([head, *(f"    {line}" for line in lines), "</property>"], conditions.needed)


def _interval(window: Window, step: int) -> str:
    times = {"after": window.lower * step, "within": None if window.upper is None else window.upper * step}
    given = {name: time for name, time in times.items() if time is not None and (name == "within" or time)}
    unit, size = next((u, s) for u, s in NANOSECONDS.items() if all(time % s == 0 for time in given.values()))
    bounds = "".join(f' {name}="{time // size}"' for name, time in given.items())
    return f'<time_interval{bounds} time_unit="{unit}" />'


class EventPorts:
    """The ports of a system that listen to every sending of one event of the translation."""

    def __init__(self, system: System, find: FindInterface, variables: Mapping[str, GlobalVariable]) -> None:
        self.variables = variables
        self.tags: dict[str, str] = {}
        self.fields: dict[str, dict[str, tuple[str, str]]] = {}
        tags = [*port_tags(system)]
        text = "".join(f"<{tag}/>" for tag in tags)
        file = build_property_file(parse(f"<properties><ports>{text}</ports></properties>"))
        assert file is not None
        linker = PortLinker(system, find, variables)

        def known(kind: str, name: str) -> InterfaceType | None:
            type_ = find(kind, name)
            return type_ if isinstance(type_, InterfaceType) else None

        for tag, port in zip(tags, file.ports, strict=True):
            linked = linker.link(port)
            if len(linked.events) == 1 and not linked.events[0].sender:
                event = linked.events[0].name
                if event not in self.tags:
                    self.tags[event] = tag
                    self.fields[event] = dict(self._fields(linked, known))

    def _fields(self, linked: LinkedPort, find: object) -> Iterator[tuple[str, tuple[str, str]]]:
        """Parameter of the event -> the start tag of a variable with its value, and its initial value."""
        port = linked.written
        struct = part_of(port, find)  # type: ignore[arg-type]
        for path, type_ in leaves(struct) if struct is not None else ():
            yield from _state(FIELD_PREFIX + "__".join(path), ".".join(path), "field", type_)
        if port.kind is PortKind.ACTION and port.part is not None and port.part.value == "result":
            yield "code", (PortVariableKind.RESULT_CODE.value, "0")
        if port.kind is PortKind.NODE and port.part is not None and port.part.value == "response":
            yield from _state("status", "status", "field", BASE_TYPES["int32"])

    def event(self, event: str) -> NeededVariable:
        """The variable that is true when an event is sent."""
        return NeededVariable(self._tag(event), PortVariableKind.EVENT.value)

    def parameter(self, name: str, initial: str) -> NeededVariable:
        """The variable of a port that has the value of a global variable.

        Args:
            initial: the value before the first event; "" for the initial value of the global variable.
        """
        variable = self.variables.get(name)
        if variable is None or variable.parameter == "valid" or f"{name}.d1_len" in self.variables or ".d" in name:
            raise NotConvertibleError
        parameter = name.removeprefix(f"{variable.event}__")
        fields = self.fields.get(variable.event)
        if fields is None or parameter not in fields:
            fields = dict(_state(parameter, parameter, "param", variable.type))
            tag = f"scxml_event_send event={quoteattr(variable.event)}"
        else:
            tag = self._tag(variable.event)
        if parameter not in fields:
            raise NotConvertibleError
        element, zero = fields[parameter]
        return NeededVariable(tag, f"{element} expr={quoteattr(initial or zero)}")

    def _tag(self, event: str) -> str:
        if flag_of(event) not in self.variables:
            raise NotConvertibleError
        return self.tags.get(event) or f"scxml_event_send event={quoteattr(event)}"


def _state(parameter: str, field_: str, attribute: str, type_: Type) -> Iterator[tuple[str, tuple[str, str]]]:
    if not isinstance(type_, Scalar) or type_.kind is ScalarKind.STRING:
        return
    zero = {ScalarKind.BOOL: "false", ScalarKind.REAL: "0.0"}.get(type_.kind, "0")
    name = str(type_) if str(type_) in BASE_TYPES else "float64" if type_.kind is ScalarKind.REAL else "int32"
    element = f"{PortVariableKind.STATE.value} type={quoteattr(name)} {attribute}={quoteattr(field_)}"
    yield parameter, (element, zero)


class _Conditions:
    """Converts the conditions of one property.

    Attributes:
        needed: the variables of ports that the conditions read, by their ids.
        pattern: the pattern of the property in XML; `None` if it is that of the form.
    """

    def __init__(self, ports: EventPorts, taken: dict[NeededVariable, str]) -> None:
        self.ports = ports
        self.taken = taken
        self.needed: dict[str, NeededVariable] = {}
        self.pattern: Pattern | None = None

    def converted(self, property_: PatternProperty, conditions: Mapping[str, Expression]) -> dict[str, Expr]:
        trees: dict[str, Expr] = {}
        for name, given in conditions.items():
            condition = given
            is_universality = property_.pattern is Pattern.UNIVERSALITY and name == LEFT
            is_negation = isinstance(condition, jani.Unary) and condition.operator is JaniUnary.NOT
            if is_universality and (is_negation or self.has_flags(condition)):
                self.pattern, condition = Pattern.ABSENCE, negated(condition)
            if not self.has_flags(condition):
                trees[name] = self.value(condition)
            elif needs_first(property_, name):
                trees[name] = self.first(condition)
            else:
                raise NotConvertibleError
        return trees

    def has_flags(self, condition: Expression) -> bool:
        """Whether a condition reads the flag of an event, other than in the value of a variable before its event."""
        waiting = [condition]
        while waiting:
            part = waiting.pop()
            if isinstance(part, jani.Name) and flagged_by(part.identifier):
                return True
            if not isinstance(part, jani.Conditional):
                waiting += jani.children(part)
        return False

    def first(self, condition: Expression) -> Expr:
        """A condition that becomes true for the first time in the same step as `condition`."""
        if not self.has_flags(condition):
            return self.value(condition)
        match condition:
            case jani.Name(identifier):
                return self.variable(self.ports.event(flagged_by(identifier)))
            case jani.Unary(operator=JaniUnary.NOT, operand=jani.Unary(operator=JaniUnary.NOT, operand=operand)):
                return self.first(operand)
            case jani.Unary(operator=JaniUnary.NOT, operand=jani.Binary(operator=operator, left=left, right=right)):
                return self.first(_negated(operator, left, right))
            case jani.Binary(operator=BinaryOperator.OR, left=left, right=right):
                return _joined(Operator.OR, self.first(left), self.first(right))
            case jani.Binary(operator=BinaryOperator.AND):
                return self.sent_with(list(operands(condition, BinaryOperator.AND)))
        raise NotConvertibleError

    def sent_with(self, parts: Sequence[Expression]) -> Expr:
        """A conjunction of the variable of an event with conditions on the data of this event."""
        flags = [part for part in parts if self.has_flags(part)]
        (flag, *more) = flags
        if more or not isinstance(flag, jani.Name):
            raise NotConvertibleError
        event = flagged_by(flag.identifier)
        result: Expr = self.variable(self.ports.event(event))
        for part in parts:
            names = {node.identifier for node in jani.walk(part) if isinstance(node, jani.Name)}
            variables = [self.ports.variables.get(name) for name in names]
            if any(variable is None or variable.event != event for variable in variables):
                raise NotConvertibleError
            if part is not flag:
                result = _joined(Operator.AND, result, self.value(part))
        return result

    def value(self, expression: Expression) -> Expr:
        match expression:
            case jani.Integer(value):
                return _number(value, is_real=False)
            case jani.Real(value):
                return _number(value, is_real=True)
            case jani.Boolean(value):
                return Boolean(_NOWHERE, value)
            case jani.Name(identifier):
                return self.variable(self.ports.parameter(identifier, ""))
            case jani.Unary(operator=JaniUnary.NOT, operand=operand):
                return Unary(_NOWHERE, UnaryOperator.NOT, self.value(operand))
            case jani.Binary(operator=BinaryOperator.IMPLIES, left=left, right=right):
                return _joined(Operator.OR, self.value(negated(left)), self.value(right))
            case jani.Binary(operator=operator, left=left, right=right) if operator in _BINARY:
                return _joined(_BINARY[operator], self.value(left), self.value(right))
            case jani.Conditional(test=jani.Name(flag), then=jani.Name(name), otherwise=initial):
                variable = self.ports.variables.get(name)
                if variable is not None and flag == flag_of(variable.event):
                    return self.variable(self.ports.parameter(name, _constant(initial)))
        raise NotConvertibleError

    def variable(self, needed: NeededVariable) -> Name:
        if needed not in self.taken:
            ids = {*self.taken.values()}
            stem, number = _id(needed), 1
            id_ = stem
            while id_ in ids:
                number += 1
                id_ = f"{stem}_{number}"
            self.taken[needed] = id_
        self.needed[self.taken[needed]] = needed
        return Name(_NOWHERE, self.taken[needed])


def _negated(operator: BinaryOperator, left: Expression, right: Expression) -> Expression:
    match operator:
        case BinaryOperator.AND:
            return jani.Binary(BinaryOperator.OR, negated(left), negated(right))
        case BinaryOperator.OR:
            return jani.Binary(BinaryOperator.AND, negated(left), negated(right))
        case BinaryOperator.IMPLIES:
            return jani.Binary(BinaryOperator.AND, left, negated(right))
    raise NotConvertibleError


def _constant(initial: Expression) -> str:
    """A constant as text in XML."""
    match initial:
        case jani.Boolean(value):
            return "true" if value else "false"
        case jani.Integer(value):
            return str(value)
        case jani.Real(value):
            return repr(value)
        case jani.Binary(BinaryOperator.SUBTRACT, jani.Integer(0), jani.Integer() | jani.Real() as right):
            return f"-{_constant(right)}"
    raise NotConvertibleError


def _number(value: float, *, is_real: bool) -> Expr:
    number = Number(_NOWHERE, abs(value), is_real)
    return Unary(_NOWHERE, UnaryOperator.NEGATE, number) if value < 0 else number


def _joined(operator: Operator, left: Expr, right: Expr) -> Expr:
    return Binary(_NOWHERE, operator, _NOWHERE, left, right)


def _id(needed: NeededVariable) -> str:
    """A name for a variable: that of its interface, followed by its field if it has a value."""
    values = re.findall(r'="([^"]*)"', needed.port)
    name = values[0] if values else "event"
    part = "" if "ros_topic" in needed.port or len(values) < 2 else f"_{values[-1] if 'bt_node' in needed.port else ''}"
    given = re.search(r'(?:field|param)="([^"]*)"', needed.element)
    own = given[1].removeprefix(FIELD_PREFIX) if given else "code" if "result_code" in needed.element else ""
    words = re.sub(r"\W+", "_", f"{name}{part}_{own}", flags=re.ASCII).strip("_")
    return words if words[:1].isalpha() else f"event_{words}"
