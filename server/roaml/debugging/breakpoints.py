# SPDX-License-Identifier: Apache-2.0
"""Breakpoints: where a run stops, and which steps reach them.

A breakpoint on a statement, a handler, a node or an event stops before the step that executes, ticks, sends or receives
it. A breakpoint on the effect of a step stops after the step: a state is entered, a variable has changed, or a property
is decided.
"""

from __future__ import annotations

import enum
import re
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from roaml.debugging.evaluate import Scope, WatchError, condition, evaluate, parsed
from roaml.debugging.sources import Sources
from roaml.debugging.values import SEPARATOR, shown
from roaml.expr.tree import Expr
from roaml.jani.node import Origin
from roaml.model.system import CLOCK_TOPIC
from roaml.record import Record, field
from roaml.regex import regex
from roaml.scxml.names import STATUSES, TreeEventKind, read_tree_event, received_by, sent_by, topic_message
from roaml.simulation.session import Session
from roaml.simulation.verdicts import Decided
from roaml.simulation.words import returned_status
from roaml.smc.record import AutomatonStep, TraceStep, TraceVerdict


class Line(NamedTuple):
    """A line of a file, from 1."""

    path: str
    line: int


class ExceptionFilter(enum.Enum):
    """A reason to stop that is independent of places in the sources: a property is violated or satisfied, a node
    returns FAILURE, the next step is decided by chance, or time advances."""

    VIOLATED = "violated"
    SATISFIED = "satisfied"
    FAILURE = "failure"
    CHANCE = "chance"
    TIME = "time"


class WatchedVariable(NamedTuple):
    """A variable of an instance, or of the model (`instance` is -1). A struct is also one, although it consists of
    several variables of the network."""

    instance: int
    name: str


class Breakpoint(Record, eq=False):
    """A breakpoint of any kind.

    Attributes:
        number: identifies the breakpoint; 0 for a filter.
        name: its subject, for messages.
        condition: the run stops only if the condition is true. It is evaluated in the state in which the breakpoint
            stops.
        required_hits: a function that returns whether the run stops at the hit with a given number, from 1; `None` if
            the run stops at all hits.
        message: a text that is logged instead of stopping; expressions are in braces.
        hits: the number of times that the breakpoint was reached while its condition was true.
    """

    number: int = 0
    name: str = ""
    condition: Expr | None = None
    required_hits: Callable[[int], bool] | None = None
    message: str = ""
    hits: int = 0

    def is_met(self, scope: Scope) -> bool:
        """Whether the condition is true. A condition that has no value is not met."""
        if self.condition is None:
            return True
        try:
            return condition(self.condition, scope)
        except WatchError:
            return False

    def stops(self) -> bool:
        """Count a hit; return whether the run stops at it, or its message is logged."""
        self.hits += 1
        return self.required_hits is None or self.required_hits(self.hits)


def breakpoint_of(
    number: int, name: str, condition_: str = "", hit_condition: str = "", message: str = ""
) -> Breakpoint:
    """A breakpoint from the texts of the client.

    Raises:
        WatchError: the condition, the hit condition or the message cannot be read.
    """
    for part in _BRACES.findall(message):
        parsed(part)
    return Breakpoint(
        number,
        name,
        parsed(condition_) if condition_.strip() else None,
        _hit_condition(hit_condition) if hit_condition.strip() else None,
        message,
    )


def _hit_condition(text: str) -> Callable[[int], bool]:
    match = re.fullmatch(r"\s*(>=|<=|==|=|>|<|%)?\s*(\d{1,9})\s*", text)
    if match is None or (match[1] == "%" and int(match[2]) == 0):
        raise WatchError(f"`{text}` is not a hit condition; write for example `5`, `>= 5` or `% 2`")
    relation, number = match[1] or "==", int(match[2])
    return {
        ">=": lambda hits: hits >= number,
        "<=": lambda hits: hits <= number,
        ">": lambda hits: hits > number,
        "<": lambda hits: hits < number,
        "%": lambda hits: hits % number == 0,
    }.get(relation, lambda hits: hits == number)


_BRACES = regex(r"\{([^{}]*)\}")


def logged(message: str, scope: Scope) -> str:
    """The message of a log point, with its expressions replaced by their values."""

    def value(match: re.Match[str]) -> str:
        try:
            return shown(evaluate(parsed(match[1]), scope))
        except WatchError as error:
            return f"{{{error}}}"

    return _BRACES.sub(value, message)


class Breakpoints(Record):
    """The breakpoints that are set, by the kind of their place."""

    lines: dict[str, list[tuple[int, Breakpoint]]] = field(default_factory=dict)
    names: list[tuple[str, Breakpoint]] = field(default_factory=list)
    variables: list[tuple[WatchedVariable, Breakpoint]] = field(default_factory=list)
    filters: dict[ExceptionFilter, Breakpoint] = field(default_factory=dict)


class BreakpointPlaces:
    """The lines at which a run can stop."""

    def __init__(self, session: Session, sources: Sources) -> None:
        self._session = session
        self._sources = sources
        self._parts: dict[tuple[int, int], frozenset[Line]] = {}
        self.states: dict[Line, list[tuple[int, str]]] = {}
        self.nodes: dict[Line, list[int]] = {}
        self.properties: dict[Line, list[str]] = {}
        self.statements: set[Line] = set()
        self._state_origins: set[Origin] = set()
        self._find()
        self.by_path: dict[str, list[int]] = {}
        for line in sorted({*self.statements, *self.states, *self.nodes, *self.properties}):
            self.by_path.setdefault(line.path, []).append(line.line)

    def _find(self) -> None:
        for node in self._sources.nodes.values():
            if (line := self.line(node.origin)) is not None:
                self.nodes.setdefault(line, []).append(node.number)
        for name, origin in self._sources.property_origins.items():
            for line in self._lines(origin):
                self.properties.setdefault(line, []).append(name)
        for instance, automaton in enumerate(self._session.automata_of_model):
            if not self._session.is_machine(instance):
                continue
            for name, origin in self._sources.states(automaton).items():
                self._state_origins.add(origin)
                if (line := self.line(origin)) is not None and not self.is_channel(line):
                    self.states.setdefault(line, []).append((instance, name))
        for instance, automaton in enumerate(self._session.automata_of_model):
            if self._session.is_machine(instance) and not self._sources.is_library_node(automaton):
                for edge in automaton.edges:
                    for destination in edge.destinations:
                        part = AutomatonStep(instance, automaton.name, edge.source, edge, destination)
                        self.statements |= self.of_part(part)

    def is_channel(self, line: Line) -> bool:
        """Whether the steps at a line are those of a `<channel>`: a system file contains no other ones. A channel has
        no states of the user, and with the clock, it only counts the time of a delay."""
        path = self._sources.target.path
        return line.path == path and not path.endswith(".jani")

    def line(self, origin: Origin | None) -> Line | None:
        place = self._sources.place(origin)
        return None if place is None else Line(place.path, place.line)

    def _lines(self, origin: Origin) -> Iterable[Line]:
        source = self._sources.target.source_of(origin.path)
        if source is None:
            return ()
        first = source.lines.position(origin.span.start).line + 1
        last = source.lines.position(origin.span.end).line + 1
        return (Line(origin.path, line) for line in range(first, last + 1))

    def of_part(self, part: AutomatonStep) -> frozenset[Line]:
        """The lines that a part of a step executes; empty if it only discards an event."""
        key = (id(part.edge), id(part.destination))
        if key not in self._parts:
            origins = {part.edge.origin, part.destination.origin} - self._state_origins
            origins |= {assignment.origin for assignment in part.destination.assignments}
            self._parts[key] = frozenset(line for origin in origins if (line := self.line(origin)) is not None)
        return self._parts[key]

    def next_line(self, path: str, line: int) -> int | None:
        """The first line from `line` on at which a run can stop; `None` if there is none."""
        return next((candidate for candidate in self.by_path.get(path, ()) if candidate >= line), None)


class Matcher:
    """Finds the breakpoints that steps reach."""

    def __init__(self, session: Session, sources: Sources, places: BreakpointPlaces, breakpoints: Breakpoints) -> None:
        self._session = session
        self._places = places
        self._statements: dict[Line, list[Breakpoint]] = {}
        self._states: dict[tuple[int, str], list[Breakpoint]] = {}
        self._nodes: dict[int, list[Breakpoint]] = {}
        self._properties: dict[str, list[Breakpoint]] = {}
        self._events: dict[str, list[Breakpoint]] = {}
        self._variables = breakpoints.variables
        self._filters = breakpoints.filters
        for path, of_file in breakpoints.lines.items():
            for number, breakpoint_ in of_file:
                self._add(Line(path, number), breakpoint_)
        for name, breakpoint_ in breakpoints.names:
            for event in session.events_named(name):
                self._events.setdefault(event, []).append(breakpoint_)
            for node in nodes_named(sources, name):
                self._nodes.setdefault(node, []).append(breakpoint_)

    def _add(self, line: Line, breakpoint_: Breakpoint) -> None:
        if line in self._places.statements:
            self._statements.setdefault(line, []).append(breakpoint_)
        for state in self._places.states.get(line, ()):
            self._states.setdefault(state, []).append(breakpoint_)
        for node in self._places.nodes.get(line, ()):
            self._nodes.setdefault(node, []).append(breakpoint_)
        for name in self._places.properties.get(line, ()):
            self._properties.setdefault(name, []).append(breakpoint_)

    def is_on_property(self, breakpoint_: Breakpoint) -> bool:
        """Whether a breakpoint is set on a line of a property."""
        return any(breakpoint_ is other for of_property in self._properties.values() for other in of_property)

    def before(self, step: TraceStep) -> list[tuple[Breakpoint, int]]:
        """The breakpoints that stop before a step, each with the instance that reaches it."""
        hits: list[tuple[Breakpoint, int]] = []
        actors = self._session.actors(step)
        first = actors[0].instance if actors else -1
        event = received_by(step.action or "")
        if self._statements:
            counts_time = event == topic_message(CLOCK_TOPIC)
            for part in actors:
                if self._session.is_machine(part.instance):
                    for line in self._places.of_part(part):
                        if not (counts_time and self._places.is_channel(line)):
                            hits += ((breakpoint_, part.instance) for breakpoint_ in self._statements.get(line, ()))
        if self._nodes and (tree := read_tree_event(event)) and tree.kind is TreeEventKind.TICK:
            hits += ((breakpoint_, first) for breakpoint_ in self._nodes.get(tree.number, ()))
        if self._events:
            hits += ((breakpoint_, first) for breakpoint_ in self._events.get(sent_by(step.action or ""), ()))
            if actors:
                hits += ((breakpoint_, first) for breakpoint_ in self._events.get(event, ()))
        chance = self._filters.get(ExceptionFilter.CHANCE)
        if chance is not None:
            hits += ((chance, part.instance) for part in actors if len(part.edge.destinations) > 1)
        return hits

    def after(self, step: TraceStep, decided: Sequence[Decided]) -> list[tuple[Breakpoint, int]]:
        """The breakpoints that stop after a step, each with the instance that reaches it.

        Args:
            decided: the properties that are decided by the step.
        """
        hits: list[tuple[Breakpoint, int]] = []
        actors = self._session.actors(step)
        first = actors[0].instance if actors else -1
        if self._states:
            for part in actors:
                if self._places.of_part(part) or part.source != part.destination.location:
                    reached = self._states.get((part.instance, part.destination.location), ())
                    hits += ((breakpoint_, part.instance) for breakpoint_ in reached)
        for variable, breakpoint_ in self._variables:
            if any(_is_part(change.variable.instance, change.variable.name, variable) for change in step.changes):
                hits.append((breakpoint_, first))
        for property_ in decided:
            if property_.verdict is TraceVerdict.FAILED:
                hits += ((breakpoint_, first) for breakpoint_ in self._properties.get(property_.name, ()))
            verdict = self._filters.get(
                ExceptionFilter.VIOLATED if property_.verdict is TraceVerdict.FAILED else ExceptionFilter.SATISFIED
            )
            if verdict is not None:
                hits.append((verdict, first))
        failure = self._filters.get(ExceptionFilter.FAILURE)
        if failure is not None and _fails(step):
            hits.append((failure, first))
        time = self._filters.get(ExceptionFilter.TIME)
        if time is not None and _passes_time(self._session, step):
            hits.append((time, first))
        return hits


def _fails(step: TraceStep) -> bool:
    """Whether a node of the tree answers its tick with FAILURE."""
    event = sent_by(step.action or "")
    tree = read_tree_event(event)
    if tree is None or tree.kind is not TreeEventKind.RESPONSE:
        return False
    variable = f"{event}{SEPARATOR}status"
    changed = [change.after for change in step.changes if change.variable.name == variable]
    is_returned = any(returned_status(event, part.destination) == "FAILURE" for part in step.parts)
    return is_returned or STATUSES["FAILURE"] in changed


def _is_part(instance: int, name: str, variable: WatchedVariable) -> bool:
    owner = variable.name
    return instance == variable.instance and (name == owner or name.startswith((f"{owner}{SEPARATOR}", f"{owner}.")))


def _passes_time(session: Session, step: TraceStep) -> bool:
    return any(change.variable.instance < 0 and change.variable.name in session.clock for change in step.changes)


def nodes_named(sources: Sources, name: str) -> list[int]:
    """The nodes of the tree with a type, name or number (`bt_1003`)."""
    return [
        number
        for number, node in sources.nodes.items()
        if name in (node.type, node.name, f"bt_{number}", f"{node.type} (bt_{number})")
    ]
