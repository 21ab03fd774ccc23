# SPDX-License-Identifier: Apache-2.0
"""Replaces nested path formulas by observers of the variables of the formulas (docs/spec/properties.md#nested).

- An observer takes part in every step that can change a variable of its formula, and in the steps of the clock if the
  formula has time bounds. It neither removes nor adds steps of the model.
- The assignments of an observer are executed after all others of a step, so they read the state after the step.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import TypeAlias

from roaml.jani.expressions import Boolean
from roaml.jani.model import Action, Assignment, Edge, Function, Model, Sync
from roaml.jani.nesting import is_nested
from roaml.jani.node import Node
from roaml.jani.properties import BinaryFormula, Formula, Probability, Property, UnaryFormula, walk
from roaml.jani.rewrite import rewrite
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.observers.properties import PatternProperty, Since
from roaml.observers.properties import walk as parts_of
from roaml.record import replace
from roaml.scxml.names import CLOCK, CLOCK_ACTION, TIME_OVER_ACTION
from roaml.smc.names import variables_in
from roaml.smc.nested import ObservedFormula, without_nesting, without_nesting_before
from roaml.smc.normal_form import NestingError, lasting_condition
from roaml.to_jani.end_of_time import with_end_of_time
from roaml.to_jani.observer_parts import ObserverParts, free_prefix, next_index, with_observer

_LETTER, _TICK, _END = "__as2fm__letter", "__as2fm__tick", "__as2fm__end"
"""The actions of an observer: for a step that may change a variable, for a step of the clock, and for the last step of
the clock."""
_SILENT = "__as2fm__step_"
"""The beginning of the names of actions that silent edges get, so that observers can take part in them."""
_Step: TypeAlias = tuple[str, str]
"""The name of an automaton, and one of its actions."""


def with_state_observers(model: Model, step: int | None = None) -> Model:
    """A copy of the model in which observers replace the nested path formulas of its properties.

    A property is kept unchanged if a nested formula does not have the form of a pattern, or if it uses variables that
    are transient or have no initial value.

    Args:
        step: the step of the clock in ns; `None` if there is no clock.
    """
    properties: list[Property] = []
    for property_ in model.properties:
        model, changed = _without_nesting(model, property_, step)
        properties.append(changed)
    return replace(model, properties=tuple(properties)) if properties else model


def _without_nesting(model: Model, property_: Property, step: int | None) -> tuple[Model, Property]:
    formulas: list[ObservedFormula] = []
    placeholder = Boolean(True)

    def collect(formula: ObservedFormula) -> Formula:
        formulas.append(formula)
        return placeholder

    try:
        collected = _replaced(property_, step, collect)
        if not formulas:
            return model, collected
        # The observer decides whether the property is vacuous only if it observes a whole path formula.
        is_whole = any(
            isinstance(part, Probability) and part.path is placeholder for part in walk(collected.expression)
        )
        writer = _Writer(model, property_, has_activity=is_whole)
        changed = _replaced(property_, step, writer.observe)
    except (NestingError, EvaluationError):
        return model, property_
    return writer.model, changed


def _replaced(property_: Property, step: int | None, observe: Callable[[ObservedFormula], Formula]) -> Property:
    """The property in which formulas over the variables of observers replace the nested path formulas.

    Args:
        step: the step of the clock in ns; `None` if there is no clock.
        observe: returns the formula that replaces a nested formula.
    """

    def change(node: Node) -> Node:
        return replace(node, path=_path(node.path, step, observe)) if isinstance(node, Probability) else node

    return rewrite(property_, change)


def _path(path: Formula, step: int | None, observe: Callable[[ObservedFormula], Formula]) -> Formula:
    match path:
        case UnaryFormula(operator=operator, operand=operand):
            return UnaryFormula(operator, _path(operand, step, observe), origin=path.origin)
        case BinaryFormula(operator, left, right):
            before = without_nesting_before(path, observe)
            if before is not None:
                return before
            return BinaryFormula(operator, _path(left, step, observe), _path(right, step, observe), origin=path.origin)
    if lasting_condition(path) is None and is_nested(path):
        return without_nesting(path, step, observe)
    return path


class _Writer:
    """Adds observers of one property to a model.

    Raises:
        EvaluationError: a variable or constant of a formula has no initial value.
        NestingError: a formula reads a transient variable.
    """

    def __init__(self, model: Model, property_: Property, *, has_activity: bool) -> None:
        self.model = model
        self.property = property_
        self.has_activity = has_activity
        self.functions = {function.name: function for function in model.functions}
        self.initial = _initial_values(model, self.functions)

    def observe(self, formula: ObservedFormula) -> Formula:
        """Add an observer for `formula`, and return the path formula that is true if `formula` holds."""
        is_timed = _reads_time(formula)
        if is_timed:
            self.model = with_end_of_time(self.model)
        model, origin, conditions = self.model, self.property.origin, dict(formula.conditions)
        prefix = free_prefix(self.property.name, model)
        has_clock = any(automaton.name == CLOCK for automaton in model.automata)
        parts = ObserverParts(formula.property, prefix, origin, has_clock=has_clock, has_activity=self.has_activity)
        names = {name for condition in conditions.values() for name in variables_in(condition, self.functions)}
        if any(variable.transient and variable.name in names for variable in model.variables):
            raise NestingError
        at_start = {
            name: bool(evaluate(condition, self.initial, self.functions)) for name, condition in conditions.items()
        }
        model = _with_named_steps(model, names)
        index = next_index(model)
        elements = [element.automaton for element in model.system.elements]
        writing = _writing_steps(model, names)
        edges: dict[str, tuple[Assignment, ...]] = {}
        syncs: list[Sync] = []
        for sync in model.system.syncs:
            action = _action_of(sync, elements, writing, is_timed=is_timed, has_end=parts.is_timed)
            if action and action not in edges:
                is_end, is_tick = action == _END, action == _TICK
                letter = parts.end_of_time(index) if is_end else parts.letter(conditions, index, is_tick=is_tick)
                edges[action] = tuple(letter)
            observer = ((len(model.system.elements), action),) if action else ()
            syncs.append(replace(sync, participants=(*sync.participants, *observer)))
        self.model = with_observer(model, prefix, edges, parts.variables(at_start), syncs, origin)
        return parts.path()


def _reads_time(formula: ObservedFormula) -> bool:
    property_ = formula.property
    if isinstance(property_, PatternProperty):
        return not property_.window.is_unbounded
    return any(isinstance(part, Since) and not part.window.is_unbounded for part in parts_of(property_.formula))


def _initial_values(model: Model, functions: Mapping[str, Function]) -> dict[str, Value]:
    """The initial values of the constants and variables whose initial values are known."""
    values: dict[str, Value] = {}
    declared = [(constant.name, constant.value) for constant in model.constants]
    declared += [(variable.name, variable.initial_value) for variable in model.variables]
    for name, expression in declared:
        if expression is not None:
            try:
                values[name] = evaluate(expression, values, functions)
            except EvaluationError:
                continue  # A formula that reads the variable has no initial value, and is reported.
    return values


def _action_of(
    sync: Sync, elements: Sequence[str], writing: AbstractSet[_Step], *, is_timed: bool, has_end: bool
) -> str:
    """The action of an observer in a synchronisation; "" if the observer does not take part.

    Args:
        elements: the names of the automata of the elements of the system.
        writing: the steps that can change a variable of the formula.
        is_timed: whether the observer takes part in the steps of the clock.
        has_end: whether the observer takes part in the last step of the clock.
    """
    steps = {(elements[i], action) for i, action in sync.participants}
    if is_timed and (CLOCK, CLOCK_ACTION) in steps:
        return _TICK
    if has_end and (CLOCK, TIME_OVER_ACTION) in steps:
        return _END
    return "" if writing.isdisjoint(steps) else _LETTER


def _writing_steps(model: Model, names: AbstractSet[str]) -> set[_Step]:
    """The steps that assign a variable in `names`."""
    return {
        (automaton.name, edge.action)
        for automaton in model.automata
        for edge in automaton.edges
        if edge.action is not None and _writes(edge, names)
    }


def _writes(edge: Edge, names: AbstractSet[str]) -> bool:
    return any(a.variable in names for destination in edge.destinations for a in destination.assignments)


def _with_named_steps(model: Model, names: AbstractSet[str]) -> Model:
    """A copy of the model in which silent edges that assign a variable in `names` have actions."""
    automata, syncs, actions = [], list(model.system.syncs), list(model.actions)
    for automaton in model.automata:
        if not any(edge.action is None and _writes(edge, names) for edge in automaton.edges):
            automata.append(automaton)
            continue
        action = f"{_SILENT}{len(actions)}"
        actions.append(Action(action))
        edges = tuple(
            replace(edge, action=action) if edge.action is None and _writes(edge, names) else edge
            for edge in automaton.edges
        )
        automata.append(replace(automaton, edges=edges))
        for i, element in enumerate(model.system.elements):
            if element.automaton == automaton.name:
                syncs.append(Sync(((i, action),)))
    system = replace(model.system, syncs=tuple(syncs))
    return replace(model, automata=tuple(automata), system=system, actions=tuple(actions))
