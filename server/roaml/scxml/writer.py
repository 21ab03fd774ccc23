# SPDX-License-Identifier: Apache-2.0
"""Writes plain SCXML as documents for other tools, one for each automaton (docs/spec/plain-scxml.md#documents).

- A comment before every `<data>` contains its type, because SCXML has no types.
- A `<send>` is written once for each automaton that receives the event, with that automaton as its target. Without a
  receiver, the target is `NONE`.
- A transition with several targets becomes a state that draws a random number to select a target. So a new number is
  drawn each time the transition is taken (docs/spec/plain-scxml.md#documents).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple
from xml.sax.saxutils import escape

from roaml.expr.format import format_expr
from roaml.scxml.events import Role
from roaml.scxml.model import Assign, Automaton, Body, Data, If, Network, Send, State, Target, Transition
from roaml.text import Location

NAMESPACE = "http://www.w3.org/2005/07/scxml"
NOBODY = "NONE"
DRAWN = "__RAND__"
DELAY = "1"
"""The `delay` of the `<send>` with which the clock sends its step to itself. Because of this delay, time passes only if
no other event waits."""
_INDENT = "    "


class WrittenLine(NamedTuple):
    """A line without its line end, and the place in the models from which it comes."""

    text: str
    origin: Location


Lines = Iterator[WrittenLine]


def write(network: Network) -> Iterator[tuple[str, str]]:
    """For each automaton, in order, its name and the text of its document."""
    for automaton, lines in write_lines(network):
        yield automaton.name, "".join(f"{line.text}\n" for line in lines)


def write_lines(network: Network) -> Iterator[tuple[Automaton, Lines]]:
    """For each automaton, in order, the lines of its document with their origins."""
    receivers = receivers_of(network)
    for automaton in network.automata:
        yield automaton, _Writer(automaton, receivers).document()


def receivers_of(network: Network) -> dict[str, list[str]]:
    """Event -> the names of the automata that have a transition on it, in order."""
    receivers: dict[str, dict[str, None]] = {}
    for automaton in network.automata:
        for state in automaton.states:
            for transition in state.transitions:
                if transition.event:
                    receivers.setdefault(transition.event.name, {})[automaton.name] = None
    return {event: list(names) for event, names in receivers.items()}


class _Writer:
    def __init__(self, automaton: Automaton, receivers: Mapping[str, list[str]]) -> None:
        self.automaton = automaton
        self.receivers = receivers
        self.ids = {state.id for state in automaton.states}
        self.draws = any(len(t.targets) > 1 for state in automaton.states for t in state.transitions)
        self.drawn = _fresh(DRAWN, {data.id for data in automaton.data})

    def document(self) -> Lines:
        automaton = self.automaton
        root = _attributes(
            xmlns=NAMESPACE,
            version="1.0",
            name=automaton.name,
            datamodel="ecmascript",
            initial=automaton.initial,
        )
        yield WrittenLine(f"<scxml{root}>", automaton.origin)
        yield from _indented(_element("datamodel", {}, self.datamodel(), automaton.origin))
        for state in automaton.states:
            yield from _indented(self.state(state))
        yield WrittenLine("</scxml>", automaton.origin)

    def datamodel(self) -> Lines:
        for data in self.automaton.data:
            yield from _data(data)
        if self.draws:
            yield WrittenLine(f"<!-- TYPE {self.drawn}:float64 -->", self.automaton.origin)
            yield WrittenLine(f"<data{_attributes(id=self.drawn, expr='0.0')}/>", self.automaton.origin)

    # ------------------------------------------------------------------- states

    def state(self, state: State) -> Lines:
        drawing: list[tuple[str, Transition]] = []
        lines = [
            *_element("onentry", {}, self.body(state.entry), state.origin),
            *_element("onexit", {}, self.body(state.exit), state.origin),
        ]
        for transition in state.transitions:
            if len(transition.targets) == 1:
                lines += self.transition(_event(transition), _cond(transition), transition.targets[0])
            else:
                drawing.append((_fresh(f"{state.id}_draw_{len(drawing) + 1}", self.ids), transition))
                self.ids.add(drawing[-1][0])
                attributes = {"event": _event(transition), "cond": _cond(transition), "target": drawing[-1][0]}
                lines += _element("transition", attributes, (), transition.origin)
        yield from _element("state", {"id": state.id}, lines, state.origin, always=True)
        for identifier, transition in drawing:
            yield from self.draw(identifier, transition)

    def draw(self, identifier: str, transition: Transition) -> Lines:
        """The state named `identifier` that draws a random number to select a target of `transition`."""
        origin = transition.origin
        assign = WrittenLine(f"<assign{_attributes(location=self.drawn, expr='Math.random()')}/>", origin)
        lines = [*_element("onentry", {}, (assign,), origin)]
        bound = 0.0
        for target in transition.targets[:-1]:
            bound += target.probability
            lines += self.transition("", f"{self.drawn} < {bound:.15g}", target)
        lines += self.transition("", "", transition.targets[-1])
        yield from _element("state", {"id": identifier}, lines, origin)

    def transition(self, event: str, cond: str, target: Target) -> Lines:
        attributes = {"event": event, "cond": cond, "target": target.state}
        yield from _element("transition", attributes, self.body(target.body), target.origin, always=True)

    # ------------------------------------------------------------------- bodies

    def body(self, body: Body) -> Lines:
        for statement in body:
            match statement:
                case Assign():
                    location, value = format_expr(statement.location), format_expr(statement.value)
                    yield WrittenLine(f"<assign{_attributes(location=location, expr=value)}/>", statement.origin)
                case Send():
                    yield from self.send(statement)
                case If():
                    yield from self.choice(statement)

    def send(self, statement: Send) -> Lines:
        params = [
            WrittenLine(f"<param{_attributes(name=param.name, expr=format_expr(param.value))}/>", param.origin)
            for param in statement.params
        ]
        for target in self.receivers.get(statement.event.name, (NOBODY,)):
            attributes = {"event": statement.event.name, "target": target}
            if self.automaton.role is Role.CLOCK and target == self.automaton.name:
                attributes["delay"] = DELAY
            yield from _element("send", attributes, params, statement.origin, always=True)

    def choice(self, statement: If) -> Lines:
        first, *others = statement.branches
        yield WrittenLine(f"<if{_attributes(cond=format_expr(first.cond))}>", statement.origin)
        yield from _indented(self.body(first.body))
        for branch in others:
            yield WrittenLine(f"<elseif{_attributes(cond=format_expr(branch.cond))}/>", branch.origin)
            yield from _indented(self.body(branch.body))
        if statement.otherwise:
            yield WrittenLine("<else/>", statement.origin)
            yield from _indented(self.body(statement.otherwise))
        yield WrittenLine("</if>", statement.origin)


def _data(data: Data) -> Lines:
    yield WrittenLine(f"<!-- TYPE {data.id}:{data.type} -->", data.origin)
    yield WrittenLine(f"<data{_attributes(id=data.id, expr=format_expr(data.value))}/>", data.origin)


def _event(transition: Transition) -> str:
    return transition.event.name if transition.event else ""


def _cond(transition: Transition) -> str:
    return "" if transition.cond is None else format_expr(transition.cond)


def _fresh(name: str, taken: Iterable[str]) -> str:
    known = set(taken)
    while name in known:
        name += "_"
    return name


def _element(
    name: str, attributes: Mapping[str, str], content: Iterable[WrittenLine], origin: Location, always: bool = False
) -> Lines:
    """The lines of an element. An element without content and attributes is left out, unless `always` is true."""
    start, lines = f"<{name}{_attributes(**attributes)}", list(content)
    if lines:
        yield WrittenLine(f"{start}>", origin)
        yield from _indented(lines)
        yield WrittenLine(f"</{name}>", origin)
    elif always or attributes:
        yield WrittenLine(f"{start}/>", origin)


def _attributes(**attributes: str) -> str:
    """Attributes in the given order, without those whose value is empty."""
    return "".join(f' {name}="{escape(value, _QUOTES)}"' for name, value in attributes.items() if value)


_QUOTES = {'"': "&quot;", "\n": "&#10;", "\t": "&#9;", "\r": "&#13;"}


def _indented(lines: Iterable[WrittenLine]) -> Lines:
    return (WrittenLine(f"{_INDENT}{line.text}", line.origin) for line in lines)
