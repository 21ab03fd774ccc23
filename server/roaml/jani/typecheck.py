# SPDX-License-Identifier: Apache-2.0
"""Checks the names and types in all expressions of a model, in a property or in a single expression.

- The findings have the codes `jani-name` and `jani-type`. Their positions are the origins of the parts of the model.
- The check needs only the model, so the models of the translation are checked in the same way as those of the reader.
"""

from __future__ import annotations

from collections.abc import Iterable

from roaml.diagnostics import Finding
from roaml.jani.deep import run
from roaml.jani.expressions import Expression, Name
from roaml.jani.infer import Inference, PathKind, TypeScope, span_of
from roaml.jani.model import Assignment, Automaton, Clause, Edge, Function, Model, TransientValue, Variable
from roaml.jani.node import Node
from roaml.jani.properties import Property
from roaml.jani.types import (
    BOOL,
    INT,
    REAL,
    UNKNOWN,
    ArrayType,
    BoundedType,
    DatatypeType,
    OptionType,
    Type,
    describe,
    fits,
    value_type,
)
from roaml.record import replace


def model_scope(model: Model) -> TypeScope:
    """The names that can be used everywhere in `model`, including its properties."""
    constants = {constant.name: constant.type for constant in model.constants}
    return TypeScope(
        {**constants, **{variable.name: variable.type for variable in model.variables}},
        {function.name: function for function in model.functions},
        {datatype.name: datatype for datatype in model.datatypes},
        frozenset(constants),
    )


def automaton_scope(scope: TypeScope, automaton: Automaton) -> TypeScope:
    """The names that can be used in `automaton`, an automaton of the model with the scope `scope`."""
    if not automaton.variables and not automaton.functions:
        return scope
    local = {variable.name: variable.type for variable in automaton.variables}
    functions = {function.name: function for function in automaton.functions}
    return replace(
        scope,
        variables={**scope.variables, **local},
        functions={**scope.functions, **functions},
        constants=scope.constants - local.keys(),
    )


def expression_type(expression: Expression, scope: TypeScope) -> tuple[Type, tuple[Finding, ...]]:
    """The type of `expression`, and findings for the errors in it."""
    checker = _Checker(scope)
    type_ = run(checker.type(expression, {}))
    return type_, checker.notes.findings


def check_property(property_: Property, scope: TypeScope) -> tuple[Finding, ...]:
    """Findings for the errors in names and types in `property_`."""
    checker = _Checker(scope)
    checker.property(property_)
    return checker.notes.findings


def check_model(model: Model) -> tuple[Finding, ...]:
    """Findings for the errors in names and types in the expressions of `model`."""
    scope = model_scope(model)
    checker = _Checker(scope)
    for constant in model.constants:
        checker.declared(constant.type, constant)
        checker.store(constant.value, constant.type, f"the constant `{constant.name}`")
    for datatype in model.datatypes:
        for member in datatype.members:
            checker.declared(member.type, member)
    checker.variables(model.variables)
    checker.functions(model.functions)
    checker.clause(model.restrict_initial, BOOL, "the restriction of initial states")
    for property_ in model.properties:
        checker.property(property_)
    for automaton in model.automata:
        checker.automaton(automaton, scope)
    return checker.notes.findings


class _Checker(Inference):
    """Checks a model."""

    def automaton(self, automaton: Automaton, scope: TypeScope) -> None:
        self.scope = automaton_scope(scope, automaton)
        self.variables(automaton.variables)
        self.functions(automaton.functions)
        self.clause(automaton.restrict_initial, BOOL, "the restriction of initial states")
        for location in automaton.locations:
            self.clause(location.time_progress, BOOL, "the condition for time progress")
            for value in location.transient_values:
                self.assignment(value)
        for edge in automaton.edges:
            self.edge(edge)
        self.scope = scope

    def edge(self, edge: Edge) -> None:
        self.clause(edge.guard, BOOL, "a guard")
        self.clause(edge.rate, REAL, "a rate")
        for destination in edge.destinations:
            self.clause(destination.probability, REAL, "a probability")
            for assignment in destination.assignments:
                self.assignment(assignment)

    def assignment(self, assignment: Assignment | TransientValue) -> None:
        target = assignment.target
        type_ = run(self.type(target, {}))
        name = f"`{target.identifier}`" if isinstance(target, Name) else "this"
        if isinstance(target, Name) and target.identifier in self.scope.constants:
            self.notes.type(span_of(target), f"{name} is a constant and cannot be assigned to")
            type_ = UNKNOWN
        self.store(assignment.value, type_, name)

    def variables(self, variables: Iterable[Variable]) -> None:
        for variable in variables:
            self.declared(variable.type, variable)
            self.store(variable.initial_value, variable.type, f"`{variable.name}`")

    def functions(self, functions: Iterable[Function]) -> None:
        for function in functions:
            self.declared(function.type, function)
            for parameter in function.parameters:
                self.declared(parameter.type, parameter)
            parameters = {parameter.name: parameter.type for parameter in function.parameters}
            body_type = run(self.type(function.body, parameters))
            if not fits(body_type, function.type):
                message = f"`{function.name}` must return {describe(function.type)}, not {describe(body_type)}"
                self.notes.type(span_of(function.body), message)

    def declared(self, type_: Type, declaration: Node) -> None:
        """Check the type of a declaration: its datatypes must exist, and its bounds must be numbers."""
        while isinstance(type_, (ArrayType, OptionType)):
            type_ = type_.element if isinstance(type_, ArrayType) else type_.content
        if isinstance(type_, DatatypeType) and type_.name and type_.name not in self.scope.datatypes:
            self.notes.unknown("datatype", type_.name, span_of(declaration), self.scope.datatypes, fix=False)
        if isinstance(type_, BoundedType):
            for bound in (type_.lower, type_.upper):
                self.store(bound, type_.base, "a bound of this type")

    def store(self, value: Expression | None, target: Type, subject: str) -> None:
        """Check that `value` can be stored in a variable of type `target`. `subject` names it in the message."""
        if value is None:
            return
        given = run(self.type(value, {}))
        if not fits(given, target):
            is_rounding = (value_type(target), value_type(given)) == (INT, REAL)
            advice = "; use `floor` or `ceil` for an int" if is_rounding else ""
            self.notes.type(span_of(value), f"{subject} must be {describe(target)}, not {describe(given)}{advice}")

    def clause(self, clause: Clause | None, target: Type, subject: str) -> None:
        if clause is not None:
            self.expect(clause.exp, run(self.type(clause.exp, {})), target, subject)

    def property(self, property_: Property) -> None:
        kind = run(self.formula(property_.expression))
        if isinstance(kind, PathKind):
            self.expect(property_.expression, kind, BOOL, "a property")
