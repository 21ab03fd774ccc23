# SPDX-License-Identifier: Apache-2.0
"""The forms of properties that sampling can decide, determined from the property alone.

`goal.compile_property` compiles these forms; the rule `unsupported-property` reports the others before anything is run.
"""

from __future__ import annotations

from collections.abc import Iterator

from roaml.jani.nesting import is_nested
from roaml.jani.node import Node
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.properties import (
    Accumulation,
    BinaryFormula,
    BinaryPath,
    Expectation,
    Filter,
    FilterFunction,
    Formula,
    PathBounds,
    Predicate,
    Probability,
    ProperFormula,
    Property,
    StatePredicate,
    UnaryFormula,
    UnaryPath,
    walk,
)
from roaml.record import Record
from roaml.smc.fault import FaultError
from roaml.smc.normal_form import NestingError, lasting_condition

UNSUPPORTED = "unsupported-property"
"""The code under which `--check` and `verify` report an unsupported property."""
BOUNDS = "ignored-bounds"
"""The code under which bounds on time are reported."""

ANSWERED = (
    "supported are `Pmin` and `Pmax` of F, G, X, U, W and R over states, also with bounds on steps and rewards, of "
    "`F G` and `G F`, of the nested forms `G (p ⇒ F q)`, `G (p ⇒ G q)`, `G (p ⇒ (q U r))`, `G (p ⇒ (q W r))`, "
    "`G (p ∧ F r ⇒ (q U r))` and `¬p W (p ∧ …)`, all joined by ¬, ∧, ∨ and ⇒, and `Emin` and `Emax` with `accumulate` "
    "and either `reach` or `step-instant`"
)
NOT_OBSERVABLE = (
    "a path formula inside another one is supported only if all its variables have initial values and none is transient"
)
COMPARISONS = frozenset(
    (BinaryOperator.LESS, BinaryOperator.LESS_EQUAL, BinaryOperator.GREATER, BinaryOperator.GREATER_EQUAL)
)
JOINED = frozenset((BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES))
"""The operators that join path formulas."""
TIME_BOUNDS = (
    "bounds on time are supported only in nested formulas, because the time of a system is a variable: "
    "compare the fields of `topic_clock_msg` with the time instead"
)
NO_TIME = "no time passes in this kind of model, so rewards can only be accumulated on `steps` or `exit`"
_ONE_STATE = (FilterFunction.VALUES, FilterFunction.MIN, FilterFunction.MAX, FilterFunction.SUM, FilterFunction.AVG)


def faults_in(property_: Property, step: int | None = None) -> Iterator[FaultError]:
    """The reasons why sampling cannot decide `property_`, with the positions of the unsupported parts.

    Args:
        step: the step of the clock in ns; `None` if there is no clock.
    """
    for fault, node in _faults(property_.expression, step):
        code = BOUNDS if fault == TIME_BOUNDS else UNSUPPORTED
        yield FaultError(f"{fault}; {ANSWERED}", node.origin or property_.origin, code=code)


def time_bounds_in(property_: Property) -> Iterator[Node]:
    """The bounds on time, anywhere in a property."""
    for formula in walk(property_.expression):
        if isinstance(formula, (UnaryPath, BinaryPath)) and formula.time_bounds is not None:
            yield formula.time_bounds


def check_form(property_: Property) -> None:
    """Check that sampling can answer a property of this form.

    Raises:
        FaultError: sampling cannot answer the property.
    """
    for fault in faults_in(property_):
        raise fault


class Lasting(Record, frozen=True):
    """`F G condition`, or its negation `G F ¬condition`."""

    condition: Formula
    is_negated: bool


def lasting_part(formula: Formula) -> Lasting | None:
    """The parts of a formula of the form `F G c` or `G F c`; `None` for another form. `G F c` is represented by its
    negation."""
    lasting = lasting_condition(formula)
    if lasting is None:
        return None
    condition, is_lasting = lasting
    if is_lasting:
        return Lasting(condition, False)
    return Lasting(UnaryFormula(UnaryOperator.NOT, condition, origin=condition.origin), True)


def _faults(formula: Formula, step: int | None) -> Iterator[tuple[str, Node]]:
    is_compared = False
    while True:
        match formula:
            case Filter(function, values, states):
                if not isinstance(states, Predicate) or states.predicate is not StatePredicate.INITIAL:
                    yield (
                        f'{_about(states)}, but traces begin in the initial states; write `{{"op": "initial"}}`',
                        states,
                    )
                if function in (FilterFunction.FORALL, FilterFunction.EXISTS):
                    if not isinstance(values, BinaryFormula):
                        yield f"the filter `{function.value}` needs a comparison of a probability with a number", values
                elif function not in _ONE_STATE:
                    yield f"the filter `{function.value}` is not supported", formula
                formula = values
            case BinaryFormula(operator, left, right) if operator in COMPARISONS and not is_compared:
                is_compared = True
                if isinstance(left, ProperFormula) and isinstance(right, ProperFormula):
                    yield "a probability must be compared with a number", right
                formula = left if isinstance(left, ProperFormula) else right
            case Probability(_, path):
                yield from _in_path(path, step)
                return
            case Expectation():
                yield from _in_reward(formula)
                return
            case _:
                yield "this is neither a probability (`Pmin`, `Pmax`) nor an expected reward (`Emin`, `Emax`)", formula
                return


def _about(states: Formula) -> str:
    """A phrase for the `states` of a filter."""
    if isinstance(states, Predicate):
        return f"`states` of the filter is `{states.predicate.value}`"
    return "`states` of the filter is a condition"


def _in_path(path: Formula, step: int | None) -> Iterator[tuple[str, Node]]:
    """The errors in a path formula."""
    waiting = [path]
    while waiting:
        formula = waiting.pop()
        lasting = lasting_part(formula)
        if lasting is not None:
            yield from _in_state(lasting.condition)
            continue
        match formula:
            case UnaryPath() | BinaryPath() if is_nested(formula):
                yield from _in_nested(formula, step)
            case UnaryPath():
                yield from _in_bounds(formula)
                yield from _in_state(formula.operand)
            case BinaryPath():
                yield from _in_bounds(formula)
                yield from _in_state(formula.left)
                yield from _in_state(formula.right)
            case UnaryFormula(operator=UnaryOperator.NOT, operand=operand):
                waiting.append(operand)
            case BinaryFormula(operator, left, right) if operator in JOINED:
                waiting += (right, left)
            case _:
                yield from _in_state(formula)


def _in_nested(path: UnaryPath | BinaryPath, step: int | None) -> Iterator[tuple[str, Node]]:
    """The errors in a path formula that contains other path formulas."""
    from roaml.smc.nested import without_nesting  # noqa: PLC0415 - most properties are not nested

    try:
        without_nesting(path, step, lambda _: path)
    except NestingError as error:
        bounds = [
            (why, bound)
            for part in walk(path)
            if isinstance(part, (UnaryPath, BinaryPath))
            for why, bound in _in_bounds(part)
        ]
        if error.is_time and bounds:
            yield from bounds
            return
        operands = (path.operand,) if isinstance(path, UnaryPath) else (path.left, path.right)
        for operand in operands:
            yield from _in_state(operand)


def _in_state(formula: Formula) -> Iterator[tuple[str, Node]]:
    """The errors in a state formula."""
    formula = _without_negation(formula)
    if isinstance(formula, Predicate):
        if formula.predicate is not StatePredicate.DEADLOCK:
            yield f"the predicate `{formula.predicate.value}` is not supported here", formula
    elif isinstance(formula, ProperFormula):
        yield "a path formula inside another one is not supported in this form", formula


def _without_negation(formula: Formula) -> Formula:
    while isinstance(formula, UnaryFormula) and formula.operator is UnaryOperator.NOT:
        formula = formula.operand
    return formula


def _in_bounds(formula: PathBounds) -> Iterator[tuple[str, Node]]:
    assert isinstance(formula, (UnaryPath, BinaryPath))
    if formula.time_bounds is not None:
        yield TIME_BOUNDS, formula.time_bounds
    if not formula.reward_bounds:
        return
    for bound in formula.reward_bounds:
        if Accumulation.TIME in bound.accumulate:
            yield NO_TIME, bound
    for operand in (formula.operand,) if isinstance(formula, UnaryPath) else (formula.left, formula.right):
        condition = _without_negation(operand)
        if isinstance(condition, Predicate):
            yield "bounds on rewards are supported only if the operands are conditions on variables", condition


def _in_reward(formula: Expectation) -> Iterator[tuple[str, Node]]:
    if formula.accumulate is None or formula.time_instant is not None or formula.reward_instants:
        yield "only rewards that are accumulated until a condition holds or up to a step are supported", formula
    elif formula.step_instant is not None and formula.reach is not None:
        yield "`reach` and `step-instant` are not supported together", formula
    elif formula.step_instant is None and formula.reach is None:
        yield "rewards are accumulated until a condition holds (`reach`) or up to a step (`step-instant`)", formula
    elif Accumulation.TIME in formula.accumulate:
        yield NO_TIME, formula
    elif formula.reach is not None:
        yield from _in_state(formula.reach)
