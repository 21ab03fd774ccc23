# SPDX-License-Identifier: Apache-2.0
"""The types of properties: formulas about the states, paths and probabilities of a model.

A `Formula` is an expression, or it contains a part whose value a single state does not determine: a path formula, a
probability, a reward or a set of states. Operators with one of these parts as operand are `UnaryFormula`,
`BinaryFormula` and `ConditionalFormula`, so an `Expression` never contains one of these parts.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator
from typing import TypeAlias

from roaml.jani import expressions
from roaml.jani.expressions import ArrayConstructor, Derivative, Expression, Name, Selection
from roaml.jani.node import CommentedNode, Node
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.text import Span


class FilterFunction(enum.Enum):
    """The function with which a filter combines the values in its states."""

    MIN = "min"
    MAX = "max"
    SUM = "sum"
    AVG = "avg"
    COUNT = "count"
    FORALL = "∀"
    EXISTS = "∃"
    ARGMIN = "argmin"
    ARGMAX = "argmax"
    VALUES = "values"


class ProbabilityOperator(enum.Enum):
    """The minimum or maximum probability over all schedulers."""

    PMIN = "Pmin"
    PMAX = "Pmax"


class ExpectationOperator(enum.Enum):
    EMIN = "Emin"
    EMAX = "Emax"


class SteadyStateOperator(enum.Enum):
    SMIN = "Smin"
    SMAX = "Smax"


class PathQuantifier(enum.Enum):
    FORALL = "∀"
    EXISTS = "∃"


class UnaryPathOperator(enum.Enum):
    """An operator on paths: `F` (at some time), `G` (always) or `X` (in the next state). F and G are derived
    operators."""

    FINALLY = "F"
    GLOBALLY = "G"
    NEXT = "X"


class BinaryPathOperator(enum.Enum):
    """A binary operator on paths.

    `U`: the right operand holds at some time, and the left operand holds until then. `W`: the same, or the left operand
    always holds. `R`: the right operand holds until, and at the time when, the left operand holds, or the right operand
    always holds. R is a derived operator.
    """

    UNTIL = "U"
    WEAK_UNTIL = "W"
    RELEASE = "R"


class StatePredicate(enum.Enum):
    """A predicate on states that no expression can describe."""

    INITIAL = "initial"
    DEADLOCK = "deadlock"
    TIMELOCK = "timelock"


class Accumulation(enum.Enum):
    """The way in which a reward is accumulated: on every step, over time, or on leaving a state (feature
    `state-exit-rewards`)."""

    STEPS = "steps"
    TIME = "time"
    EXIT = "exit"


class Interval(CommentedNode, frozen=True):
    """The bounds of a number. A bound that is `None` does not exist; `None` for `…_exclusive` means false."""

    lower: Expression | None = None
    upper: Expression | None = None
    lower_exclusive: bool | None = None
    upper_exclusive: bool | None = None


class RewardBound(CommentedNode, frozen=True):
    """A requirement that the accumulated value of `reward` is within `bounds`."""

    reward: Expression
    accumulate: tuple[Accumulation, ...]
    bounds: Interval


class RewardInstant(CommentedNode, frozen=True):
    """The moment at which the accumulated value of `reward` reaches `instant`."""

    reward: Expression
    accumulate: tuple[Accumulation, ...]
    instant: Expression


class ProperFormula(CommentedNode, frozen=True, kw_only=True):
    """A formula that is not an expression: its value depends on more than a single state."""


class UnaryFormula(ProperFormula, frozen=True):
    operator: UnaryOperator
    operand: Formula


class BinaryFormula(ProperFormula, frozen=True):
    """A formula with two operands, such as a probability and its threshold: `Pmin(...) ≥ 0.95`."""

    operator: BinaryOperator
    left: Formula
    right: Formula


class ConditionalFormula(ProperFormula, frozen=True):
    test: Formula
    then: Formula
    otherwise: Formula


class Filter(ProperFormula, frozen=True):
    """The result of `function` on the values of `values` in the states in which `states` holds."""

    function: FilterFunction
    values: Formula
    states: Formula


class Probability(ProperFormula, frozen=True):
    operator: ProbabilityOperator
    path: Formula


class Quantified(ProperFormula, frozen=True):
    """The requirement that `path` holds on all paths, or on at least one path."""

    quantifier: PathQuantifier
    path: Formula


class Expectation(ProperFormula, frozen=True):
    """The expected value of `reward` at an instant or when `reach` holds for the first time. It is accumulated until
    then if `accumulate` is not `None`.

    An attribute is `None` if the file does not contain it.
    """

    operator: ExpectationOperator
    reward: Expression
    accumulate: tuple[Accumulation, ...] | None = None
    reach: Formula | None = None
    step_instant: Expression | None = None
    time_instant: Expression | None = None
    reward_instants: tuple[RewardInstant, ...] | None = None


class SteadyState(ProperFormula, frozen=True):
    """The long-run probability of `value` if it is a state formula; otherwise its long-run average as a reward."""

    operator: SteadyStateOperator
    value: Formula
    accumulate: tuple[Accumulation, ...] | None = None


class PathBounds(ProperFormula, frozen=True, kw_only=True):
    """Limits on the steps, the time and the rewards within which a path formula must be satisfied."""

    step_bounds: Interval | None = None
    time_bounds: Interval | None = None
    reward_bounds: tuple[RewardBound, ...] | None = None


class UnaryPath(PathBounds, frozen=True):
    operator: UnaryPathOperator
    operand: Formula


class BinaryPath(PathBounds, frozen=True):
    operator: BinaryPathOperator
    left: Formula
    right: Formula


class Predicate(ProperFormula, frozen=True):
    predicate: StatePredicate


Formula: TypeAlias = (
    Expression
    | UnaryFormula
    | BinaryFormula
    | ConditionalFormula
    | Filter
    | Probability
    | Quantified
    | Expectation
    | SteadyState
    | UnaryPath
    | BinaryPath
    | Predicate
)


class Property(CommentedNode, frozen=True):
    name: str
    expression: Formula


def children(formula: Formula) -> tuple[Formula, ...]:
    """The direct subformulas and subexpressions, including those in bounds."""
    match formula:
        case UnaryFormula():
            return (formula.operand,)
        case BinaryFormula():
            return (formula.left, formula.right)
        case ConditionalFormula():
            return (formula.test, formula.then, formula.otherwise)
        case Filter():
            return (formula.values, formula.states)
        case Probability() | Quantified():
            return (formula.path,)
        case Expectation():
            optional = (formula.reach, formula.step_instant, formula.time_instant)
            instants = formula.reward_instants or ()
            return (
                formula.reward,
                *(part for part in optional if part is not None),
                *(part for instant in instants for part in (instant.reward, instant.instant)),
            )
        case SteadyState():
            return (formula.value,)
        case UnaryPath():
            return (formula.operand, *_in_bounds(formula))
        case BinaryPath():
            return (formula.left, formula.right, *_in_bounds(formula))
        case Predicate():
            return ()
        case _:
            return expressions.children(formula)


def walk(formula: Formula) -> Iterator[Formula]:
    """`formula` and all its parts, outer before inner."""
    stack = [formula]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(reversed(children(node)))


def eventually(name: str, condition: Expression) -> Property:
    """The probability that a condition holds at some time."""
    path = UnaryPath(UnaryPathOperator.FINALLY, condition)
    probability = Probability(ProbabilityOperator.PMIN, path)
    return Property(name, Filter(FilterFunction.VALUES, probability, Predicate(StatePredicate.INITIAL)))


def identifiers(formula: Formula) -> Iterator[tuple[str, Span]]:
    """The names of the variables and constants of the model that `formula` uses, with the position of each use, in the
    order of the text.

    Names that the formula itself declares, in array constructors and selections, are left out. The position of a name
    that was not read from a file is an empty span.
    """
    stack: list[tuple[Formula, frozenset[str]]] = [(formula, frozenset())]
    while stack:
        node, bound = stack.pop()
        match node:
            case Name(identifier) if identifier not in bound:
                yield identifier, _place(node)
            case Derivative(identifier):
                yield identifier, _place(node)
            case ArrayConstructor(variable, length, body):
                stack += ((body, bound | {variable}), (length, bound))
            case Selection(variable, condition):
                stack.append((condition, bound | {variable}))
            case _:
                stack.extend((child, bound) for child in reversed(children(node)))


def _in_bounds(path: PathBounds) -> tuple[Expression, ...]:
    rewards = path.reward_bounds or ()
    intervals = (path.step_bounds, path.time_bounds, *(reward.bounds for reward in rewards))
    ends = (end for interval in intervals if interval for end in (interval.lower, interval.upper))
    return (*(reward.reward for reward in rewards), *(end for end in ends if end is not None))


def _place(node: Node) -> Span:
    return node.origin.span if node.origin else Span(0, 0)
