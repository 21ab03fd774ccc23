# SPDX-License-Identifier: Apache-2.0
"""Why no run takes a step: the conditions that stop all ways to it.

A step is not taken because its location is not entered, because its event is not sent, or because its condition never
holds when its event arrives. The first two are followed backwards, into the senders; so is a condition that needs a
value which only a step that is not taken assigns or sends. What is left are conditions that are evaluated in some run,
and whose values all come from steps that are taken.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TypeAlias

from roaml.jani.expressions import Binary, Boolean, Expression, Integer, Name, Real, Unary, walk
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.semantics import EvaluationError, evaluate
from roaml.json_syntax.brackets import deep_recursion
from roaml.project.explored_steps import ExploredStep, ExploredSteps, ExploredVariable, ExploredWrite
from roaml.record import Record
from roaml.scxml.names import SERVICE_HANDLER_PREFIX


class Obstacle(Record, frozen=True, eq=False):
    """A step whose condition never holds although it is evaluated in some run.

    Attributes:
        way: the steps from one that was asked about to `step`; each one is not taken because of the next.
    """

    step: ExploredStep
    way: tuple[ExploredStep, ...]


def obstacles(
    steps: ExploredSteps, wanted: Iterable[ExploredStep], *, are_long: bool = False
) -> tuple[Obstacle, ...] | None:
    """The conditions because of which no run takes one of the steps `wanted`; `None` if there are other causes, such as
    a message that is discarded, or the end of the run where a condition counts.

    Args:
        wanted: steps that no run takes.
        are_long: whether the runs are longer than those of the system, so that variables that count had more time.
    """
    search = _Search(steps, are_long=are_long)
    try:
        with deep_recursion():
            found = search.all(wanted, None)
    except RecursionError:
        return None
    if not found or None in found:
        return None
    return tuple(Obstacle(step, tuple(search.way(step))) for step in found if step is not None)


_Value: TypeAlias = "bool | int | float"


class _Reader(Record, frozen=True):
    """A condition that reads a variable.

    Attributes:
        name: the name of the variable in the condition.
        terms: the terms of the condition that read the variable.
        fixed: the values of the other variables that have only one.
    """

    name: str
    terms: tuple[Expression, ...]
    fixed: Mapping[str, _Value]

    def holds(self, value: _Value) -> bool | None:
        """Whether the terms hold with this value of the variable; `None` if this depends on other variables."""
        values = [_value(term, {**self.fixed, self.name: value}) for term in self.terms]
        return False if False in values else None if None in values else True


def is_contradictory(steps: ExploredSteps, step: ExploredStep) -> bool:
    """Whether the condition of a step cannot hold, whatever value one of its variables has. Only variables whose
    terms compare them with constants, or with variables that are never assigned, are examined."""
    for reader in _readers(steps, step):
        limits = [value for term in reader.terms for value in _constants(term, reader.fixed)]
        # Between two neighbouring limits, comparisons do not change.
        tried = {value + difference for value in limits for difference in (-1, -0.5, 0, 0.5, 1)}
        if tried and all(reader.holds(value) is False for value in tried):
            return True
    return False


def _readers(steps: ExploredSteps, step: ExploredStep) -> Iterator[_Reader]:
    """The condition of a step, as a reader of each of its variables."""
    terms = () if step.guard is None else tuple(_conjuncts(step.guard))
    initial = {name: _fixed(steps, steps.variable(step, name)) for name in _names(terms)}
    fixed = {name: value for name, value in initial.items() if value is not None}
    for name in initial:
        reading = tuple(term for term in terms if name in _names([term]))
        yield _Reader(name, reading, {n: v for n, v in fixed.items() if n != name})


def _constants(term: Expression, fixed: Mapping[str, _Value]) -> Iterator[float]:
    """The numbers with which a term compares a variable."""
    for part in walk(term):
        value = fixed.get(part.identifier) if isinstance(part, Name) else _literal(part)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            yield value


_Causes = dict["ExploredStep | None", None]
"""The steps whose conditions never hold, in order; `None` stands for all other causes. The values are not used."""


class _Search:
    def __init__(self, steps: ExploredSteps, *, are_long: bool) -> None:
        self.steps = steps
        self.are_long = are_long
        self.known: dict[ExploredStep, _Causes] = {}
        self.before: dict[ExploredStep, ExploredStep | None] = {}

    def way(self, step: ExploredStep) -> list[ExploredStep]:
        """The steps on which the search has come to a step."""
        way = [step]
        while (before := self.before[way[0]]) is not None:
            way.insert(0, before)
        return way

    def all(self, wanted: Iterable[ExploredStep], before: ExploredStep | None) -> _Causes:
        causes: _Causes = {}
        is_empty = True
        for step in wanted:
            is_empty = False
            causes.update(self.of(step, before))
        return {None: None} if is_empty else causes

    def of(self, step: ExploredStep, before: ExploredStep | None) -> _Causes:
        """The causes why a step is not taken; none if they are still searched, so that the step depends on itself."""
        if step not in self.known:
            self.known[step], self.before[step] = {}, before
            self.known[step] = self._of(step)
        return self.known[step]

    def _of(self, step: ExploredStep) -> _Causes:
        if not self.steps.is_entered(step.automaton, step.edge.source):
            return self.all(self.steps.entering(step.automaton, step.edge.source), step)
        if any(other.is_taken for other in self.steps.beside(step)) and not step.sends:
            return self._of_condition(step)
        if step.receives and not any(sender.is_taken for sender in self.steps.sending(step.receives)):
            return self.all(self.steps.sending(step.receives), step)
        if self.are_long and step.automaton.startswith(SERVICE_HANDLER_PREFIX):
            return {step: None}
        # The event comes in other states only, its receiver never takes it, or no other condition holds either.
        return {None: None}

    def _of_condition(self, step: ExploredStep) -> _Causes:
        needed = MissingValues(self.steps, step)
        if needed.sufficient:
            return self.all((write.step for write in needed.sufficient), step)
        if needed.counts and not self.are_long:
            return {None: None}
        is_followed = needed.possible and not self.are_long
        causes = self.all((write.step for write in needed.possible), step) if is_followed else {}
        return causes or {step: None}


class MissingValues:
    """The assignments that no run executes and on whose values a condition depends that never holds.

    Attributes:
        sufficient: those with whose values a term of the condition holds.
        possible: those with whose values a term of the condition might hold.
        counts: whether the condition depends on a variable that only increases or only decreases step by step.
    """

    def __init__(self, steps: ExploredSteps, step: ExploredStep) -> None:
        self.steps = steps
        self.sufficient: list[ExploredWrite] = []
        self.possible: list[ExploredWrite] = []
        self.counts = False
        self._seen: set[ExploredVariable] = set()
        for reader in _readers(steps, step):
            self._add(steps.variable(step, reader.name), reader)

    def _add(self, variable: ExploredVariable, reader: _Reader | None) -> None:
        """Add the assignments on which the value of a variable may depend.

        Args:
            reader: `None` if the condition reads the variable only as a part of other values.
        """
        if variable in self._seen:
            return
        self._seen.add(variable)
        writes = self.steps.writing(variable)
        initial = self.steps.initial(variable)
        executed = {write for write in writes if _is_executed(variable, write)}
        taken = {self._content(write) for write in executed}
        if variable.automaton:  # The initial value of a message is never received.
            taken.add(None if initial is None else _literal(initial))
        for write in writes:
            if write in executed:
                value = write.assignment.value
                for name in _names([value]):
                    self._add(self.steps.variable(write.step, name), reader if isinstance(value, Name) else None)
            elif self._content(write) not in taken - {None}:
                self._add_missing(write, reader)
        directions = {d for write in executed for d in _directions(write)}
        self.counts |= bool(directions) and directions != {BinaryOperator.ADD, BinaryOperator.SUBTRACT}

    def _content(self, write: ExploredWrite) -> _Value | ExploredVariable | None:
        """The literal or the variable that an assignment copies; `None` for other values."""
        value = write.assignment.value
        return self.steps.variable(write.step, value.identifier) if isinstance(value, Name) else _literal(value)

    def _add_missing(self, write: ExploredWrite, reader: _Reader | None) -> None:
        values = self._values(write.step, write.assignment.value, set())
        decided = {None} if reader is None or values is None else {reader.holds(value) for value in values}
        if True in decided:
            self.sufficient.append(write)
        elif None in decided:
            self.possible.append(write)

    def _values(self, step: ExploredStep, expression: Expression, seen: set[ExploredVariable]) -> set[_Value] | None:
        """The values that a literal, or a variable that gets only literals, can have; `None` for others."""
        if not isinstance(expression, Name):
            literal = _literal(expression)
            return None if literal is None else {literal}
        variable = self.steps.variable(step, expression.identifier)
        if variable in seen:
            return set()
        seen.add(variable)
        initial = self.steps.initial(variable)
        values = set[_Value]() if initial is None else self._values(step, initial, seen)
        for write in self.steps.writing(variable):
            more = self._values(write.step, write.assignment.value, seen)
            values = None if more is None or values is None else values | more
        return values


def _fixed(steps: ExploredSteps, variable: ExploredVariable) -> _Value | None:
    """The value of a variable that is never assigned; `None` for other variables."""
    initial = steps.initial(variable)
    return None if initial is None or steps.writing(variable) else _literal(initial)


def _is_executed(variable: ExploredVariable, write: ExploredWrite) -> bool:
    """Whether an assignment to a variable is executed. A machine keeps what it has stored outside of the context."""
    return write.step.is_ever_taken if variable.automaton else write.step.is_taken


def _directions(write: ExploredWrite) -> Iterator[BinaryOperator | None]:
    """The operators that change a variable in an assignment which reads the variable; `None` for further operators."""
    name = write.assignment.variable
    for part in walk(write.assignment.value):
        match part:
            case Binary(BinaryOperator.ADD | BinaryOperator.SUBTRACT as operator, left, right):
                if Name(name) in (left, right):
                    yield operator if _literal(right) is not None else None
            case Binary(_, left, right) if Name(name) in (left, right):
                yield None


def _value(expression: Expression, variables: Mapping[str, _Value]) -> object:
    """The value of an expression; `None` if it depends on further variables."""
    try:
        return evaluate(expression, variables)
    except EvaluationError:
        return None


def _conjuncts(expression: Expression) -> Iterator[Expression]:
    """The terms all of which must hold for an expression to hold."""
    match expression:
        case Binary(BinaryOperator.AND, left, right):
            yield from _conjuncts(left)
            yield from _conjuncts(right)
        case Unary(UnaryOperator.NOT, Binary(BinaryOperator.OR, left, right)):
            yield from _conjuncts(Unary(UnaryOperator.NOT, left))
            yield from _conjuncts(Unary(UnaryOperator.NOT, right))
        case _:
            yield expression


def _names(expressions: Iterable[Expression]) -> list[str]:
    return list(dict.fromkeys(part.identifier for e in expressions for part in walk(e) if isinstance(part, Name)))


def _literal(expression: Expression) -> _Value | None:
    """The value of a literal, also a negative one; `None` for other expressions."""
    if isinstance(expression, (Boolean, Integer, Real)):
        return expression.value
    value = None if any(isinstance(part, Name) for part in walk(expression)) else _value(expression, {})
    return value if isinstance(value, (bool, int, float)) else None
