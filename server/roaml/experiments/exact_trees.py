# SPDX-License-Identifier: Apache-2.0
"""The exact measurements of a tree with mocks (docs/spec/mocks.md#results), from all states of its model.

The goal of a search is that the tree has ended. It also reads one counter of the model, which therefore is part of each
state. What a search leaves out depends only on the variables that its goal reads, so the states that are left serve for
each of the goals that the tree has ended while the counter has some value. If no choice that is left makes a difference
(`confluence`), they are a Markov chain, and each of its last states is reached with the same probability under all
schedulers. The counters of the last states give the mean, the time and its quantiles.

An influence is a derivative of the probability of success (`derivatives`), for which the probability of each mock is
a constant of the model.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence

from roaml.experiments.confluence import Branches, merged_choices
from roaml.experiments.derivatives import NoDerivativeError, derivative
from roaml.experiments.parametric import constant_chances, parametric_space
from roaml.experiments.visits import SlowChainError, expected_visits
from roaml.explicit import codes
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, Space, StateLimits, explore
from roaml.jani.constants import with_constants
from roaml.jani.expressions import Binary, Expression, Integer, Name, Real
from roaml.jani.model import Automaton, Constant, Destination, Model, Variable
from roaml.jani.node import Node
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import Property, eventually
from roaml.jani.rewrite import rewrite
from roaml.jani.types import REAL
from roaml.mocks.network import TICKS, MockedLeaf, MockedTree
from roaml.record import Record, replace
from roaml.scxml.names import MOCK_FAILURES, MOCK_SUCCESSES, SUCCEEDS
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.smc.program import UNKNOWN
from roaml.smc.statistics import Bounds
from roaml.verification.exhaustive import alone
from roaml.verification.target import VerificationTarget
from roaml.verification.tree_outcome import (
    FAILURES,
    QUANTILES,
    SUCCESS,
    Influence,
    Quantile,
    TreeOutcome,
    counters_of,
    exactly,
    returned,
    root_automaton,
    status_variable,
)
from roaml.views.ends import marks

MAX_STATES = 100_000
"""The maximum number of states of a chain, which Python takes some µs each to solve."""
_COUNTER = "measured"
"""The name of the variable with the counter that is measured."""
_ROUNDING = 1e-9
"""The share of the traces that rounding may lose."""
_RANGE = (0.05, 0.95)
"""A range of probabilities in which the influences are determined; each value in it gives the same states."""
_CHOICES, _UNDEFINED, _INACCURATE = (
    "they depend on the order in which nodes take their steps",
    "the model executes an undefined operation",
    "the tree repeats its steps so often that rounding errors are too great",
)
"""Reasons of `NotMeasuredError`."""


class NotMeasuredError(Exception):
    """The states give no measurements. The message is the reason, a clause for users."""


def measure_exactly(mocked: MockedTree, target: VerificationTarget, limits: StateLimits) -> TreeOutcome:
    """The measurements of a tree, from all states.

    The model must have counters (`MockOptions.counts`).

    Args:
        limits: those of the search for each measurement.

    Raises:
        NotMeasuredError: there are too many states, or the measurements depend on a scheduler.
    """
    limits = replace(limits, states=min(limits.states, MAX_STATES))
    root = root_automaton(mocked)
    ends = _Ends.of(mocked, target.model, root, TICKS, limits)
    counts = [
        (node, counter, exactly(_Ends.of(mocked, target.model, node.automaton, counter, limits).mean))
        for node, counter in counters_of(mocked)
    ]
    influences = _influences(mocked, target, limits)
    tick_time = mocked.options.tick_time
    times = {float(ticks * tick_time): share for ticks, share in ends.successes.items() if share > 0}
    success = math.fsum(times.values())
    mean = math.fsum(time * share for time, share in times.items()) / success if times else None
    return TreeOutcome(
        traces=None,
        confidence=1.0,
        success=exactly(success),
        failure=exactly(ends.failure),
        unfinished=exactly(ends.unfinished),
        exceptions=exactly(ends.stuck),
        rare=None,
        time=None if mean is None else exactly(mean),
        quantiles=tuple(_quantiles(times, success)),
        counts=tuple(counts),
        influences=influences,
    )


def _quantiles(times: Mapping[float, float], whole: float) -> Iterator[Quantile]:
    """The quantiles of times with their probabilities, the sum of which is `whole`."""
    for share in QUANTILES if times else ():
        below = 0.0
        for time in sorted(times):
            below += times[time]
            if below >= (share - _ROUNDING) * whole:
                yield Quantile(share, time, Bounds(time, time))
                break


class _Ends(Record, frozen=True):
    """How traces end, with the values of a counter.

    Attributes:
        successes: value of the counter -> the probability that the tree has succeeded with this value.
        failure: the probability that it has failed.
        unfinished: the probability that it has not ended when time is over.
        stuck: the probability that a node gets stuck.
        mean: the expected value of the counter.
    """

    successes: Mapping[int, float]
    failure: float
    unfinished: float
    stuck: float
    mean: float

    @classmethod
    def of(cls, mocked: MockedTree, model: Model, automaton: str, counter: str, limits: StateLimits) -> _Ends:
        """The ends with the values of a counter of an automaton.

        Raises:
            NotMeasuredError: as for `measure_exactly`.
        """
        space = _space(_with_global(model, automaton, counter), mocked.tree.root, limits)
        layout = space.checker.legend.layout
        # The cells of a state are the locations of all instances and then the integers.
        cells = {storage.name: len(layout.instances) + storage.base for storage in layout.shared}
        status, counted = cells[status_variable(mocked.tree.root)], cells[_COUNTER]
        search, successes = space.search, dict[int, float]()
        failure = unfinished = stuck = mean = 0.0

        def outcome(state: int) -> Hashable:
            label, key = search.label[state], search.key(state)
            is_ended = label & codes.STATUS != UNKNOWN
            return key[counted], key[status] if is_ended else None, label & codes.GETS_STUCK

        for state, share in _visits(space, outcome).items():
            label = search.label[state]
            is_ended = label & codes.STATUS != UNKNOWN
            if not is_ended and search.choices_of(state):
                continue
            key = search.key(state)
            mean += share * key[counted]
            if is_ended and key[status] == SUCCESS:
                successes[key[counted]] = successes.get(key[counted], 0.0) + share
            elif is_ended:
                failure += share
            elif label & codes.GETS_STUCK:
                stuck += share
            else:
                unfinished += share
        whole = math.fsum((*successes.values(), failure, unfinished, stuck))
        if abs(whole - 1) > _ROUNDING:
            raise NotMeasuredError(_INACCURATE)
        return cls(successes, failure, unfinished, stuck, mean)


def _space(model: Model, root: int, limits: StateLimits) -> Space:
    """All states until the tree has ended, where the goal reads the counter.

    Raises:
        NotMeasuredError: there are too many states, or an operation in the model is undefined.
    """
    reads = Binary(BinaryOperator.GREATER_EQUAL, Name(_COUNTER), Integer(0))
    ended = Binary(BinaryOperator.AND, returned(root, SUCCESS, *FAILURES), reads)
    property_: Property = eventually("ends", ended)
    try:
        checker = ModelChecker(replace(model, properties=(property_,)), (property_,), marks(model))
        checker, compiled = alone(checker, checker.compiled_properties[0])
        reduces = limits.reduces and can_be_reduced(checker.program, compiled.goal)
        space = explore(checker, compiled, limits, is_reduced=reduces)
    except LimitError as error:
        raise NotMeasuredError(_too_many(error, limits)) from None
    except FaultError:
        raise NotMeasuredError(_UNDEFINED) from None
    if space.problem is not None:
        raise NotMeasuredError(_UNDEFINED)
    if len(space.roots) != 1:
        raise NotMeasuredError(_CHOICES)
    return space


def _too_many(error: LimitError, limits: StateLimits) -> str:
    if error.states < limits.states:
        return f"there are too many states: the search {error}"
    option = "the maximum of these values" if limits.states == MAX_STATES else "max-states"
    return f"there are more than {limits.states:,} states ({option})"


def _visits(space: Space, outcome_of: Callable[[int], Hashable]) -> dict[int, float]:
    """The expected number of visits of states, which for a last state is the probability of reaching it, or one with
    the same outcome.

    Raises:
        NotMeasuredError: the number depends on choices, or rounding errors are too great.
    """
    search = space.search

    def choices_of(state: int) -> list[Branches]:
        is_ended = search.label[state] & codes.STATUS != UNKNOWN
        return [] if is_ended else [branches for _, _, branches in search.choices_of(state)]

    chain = merged_choices(choices_of, space.roots[0], outcome_of)
    if chain is None:
        raise NotMeasuredError(_CHOICES)
    chances: list[float] = []
    steps: dict[int, Sequence[tuple[int, int]]] = {}
    for state, branches in chain.items():
        first = len(chances)
        chances += [chance for chance, _ in branches]
        steps[state] = [(successor, first + place) for place, (_, successor) in enumerate(branches)]
    try:
        return expected_visits(steps, space.roots[0], chances.__getitem__)
    except SlowChainError:
        raise NotMeasuredError(_INACCURATE) from None


def _with_global(model: Model, automaton: str, counter: str) -> Model:
    """The model in which a counter of an automaton is the global variable `_COUNTER`, which a property can read."""

    def of(part: Automaton) -> Automaton:
        if part.name != automaton:
            return part
        kept = tuple(variable for variable in part.variables if variable.name != counter)
        return rewrite(replace(part, variables=kept), _renamed)

    def _renamed(node: Node) -> Node:
        return Name(_COUNTER) if isinstance(node, Name) and node.identifier == counter else node

    own = next(part for part in model.automata if part.name == automaton)
    variable = next(variable for variable in own.variables if variable.name == counter)
    variables: tuple[Variable, ...] = (*model.variables, replace(variable, name=_COUNTER))
    return replace(model, automata=tuple(map(of, model.automata)), variables=variables)


def _influences(mocked: MockedTree, target: VerificationTarget, limits: StateLimits) -> tuple[Influence, ...]:
    """The influences of the leaves, the greatest first.

    Raises:
        NotMeasuredError: they are not known.
    """
    leaves = {f"probability_{leaf.node.number}": leaf for leaf in mocked.leaves if 0 < leaf.probability < 1}
    if not leaves:
        return ()
    model = _with_probabilities(target.model, leaves)
    chances = constant_chances(model, leaves)
    if chances is None:  # no leaf is ticked
        return ()
    space = parametric_space(
        lambda setting: replace(target, model=with_constants(model, [f"{name}={text}" for name, text in setting])),
        chances,
        SUCCEEDS,
        dict.fromkeys(leaves, _RANGE),
        (),
        limits,
    )
    if space is None:
        raise NotMeasuredError("there are too many states for the influences")
    setting = tuple((name, repr(leaf.probability)) for name, leaf in leaves.items())
    try:
        slopes = dict(derivative(space, setting, tuple(leaves)).slopes)
    except NoDerivativeError as error:
        raise NotMeasuredError(f"the influences are not known: {error}") from None
    found = (Influence(leaf, slopes[name], Bounds(slopes[name], slopes[name])) for name, leaf in leaves.items())
    return tuple(sorted(found, key=lambda influence: -abs(influence.value)))


def _with_probabilities(model: Model, leaves: Mapping[str, MockedLeaf]) -> Model:
    """The model in which the probabilities of mocks are constants. Its mocks count their answers."""
    named = {leaf.node.automaton: name for name, leaf in leaves.items()}

    def of(part: Automaton) -> Automaton:
        if part.name not in named:
            return part
        success: Expression = Name(named[part.name])
        failure: Expression = Binary(BinaryOperator.SUBTRACT, Real(1.0), success)

        def answered(destination: Destination) -> Destination:
            written = {assignment.variable for assignment in destination.assignments}
            clause = destination.probability
            if clause is None or not written & {MOCK_SUCCESSES, MOCK_FAILURES}:
                return destination
            chance = success if MOCK_SUCCESSES in written else failure
            return replace(destination, probability=replace(clause, exp=chance))

        edges = (replace(edge, destinations=tuple(map(answered, edge.destinations))) for edge in part.edges)
        return replace(part, edges=tuple(edges))

    constants = (*model.constants, *(Constant(name, REAL) for name in leaves))
    return replace(model, automata=tuple(map(of, model.automata)), constants=constants)
