# SPDX-License-Identifier: Apache-2.0
"""Writes the properties of a system as a document for SCAN and other tools, in addition to the plain SCXML of the
system (docs/spec/plain-scxml.md#lowered-properties).

Each port selects one event, the automaton that sends it, and one automaton that receives it. Formulas are in past-time
metric temporal logic, with times in steps of the clock.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from xml.sax.saxutils import quoteattr

from roaml.expr.format import format_expr
from roaml.expr.operators import Operator
from roaml.expr.transform import map_children
from roaml.expr.tree import Binary, Boolean, Expr, Name, walk
from roaml.expr.types import Scalar, ScalarKind
from roaml.observers.past import past_formula
from roaml.observers.properties import RIGHT, And, Atom, Constant, Formula, FormulaProperty, Not, Or, Since, Window
from roaml.record import Record
from roaml.scxml.model import Automaton, Body, If, Network, Send
from roaml.scxml.observed import ObservedPort, ObservedProperty, ObservedVariable
from roaml.scxml.writer import NOBODY, receivers_of

FILE_NAME = "properties.xml"
NOBODY_TEXT = f"""<scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0" name="{NOBODY}" initial="init">
    <state id="init"/>
</scxml>
"""
"""The document of an automaton that is the target of events that no automaton receives."""


class _NotWrittenError(Exception):
    """Raised if a property cannot be written. The message states the reason."""


class LoweredProperties(Record, frozen=True):
    """The document with the properties of a system.

    Attributes:
        text: the text of the document; "" if no property can be written.
        left_out: the properties that cannot be written, with the reasons.
        names_nobody: whether a port refers to the automaton of `NOBODY_TEXT`.
    """

    text: str
    left_out: tuple[tuple[ObservedProperty, str], ...]
    names_nobody: bool


def lowered_properties(network: Network, properties: Sequence[ObservedProperty]) -> LoweredProperties:
    """The document with the guarantees in `properties` and their assumptions, for the system `network`."""
    writer = _Writer(network)
    guarantees: list[str] = []
    assumes: dict[str, str] = {}
    left_out: list[tuple[ObservedProperty, str]] = []
    is_shared = len({tuple(a.name for a in property_.assumptions) for property_ in properties}) == 1
    for property_ in properties:
        try:
            if property_.assumptions and not is_shared:
                raise _NotWrittenError("the properties of a document must have the same assumptions")
            assumes |= {assumed.name: writer.property(assumed) for assumed in property_.assumptions}
            guarantees.append(writer.property(property_))
        except _NotWrittenError as error:
            left_out.append((property_, str(error)))
    if not guarantees:
        return LoweredProperties("", tuple(left_out), False)
    lines = ["<properties>", "    <ports>", *writer.ports.values(), "    </ports>"]
    if assumes:
        lines += ["    <assumes>", *assumes.values(), "    </assumes>"]
    text = "\n".join([*lines, "    <guarantees>", *guarantees, "    </guarantees>", "</properties>", ""])
    return LoweredProperties(text, tuple(left_out), f"target={quoteattr(NOBODY)}" in text)


class _Writer:
    """Writes the properties of one system.

    Attributes:
        ports: the ports that the written properties use: name of a variable -> the lines of its port.
    """

    def __init__(self, network: Network) -> None:
        self.receivers = receivers_of(network)
        self.senders: dict[str, list[Automaton]] = {}
        for automaton in network.automata:
            for event in dict.fromkeys(_sent(automaton)):
                self.senders.setdefault(event, []).append(automaton)
        self.ports: dict[str, str] = {}
        self.names: dict[str, str] = {}

    def property(self, property_: ObservedProperty) -> str:
        formula = _formula_of(property_)
        if formula is None:
            raise _NotWrittenError(
                "a past-time formula cannot express a requirement that has no deadline, or that ends with its scope"
            )
        variables = {variable.id: (port, variable) for port in property_.ports for variable in port.variables}

        def replaced(expr: Expr) -> Expr:
            if isinstance(expr, Name):
                return self.variable(*variables[expr.name], expr)
            return map_children(expr, replaced)

        conditions = {name: format_expr(replaced(condition)) for name, condition in property_.conditions.items()}
        # SCAN evaluates the formula at the end of a run. With `historically`, it is true if it was true at every event.
        text = f"historically {formula_text(formula, conditions)}"
        return f'        <property id={quoteattr(property_.name)} logic="pmtl" expr={quoteattr(text)}/>'

    def variable(self, port: ObservedPort, variable: ObservedVariable, place: Name) -> Expr:
        """The expression that replaces a variable of a property: a variable of the document, or a disjunction of
        several."""
        sendings = [
            (event.name, automaton.name)
            for event in port.events
            for automaton in self.senders.get(event.name, ())
            if event.sender in ("", automaton.name, automaton.thread_of)
        ]
        if not sendings:
            return Boolean(place.span, False) if variable.initial is None else variable.initial
        if variable.initial is not None and len(sendings) > 1:
            message = f"several machines send the value of `{variable.id}`; a port can have only one sender"
            raise _NotWrittenError(message)
        names = [self.port(variable, event, origin) for event, origin in sendings]
        result: Expr = Name(place.span, names[0])
        for name in names[1:]:
            result = Binary(place.span, Operator.OR, place.span, result, Name(place.span, name))
        return result

    def port(self, variable: ObservedVariable, event: str, origin: str) -> str:
        """The name of the variable of the port for `event` from the automaton `origin`; a new port is added."""
        target = self.receivers.get(event, [NOBODY])[0]
        head = f"event={quoteattr(event)} origin={quoteattr(origin)} target={quoteattr(target)}"
        if variable.initial is None:
            content = "<event_var id={}/>"
        else:
            if not isinstance(variable.type, Scalar) or variable.type.kind is ScalarKind.STRING:
                raise _NotWrittenError(f"the type of `{variable.id}` is neither a number nor a boolean")
            if not variable.parameter:
                raise _NotWrittenError(f"the event `{event}` has no parameter for `{variable.id}`")
            content = (
                f"<state_var id={{}} type={quoteattr(str(variable.type))} param={quoteattr(variable.parameter)} "
                f"expr={quoteattr(format_expr(variable.initial))}/>"
            )
        key, number = f"{head} {content}", 1
        while key not in self.names:
            name = variable.id if number == 1 else f"{variable.id}_{number}"
            if name not in self.ports:
                self.names[key] = name
                lines = f"        <scxml_event_send {head}>", f"            {content.format(quoteattr(name))}"
                self.ports[name] = "\n".join((*lines, "        </scxml_event_send>"))
            number += 1
        return self.names[key]


def _formula_of(property_: ObservedProperty) -> Formula | None:
    written = property_.property
    if isinstance(written, FormulaProperty):
        return written.formula
    events = {variable.id for port in property_.ports for variable in port.variables if variable.initial is None}
    answer = property_.conditions.get(RIGHT)
    return past_formula(written, answers_with_clock=answer is not None and not _is_monotonic(answer, events))


def _is_monotonic(condition: Expr, events: AbstractSet[str]) -> bool:
    """Whether a condition that is false stays false when the event variables become false."""
    if isinstance(condition, Binary) and condition.operator in (Operator.AND, Operator.OR):
        return _is_monotonic(condition.left, events) and _is_monotonic(condition.right, events)
    if isinstance(condition, Name):
        return True
    return not any(isinstance(part, Name) and part.name in events for part in walk(condition))


def _sent(automaton: Automaton) -> Iterator[str]:
    for state in automaton.states:
        bodies = [target.body for transition in state.transitions for target in transition.targets]
        for body in (state.entry, state.exit, *bodies):
            yield from _sent_in(body)


def _sent_in(body: Body) -> Iterator[str]:
    for statement in body:
        match statement:
            case Send():
                yield statement.event.name
            case If():
                for branch in statement.branches:
                    yield from _sent_in(branch.body)
                yield from _sent_in(statement.otherwise)


def formula_text(formula: Formula, conditions: Mapping[str, str]) -> str:
    """A formula in the notation that both SCAN and this project read. Each operation is in parentheses."""
    match formula:
        case Atom(name):
            return f"{{ {conditions[name]} }}"
        case Constant(value):
            return "true" if value else "false"
        case Not(operand):
            return f"(! {formula_text(operand, conditions)})"
        case And(left, right):
            return f"({formula_text(left, conditions)} && {formula_text(right, conditions)})"
        case Or(left, right):
            return f"({formula_text(left, conditions)} || {formula_text(right, conditions)})"
        case Since(left, right, window):
            return f"({formula_text(left, conditions)} since{_bounds(window)} {formula_text(right, conditions)})"


def _bounds(window: Window) -> str:
    if window.is_unbounded:
        return ""
    return f"[{window.lower or ''}:{'' if window.upper is None else window.upper}]"
