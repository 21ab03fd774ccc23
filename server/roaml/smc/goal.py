# SPDX-License-Identifier: Apache-2.0
"""Compiles a property to a goal, which is evaluated on each trace, and a question about all traces.

Every path operator becomes an until: `F b` is `true U b`, `G b` is `¬F ¬b`, `a R b` is `¬(¬a U ¬b)`, `X b` is `F` with
exactly one step, and `a W b` is `(a U b) ∨ ¬F ¬a`, the second part with the upper bound only. `F G b` is evaluated in
the state in which a trace stays.
"""

from __future__ import annotations

import enum
import math
from array import array

from roaml.jani.expressions import Binary, Conditional, Expression, Integer, Name, Unary
from roaml.jani.model import ModelType
from roaml.jani.operators import BinaryOperator, UnaryOperator
from roaml.jani.properties import (
    Accumulation,
    BinaryFormula,
    BinaryPath,
    BinaryPathOperator,
    Expectation,
    Filter,
    FilterFunction,
    Formula,
    Interval,
    PathBounds,
    Predicate,
    Probability,
    ProbabilityOperator,
    ProperFormula,
    Property,
    RewardBound,
    StatePredicate,
    UnaryFormula,
    UnaryPath,
    UnaryPathOperator,
    identifiers,
    walk,
)
from roaml.jani.semantics import EvaluationError, evaluate
from roaml.record import Record, replace
from roaml.smc.compile import Compilation
from roaml.smc.fault import FaultError
from roaml.smc.forms import NOT_OBSERVABLE, UNSUPPORTED, Lasting, check_form, lasting_part
from roaml.smc.names import Storage
from roaml.smc.program import AT_END, Goal
from roaml.smc.registers import Operand
from roaml.smc.sums import conditions_of, limit_of, sum_names

TRUE, FALSE, DEADLOCK, NO_DEADLOCK, STUCK = -1, -2, -3, -4, -5
NOT, AND, OR = -1, -2, -3

_MIRRORED = {
    BinaryOperator.LESS: BinaryOperator.GREATER,
    BinaryOperator.LESS_EQUAL: BinaryOperator.GREATER_EQUAL,
    BinaryOperator.GREATER: BinaryOperator.LESS,
    BinaryOperator.GREATER_EQUAL: BinaryOperator.LESS_EQUAL,
}
"""Comparison -> the operator with the same meaning after an exchange of the two sides."""


class Threshold(Record, frozen=True):
    """A comparison with a number, such as `≥ 0.95` in `P(...) ≥ 0.95`."""

    relation: BinaryOperator
    number: float

    def met(self, value: float) -> bool:
        return bool(self.relation.function(value, self.number))

    @property
    def is_lower(self) -> bool:
        """Whether values above the threshold satisfy it."""
        return self.relation in (BinaryOperator.GREATER, BinaryOperator.GREATER_EQUAL)


UNIFORMLY = "under uniform choices"
"""Where the value comes from of traces that choose each possible step with the same probability."""


class InitialFold(enum.Enum):
    """How a property combines the values of several initial states (docs/spec/properties.md#initial-states)."""

    CHOICE = "choice"
    """The scheduler chooses the initial state: the least minimum, the greatest maximum, the mean of uniform values."""
    MINIMUM = "min"
    MAXIMUM = "max"
    MEAN = "avg"


class Question(Record, frozen=True):
    """What a property asks about all traces, such as the minimum of a probability.

    Attributes:
        name: the name of the property.
        operator: `Pmin`, `Pmax`, `Emin` or `Emax`.
        is_reward: whether it is about an expected reward, not a probability.
        threshold: the comparison of the value with a number; `None` if the property asks for the value.
        variables: the variables that the property reads.
        is_stuck: whether it is about stuck traces (`compile_stuck`).
        can_be_vacuous: whether there may be traces that do not exercise the property (`Activity`).
        can_be_late, trigger, scope: see `ObserverOutputs`.
        is_conditional: whether it is only about traces that satisfy assumptions; for a reward, about traces that reach
            its condition.
        initial_states: the number of initial states.
        fold: how the property combines their values.
        is_deterministic: whether the model has no nondeterminism, except for its initial states.
    """

    name: str
    operator: str
    is_reward: bool
    threshold: Threshold | None
    variables: tuple[str, ...]
    is_stuck: bool = False
    can_be_vacuous: bool = False
    can_be_late: bool = False
    is_conditional: bool = False
    initial_states: int = 1
    fold: InitialFold = InitialFold.CHOICE
    trigger: str = ""
    scope: str = ""
    is_deterministic: bool = False

    @property
    def average(self) -> str:
        """Of what traces estimate the value, as an adverbial phrase: they choose a step, and an initial state, at
        random."""
        return "on average over the initial states" if self.is_deterministic else UNIFORMLY

    @property
    def outcomes(self) -> tuple[str, str]:
        """The words for traces in which the property holds, and for those in which it fails. A reward is not tested:
        its traces reach its condition or do not."""
        if self.is_stuck:
            return "stuck", "not stuck"
        return ("reached", "not reached") if self.is_reward else ("passed", "failed")

    @property
    def is_minimised(self) -> bool:
        """Whether the property asks for the minimum over all schedulers."""
        return self.operator.endswith("min")

    @property
    def asks_for_extreme_state(self) -> bool:
        """Whether the property asks for the extreme value of several initial states. Traces with uniform choices have
        the mean of these values."""
        return self.initial_states > 1 and self.fold is not InitialFold.MEAN

    @property
    def has_opposite_extremes(self) -> bool:
        """Whether the property asks for the maximum over the initial states and the minimum over the schedulers, or for
        the reverse. The value of a scheduler that chooses the initial state at random is then no bound."""
        opposite = InitialFold.MAXIMUM if self.is_minimised else InitialFold.MINIMUM
        return self.initial_states > 1 and self.fold is opposite


class Activity(enum.IntEnum):
    """How far a trace has exercised a property. The kernel uses the same numbers."""

    CLOSED = 0
    """The scope of the property was never evaluated, so the trace does not exercise the property."""
    IDLE = 1
    """The scope was evaluated, but the event that triggers the property, such as a request, never occurred in it."""
    TRIGGERED = 2
    """The event occurred; or the scope was evaluated, and the property does not depend on an event."""


class CompiledProperty(Record, frozen=True):
    """A property with its question and its goal, and the goal of its assumptions if it has any. `given` is the property
    that states the assumptions."""

    property: Property
    question: Question
    goal: Goal
    assumptions: Goal | None = None
    given: Property | None = None


class ObserverOutputs(Record, frozen=True):
    """Expressions over the variables of a property's observer; `None` if the observer does not store the value.

    Attributes:
        open: pairs (x, e): if e holds at the end of the model's time, `F G c` is undecided for each condition c that
            reads the variable x.
        triggered: whether the event that triggers the property has occurred.
        opened: whether the scope of the property has been evaluated.
        can_be_late: whether the property fails if the time ends before an event that it still requires.
        trigger, scope: the conditions of the property that must hold for `triggered` and `opened`, as text; "" if they
            are not known.
    """

    open: tuple[tuple[str, Name], ...] = ()
    triggered: Expression | None = None
    opened: Expression | None = None
    can_be_late: bool = False
    trigger: str = ""
    scope: str = ""

    @property
    def expressions(self) -> tuple[Expression, ...]:
        activity = tuple(expression for expression in (self.triggered, self.opened) if expression is not None)
        return (*(expression for _, expression in self.open), *activity)


NO_OUTPUTS = ObserverOutputs()


def compile_property(
    compilation: Compilation, property_: Property, outputs: ObserverOutputs = NO_OUTPUTS
) -> CompiledProperty:
    """Compile a property.

    Args:
        outputs: the outputs of its observer.

    Raises:
        FaultError: the property has a form that sampling cannot answer, or contains a comparison with something other
            than a number.
    """
    check_form(property_)
    return _Writer(compilation, property_, outputs).compiled_property()


def conditional(property_: CompiledProperty, assumptions: CompiledProperty) -> CompiledProperty:
    """A copy of `property_` that is restricted to traces that satisfy `assumptions`. A reward is restricted to traces
    that reach its condition, which its own goal decides.

    Raises:
        FaultError: a reward is to be restricted otherwise.
    """
    question = replace(property_.question, is_conditional=True)
    if not question.is_reward:
        return replace(property_, question=question, assumptions=assumptions.goal, given=assumptions.property)
    if _reached(property_.property) is None or _reached(property_.property) != _reached(assumptions.property):
        message = (
            "a reward until a condition can only be restricted to traces that reach this condition, as in "
            '`R{"steps"}=? [ F done || F done ]`'
        )
        raise FaultError(message, property_.property.origin, code=UNSUPPORTED)
    return replace(property_, question=question)


def _reached(property_: Property) -> Formula | None:
    """The condition c of a reward until c, or of the probability of `F c` without bounds; `None` for others."""
    for formula in walk(property_.expression):
        match formula:
            case Expectation(reach=reach):
                return reach
            case Probability(path=UnaryPath(operator=UnaryPathOperator.FINALLY, operand=operand) as path):
                is_bounded = path.step_bounds or path.time_bounds or path.reward_bounds
                return None if is_bounded else operand
    return None


STUCK_PROPERTY = "stuck"
"""The name of the property that every model has: the probability that a trace gets stuck."""


def compile_stuck(compilation: Compilation) -> CompiledProperty:
    """The question about the probability that a trace gets stuck (`end.End.STUCK`): the automata wait for one another,
    and nothing can ever change. Every trace runs to its end."""
    # JANI has no predicate for this; `deadlock` is the closest one.
    path = UnaryPath(UnaryPathOperator.FINALLY, Predicate(StatePredicate.DEADLOCK))
    states = Predicate(StatePredicate.INITIAL)
    formula = Filter(FilterFunction.VALUES, Probability(ProbabilityOperator.PMAX, path), states)
    goal = Goal(
        seen_start=array("i", [0] * (len(compilation.watched) + 1)),
        seen_leaf=array("i"),
        left=array("i", [TRUE]),
        right=array("i", [STUCK]),
        lower=array("q", [0]),
        upper=array("q", [-1]),
        formula=array("i", [0]),
        formula_start=array("i", [0, 1]),
        leaf_start=array("i", [0, 1]),
        activity=array("i", [-1]),
        is_bounded=0,
        step_reward=-1,
        exit_reward=-1,
        sum_register=array("i"),
        sum_watch=array("i"),
        sum_step=array("i"),
        sum_exit=array("i"),
        sum_limit=array("d"),
    )
    question = Question(
        STUCK_PROPERTY,
        ProbabilityOperator.PMAX.value,
        False,
        None,
        (),
        is_stuck=True,
        initial_states=compilation.initial_states,
    )
    return CompiledProperty(Property(STUCK_PROPERTY, formula), question, goal)


class _Writer:
    def __init__(self, compilation: Compilation, property_: Property, outputs: ObserverOutputs) -> None:
        self.compilation = compilation
        self.outputs = outputs
        self.names = compilation.layout.names
        self.property = property_
        self.sums = sum_names(property_)
        self.left: list[int] = []
        self.right: list[int] = []
        self.lower: list[int] = []
        self.upper: list[int] = []
        self.formula: list[int] = []
        self.conditions: list[Formula] = []
        self.read: list[set[str]] = []
        self.unread: set[str] = set()
        self.is_bounded = 0

    def compiled_property(self) -> CompiledProperty:
        formula, threshold, function = self.opened(self.property.expression)
        step_reward = exit_reward = -1
        match formula:
            case Probability(operator, path):
                self.path(path)
                name = operator.value
            case Expectation(operator):
                step_reward, exit_reward = self.expectation(formula)
                name = operator.value
            case _:
                raise AssertionError("`check_form` rejects all other forms")
        variables = self.variables()
        outputs = self.outputs
        question = Question(
            self.property.name,
            name,
            isinstance(formula, Expectation),
            threshold,
            variables,
            can_be_vacuous=outputs.triggered is not None or outputs.opened is not None,
            can_be_late=outputs.can_be_late,
            initial_states=self.compilation.initial_states,
            fold=self.fold(function, threshold),
            trigger=outputs.trigger,
            scope=outputs.scope,
            is_deterministic=self.compilation.model.type is ModelType.DTMC,
        )
        seen_start, seen_leaf = array("i", [0]), array("i")
        for storage in self.compilation.watched:
            seen_leaf.extend(leaf for leaf, names in enumerate(self.read) if storage.name in names)
            seen_start.append(len(seen_leaf))
        goal = Goal(
            seen_start=seen_start,
            seen_leaf=seen_leaf,
            left=array("i", self.left),
            right=array("i", self.right),
            lower=array("q", self.lower),
            upper=array("q", self.upper),
            formula=array("i", self.formula),
            formula_start=array("i", [0, len(self.formula)]),
            leaf_start=array("i", [0, len(self.left)]),
            activity=array("i", [self.activity()]),
            is_bounded=self.is_bounded,
            step_reward=step_reward,
            exit_reward=exit_reward,
            sum_register=array("i", [self.storage(name).base for name in self.sums.values()]),
            sum_watch=array("i", [self.storage(name).watch for name in self.sums.values()]),
            sum_step=array("i", [self.sum_code(bound, Accumulation.STEPS) for bound in self.sums]),
            sum_exit=array("i", [self.sum_code(bound, Accumulation.EXIT) for bound in self.sums]),
            sum_limit=array("d", [limit_of(bound.bounds, self.limit) for bound in self.sums]),
        )
        return CompiledProperty(self.property, question, goal)

    def activity(self) -> int:
        """The address of the code that computes the activity of the property in a trace; -1 if the activity is always
        `TRIGGERED`."""
        triggered, opened = self.outputs.triggered, self.outputs.opened
        if triggered is None and opened is None:
            return -1
        # Without an event that triggers it, a property is triggered when its scope is evaluated.
        value: Expression = Integer(Activity.TRIGGERED)
        if triggered is not None:
            value = Conditional(triggered, value, Integer(Activity.IDLE))
        if opened is not None:
            value = Conditional(opened, value, Integer(Activity.CLOSED))
        return self.compilation.expressions.integer(value, self.names)

    def variables(self) -> tuple[str, ...]:
        names = dict.fromkeys(name for formula in self.conditions for name, _ in identifiers(formula))
        return tuple(name for name in names if not isinstance(self.names.values.get(name), Operand))

    def opened(self, formula: Formula) -> tuple[Formula, Threshold | None, FilterFunction]:
        """Remove filters and the comparison with a number. Return the probability or reward in them, the comparison,
        and the function of the innermost filter: to others, its result is the value of every initial state."""
        threshold: Threshold | None = None
        function = FilterFunction.VALUES
        while True:
            match formula:
                case Filter():
                    function = formula.function
                    formula = formula.values
                case BinaryFormula(operator, left, right) if operator in _MIRRORED and threshold is None:
                    if isinstance(left, ProperFormula):
                        formula, other = left, right
                    else:
                        formula, other, operator = right, left, _MIRRORED[operator]
                    threshold = Threshold(operator, self.number(other))
                case _:
                    return formula, threshold, function

    def fold(self, function: FilterFunction, threshold: Threshold | None) -> InitialFold:
        """How a filter combines the values of the initial states.

        Raises:
            FaultError: it adds the values of several initial states.
        """
        if function is FilterFunction.SUM and self.compilation.initial_states > 1:
            message = "the filter `sum` adds the values of several initial states; use `avg`, `min` or `max`"
            raise FaultError(message, self.property.origin, code=UNSUPPORTED)
        if function in _FOLDS:
            return _FOLDS[function]
        if threshold is None:
            return InitialFold.CHOICE
        is_minimum = threshold.is_lower is not (function is FilterFunction.EXISTS)
        return InitialFold.MINIMUM if is_minimum else InitialFold.MAXIMUM

    def number(self, formula: Formula) -> float:
        """The value of an expression that does not depend on the state."""
        assert not isinstance(formula, ProperFormula)
        try:
            value = evaluate(formula, self.names.constants(), self.names.functions)
        except EvaluationError as error:
            raise FaultError(error.message, error.origin or formula.origin) from None
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise FaultError("a number is required here", formula.origin)
        return value

    # ------------------------------------------------------------ paths

    def path(self, formula: Formula) -> None:
        """Write a path formula. Its value is then on top of the stack."""
        lasting = lasting_part(formula)
        if lasting is not None:
            self.at_end(lasting)
            return
        match formula:
            case UnaryPath(operator=operator, operand=operand):
                lower, upper = self.bounds(formula)
                within, reached = conditions_of(formula, self.sums, self.limit)
                match operator:
                    case UnaryPathOperator.FINALLY:
                        self.until(self.all(within), self.condition(operand, reached), lower, upper)
                    case UnaryPathOperator.GLOBALLY:
                        self.until(self.all(within), self.condition(operand, reached, negated=True), lower, upper)
                        self.formula.append(NOT)
                    case UnaryPathOperator.NEXT:
                        self.until(TRUE, self.condition(operand, reached), 1, 1)
            case BinaryPath(operator=operator, left=left, right=right):
                lower, upper = self.bounds(formula)
                within, reached = conditions_of(formula, self.sums, self.limit)
                match operator:
                    case BinaryPathOperator.UNTIL:
                        self.until(self.condition(left, within), self.condition(right, reached), lower, upper)
                    case BinaryPathOperator.WEAK_UNTIL:
                        self.until(self.condition(left, within), self.condition(right, reached), lower, upper)
                        self.until(self.all(within), self.condition(left, within, negated=True), 0, upper)
                        self.formula += (NOT, OR)
                    case BinaryPathOperator.RELEASE:
                        condition = self.condition(left, within, negated=True)
                        self.until(condition, self.condition(right, reached, negated=True), lower, upper)
                        self.formula.append(NOT)
            case UnaryFormula(operator=UnaryOperator.NOT, operand=operand):
                self.path(operand)
                self.formula.append(NOT)
            case BinaryFormula(operator, left, right) if operator in _COMBINE:
                self.path(left)
                if operator is BinaryOperator.IMPLIES:
                    self.formula.append(NOT)
                self.path(right)
                self.formula.append(_COMBINE[operator])
            case _:
                self.until(TRUE, self.condition(formula), 0, 0)

    def at_end(self, lasting: Lasting) -> None:
        """Write `F G b`, which is true if b holds in the state in which a trace stays."""
        read = {name for name, _ in identifiers(lasting.condition)}
        opened = next((expression for name, expression in self.outputs.open if name in read), None)
        left = FALSE if opened is None else self.condition(opened)
        right = self.condition(lasting.condition)
        self.formula.append(len(self.left))
        self.left.append(left)
        self.right.append(right)
        self.lower.append(AT_END)
        self._end_leaf()
        self.upper.append(-1)
        if lasting.is_negated:
            self.formula.append(NOT)

    def until(self, left: int, right: int, lower: int, upper: int | None) -> None:
        if upper is not None and upper < lower:
            left, right, upper = FALSE, FALSE, None
        self.formula.append(len(self.left))
        self.left.append(left)
        self.right.append(right)
        self.lower.append(lower)
        self.upper.append(-1 if upper is None else upper)
        self._end_leaf()
        if lower > 0 or upper is not None:
            self.is_bounded = max(self.is_bounded, 1)

    def _end_leaf(self) -> None:
        """Record the variables that the conditions of the last `U` operator read."""
        self.read.append(self.unread)
        self.unread = set()

    def storage(self, name: str) -> Storage:
        storage = self.names.values[name]
        assert isinstance(storage, Storage)
        return storage

    def sum_code(self, bound: RewardBound, accumulation: Accumulation) -> int:
        """Code that returns the register of a reward; -1 if the reward is not accumulated in this way."""
        if accumulation not in bound.accumulate:
            return -1
        return self.compilation.expressions.real_register(bound.reward, self.names, bound.origin)

    def all(self, conditions: tuple[Expression, ...]) -> int:
        """The code of a conjunction."""
        return self.condition(conditions[0], conditions[1:]) if conditions else TRUE

    def condition(self, formula: Formula, more: tuple[Expression, ...] = (), *, negated: bool = False) -> int:
        """The address of the code of a state formula, or one of the negative numbers that `program.Goal` defines.

        Args:
            more: further conditions, which must also hold.
            negated: whether to negate `formula`, but not `more`.
        """
        match formula:
            case UnaryFormula(operator=UnaryOperator.NOT, operand=operand):
                return self.condition(operand, more, negated=not negated)
            case Predicate(StatePredicate.DEADLOCK):
                self.is_bounded = 2
                return NO_DEADLOCK if negated else DEADLOCK
            case _ if isinstance(formula, ProperFormula):
                raise FaultError(NOT_OBSERVABLE, formula.origin or self.property.origin, code=UNSUPPORTED)
            case _:
                expression: Expression = Unary(UnaryOperator.NOT, formula) if negated else formula
                for condition in more:
                    expression = Binary(BinaryOperator.AND, expression, condition)
                self.conditions.append(expression)
                self.unread.update(name for name, _ in identifiers(expression))
                return self.compilation.expressions.condition(
                    expression, self.names, formula.origin or self.property.origin
                )

    def bounds(self, path: PathBounds) -> tuple[int, int | None]:
        """The bounds on steps of a formula, both inclusive. The upper one is `None` if there is none."""
        interval = path.step_bounds
        if interval is None:
            return 0, None
        lower = self.end(interval, interval.lower)
        upper = self.end(interval, interval.upper)
        first = 0 if lower is None else max(0, math.floor(lower) + 1 if interval.lower_exclusive else math.ceil(lower))
        last = None if upper is None else math.ceil(upper) - 1 if interval.upper_exclusive else math.floor(upper)
        return first, last

    def end(self, interval: Interval, expression: Expression | None) -> float | None:
        if expression is None:
            return None
        return self.limit(interval, expression)

    def limit(self, interval: Interval, expression: Expression) -> float:
        """The value of an end of an interval."""
        value = self.number(expression)
        if not abs(value) < 1 << 62:
            raise FaultError(
                "this bound is too large; its absolute value must be less than 2⁶²",
                expression.origin or interval.origin,
            )
        return value

    # ------------------------------------------------------------ rewards

    def expectation(self, formula: Expectation) -> tuple[int, int]:
        assert formula.accumulate is not None
        if formula.step_instant is not None:
            # `G≤n true` is decided after n steps, or earlier where no step is possible.
            last = math.floor(self.limit(Interval(origin=formula.origin), formula.step_instant))
            if last < 0:
                raise FaultError("`step-instant` must not be negative", formula.step_instant.origin or formula.origin)
            self.until(TRUE, FALSE, 0, last)
            self.formula.append(NOT)
        else:
            assert formula.reach is not None
            self.until(TRUE, self.condition(formula.reach), 0, None)
        code = self.compilation.expressions.real_register(formula.reward, self.names, formula.origin)
        return (
            code if Accumulation.STEPS in formula.accumulate else -1,
            code if Accumulation.EXIT in formula.accumulate else -1,
        )


_FOLDS = {
    FilterFunction.MIN: InitialFold.MINIMUM,
    FilterFunction.MAX: InitialFold.MAXIMUM,
    FilterFunction.AVG: InitialFold.MEAN,
}
_COMBINE = {BinaryOperator.AND: AND, BinaryOperator.OR: OR, BinaryOperator.IMPLIES: OR}


def with_threshold(question: Question, threshold: Threshold) -> Question:
    """A copy of `question` whose value is compared with `threshold`."""
    return replace(question, threshold=threshold)
