# SPDX-License-Identifier: Apache-2.0
"""The rule `decided-at-start`, which decided_at_start.md describes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from roaml.diagnostics import Finding, Fix, Related, Severity
from roaml.expr.tree import Name as Variable
from roaml.expr.tree import walk
from roaml.expr.types import BOOL, INT, Scalar, is_kind
from roaml.jani.expressions import Binary, Boolean, Integer, Name, Real, Unary
from roaml.jani.operators import BinaryOperator, Signature, UnaryOperator
from roaml.jani.properties import (
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    Filter,
    Formula,
    PathBounds,
    Probability,
    UnaryFormula,
    UnaryPath,
    UnaryPathOperator,
    identifiers,
)
from roaml.json_syntax import JsonString
from roaml.model.globals import GlobalVariable
from roaml.model.property_file import WrittenProperty
from roaml.model.property_links import LinkedFile
from roaml.model.syntax import Expression
from roaml.model.values.domain import FALSE, TRUE, ValueSet
from roaml.model.values.evaluate import Evaluator
from roaml.observers.properties import Pattern, ScopeKind
from roaml.rules.rule import PropertiesContext, Rule
from roaml.rules.support.jani_formulas import operator_at
from roaml.scxml.names import FLAG, flagged_by
from roaml.text import TextEdit

NEVER = "so the property never holds; did you mean another pattern or condition?"
ALWAYS = "so the property always holds; did you mean another initial value or condition?"


def check(file: LinkedFile) -> Iterator[Finding]:
    """Report conditions whose values at the start of a trace, which are those in `expr`, decide a property."""
    known: dict[str, ValueSet] = {}
    evaluator = Evaluator(lambda _: False)
    for _, variable in file.file.variables:
        initial = variable.initial
        if variable.id is not None and initial is not None and not initial.broken:
            known[variable.id.value] = evaluator.values({}, initial.tree)
    for written in file.file.properties:
        decisive = _decisive(written)
        if decisive is None or decisive[0].broken:
            continue
        condition, value, effect = decisive
        if evaluator.values(known, condition.tree) == (TRUE if value else FALSE):
            state = "true" if value else "false"
            message = f"this is {state} at the start, with the initial values of the variables, {effect}"
            names = {node.name for node in walk(condition.tree) if isinstance(node, Variable)}
            related = [
                Related(variable.initial.span, f"the initial value of `{variable.id.value}`")
                for _, variable in file.file.variables
                if variable.id is not None and variable.id.value in names and variable.initial is not None
            ]
            yield RULE.at(condition.span, message, related=related)


def _decisive(written: WrittenProperty) -> tuple[Expression, bool, str] | None:
    """The condition of a property over whole traces that decides it if it has a value at their start: the condition,
    this value and the effect."""
    scope = written.scopes[0].type if len(written.scopes) == 1 else None
    is_bounded = any(interval.after is not None for interval in written.intervals)
    pattern = written.pattern.value if written.pattern is not None else ""
    if scope is None or scope.value != ScopeKind.GLOBALLY.value or is_bounded or not written.conditions:
        return None
    first = written.conditions[0]
    match pattern:
        case Pattern.ABSENCE.value:
            return first, True, NEVER
        case Pattern.UNIVERSALITY.value:
            return first, False, NEVER
        case Pattern.EXISTENCE.value:
            return first, True, ALWAYS
        case Pattern.PRECEDENCE.value if not written.intervals:
            return first, True, ALWAYS
    return None


def check_jani(context: PropertiesContext) -> Iterator[Finding]:
    """Report path formulas whose value in the initial state, in which no event has been sent, decides them."""
    for property_ in context.properties:
        formula = property_.expression
        while isinstance(formula, (Filter, Probability)):
            formula = formula.values if isinstance(formula, Filter) else formula.path
        part, value, effect = _decisive_part(formula)
        if part is None or formula.origin is None or not any(identifiers(part)):
            continue
        if _at_start(part, context.variables or {}) is not value:
            continue
        operator = operator_at(context.value, formula.origin.span)
        if operator is not None:
            state = "true" if value else "false"
            message = f"the operand is {state} at the start of every trace, before any event is sent, {effect}"
            yield RULE.at(operator.span, message, *_fixes(operator))


def _fixes(operator: JsonString) -> Iterator[Fix]:
    """The change of `G` to `F`, or of `F` to `G`."""
    other = {"G": "F", "F": "G"}.get(operator.value)
    if other is not None:
        yield Fix(f"Change to `{other}`", (TextEdit(operator.content_span, other),), preferred=True)


def _decisive_part(formula: Formula) -> tuple[Formula | None, bool, str]:
    """The part of a path formula that decides it if it has a value in the first state: the part, this value and the
    effect."""
    if isinstance(formula, PathBounds) and (formula.step_bounds or formula.time_bounds or formula.reward_bounds):
        return None, False, ""
    match formula:
        case UnaryPath(operator=UnaryPathOperator.GLOBALLY, operand=operand):
            return operand, False, "so `G` never holds; did you mean `F`?"
        case UnaryPath(operator=UnaryPathOperator.FINALLY, operand=operand):
            return operand, True, "so `F` always holds; did you mean `G`?"
        case BinaryPath(operator=BinaryPathOperator.UNTIL, right=right):
            return right, True, "so `U` always holds"
    return None, False, ""


def _at_start(formula: Formula, variables: Mapping[str, GlobalVariable]) -> bool | None:
    """The value of a formula in the first state, as far as the flags and parameters of events determine it. Before an
    event is sent, its parameters are 0 or false (docs/spec/jani.md#global-variables)."""
    match formula:
        case Boolean(value):
            return value
        case Name(identifier) if flagged_by(identifier) or _is_parameter(variables, identifier, BOOL):
            return False
        case (
            Unary(operator=UnaryOperator.NOT, operand=operand)
            | UnaryFormula(operator=UnaryOperator.NOT, operand=operand)
        ):
            inner = _at_start(operand, variables)
            return None if inner is None else not inner
        case Binary(operator=operator, left=left, right=right) if operator.signature in _COMPARING:
            numbers = [_number(side, variables) for side in (left, right)]
            return None if None in numbers else bool(operator.function(*numbers))
        case (
            Binary(operator=operator, left=left, right=right) | BinaryFormula(operator=operator, left=left, right=right)
        ):
            return _joined(operator, _at_start(left, variables), _at_start(right, variables))
    return None


_COMPARING = (Signature.EQUALITY, Signature.ORDER)


def _number(formula: Formula, variables: Mapping[str, GlobalVariable]) -> float | None:
    match formula:
        case Integer(value) | Real(value):
            return value
        case Name(identifier) if _is_parameter(variables, identifier, INT):
            return 0
    return None


def _is_parameter(variables: Mapping[str, GlobalVariable], name: str, type_: Scalar) -> bool:
    known = variables.get(name)
    return known is not None and known.parameter != FLAG and is_kind(known.type, type_.kind)


def _joined(operator: BinaryOperator, left: bool | None, right: bool | None) -> bool | None:
    if operator is BinaryOperator.IMPLIES:
        operator, left = BinaryOperator.OR, None if left is None else not left
    if operator is BinaryOperator.AND:
        return False if False in (left, right) else True if left and right else None
    if operator is BinaryOperator.OR:
        return True if True in (left, right) else False if (left, right) == (False, False) else None
    return None


RULE = Rule(
    "decided-at-start",
    Severity.WARNING,
    "The initial values decide a property before anything happens.",
    properties=check_jani,
    xml_properties=check,
)
