# SPDX-License-Identifier: Apache-2.0
"""The states of a model, explored once for all values of the parameters on which only probabilities depend.

Such parameters change neither the states nor the choices, only the probabilities of destinations, as long as none of
these is 0. The probability of a step is a product: one factor for each automaton that takes part. So each number of the
explored model is a constant times a product of the probabilities in the model that depend on the parameters. The states
are explored for two generic values of the parameters; the factors of each number follow from its two values, because
two different products agree in two generic places with a probability of 0, up to rounding. If the factors of some
number are not found, the states are explored for each point.
"""

from __future__ import annotations

import itertools
import math
from array import array
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from copy import copy
from typing import Any, Protocol

from roaml.experiments.sweeps import Setting
from roaml.explicit.space import Space, StateLimits
from roaml.jani.constants import constant_values, with_constants
from roaml.jani.expressions import Expression, Name
from roaml.jani.model import Model
from roaml.jani.node import Node
from roaml.jani.semantics import EvaluationError, Value, evaluate
from roaml.jani.types import REAL, BoundedType
from roaml.record import Record, replace
from roaml.smc.fault import FaultError
from roaml.smc.model import ModelChecker
from roaml.smc.program import Program
from roaml.verification.small import attempt
from roaml.verification.target import VerificationTarget, asking
from roaml.verification.verifier import checker_of

MAX_FACTORS = 3
"""The maximum number of factors of a probability that depend on the constants."""
_PLACES = (0.381966011250105, 0.723606797749979)
"""Where the two generic values are between the least and the greatest value of a constant; irrational, so that no
probability of a model is equal to another one by chance."""
_AGREEMENT = 1e-11
"""The relative difference below which two constants are regarded as equal."""


class Monomial(Record, frozen=True):
    """A number that depends on constants: `coefficient` times the product of some of the model's probabilities, which
    are named by their indexes."""

    coefficient: float
    factors: tuple[int, ...]


class Chances(Protocol):
    """The probabilities of a model that depend on its parameters, if nothing else does."""

    def at(self, setting: Setting) -> list[float] | None:
        """The probabilities for a setting, always in the same order; `None` if they have no values."""


class ConstantChances(Record, frozen=True):
    """The probabilities of a JANI model that depend on some of its constants."""

    model: Model
    probabilities: tuple[Expression, ...]

    def at(self, setting: Setting) -> list[float] | None:
        known = constant_values(with_constants(self.model, [f"{name}={value}" for name, value in setting]))
        try:
            return [_number(evaluate(expression, known, {})) for expression in self.probabilities]
        except EvaluationError:
            return None


def constant_chances(model: Model, names: Collection[str]) -> ConstantChances | None:
    """The probabilities that depend on real constants; `None` if there are none, or if anything else does."""
    types = {constant.name: constant.type for constant in model.constants}
    for name in names:
        type_ = types.get(name)
        if (type_.base if isinstance(type_, BoundedType) else type_) is not REAL:
            return None
    probabilities = _varying(model, names)
    return ConstantChances(model, probabilities) if probabilities else None


class ParametricSpace(Record, frozen=True):
    """The states of a model for all values of some parameters, except where a probability is 0.

    Attributes:
        chances: the probabilities of the model that depend on the parameters.
        numbers: index of a number of the search -> how it depends on these probabilities.
        names: the parameters.
    """

    space: Space
    chances: Chances
    numbers: Mapping[int, Monomial]
    names: tuple[str, ...]

    def is_at(self, setting: Setting) -> bool:
        """Replace the numbers of the explored states by those for a setting. Return whether they could be replaced:
        otherwise the states for this setting may be different."""
        chances = self.chances.at(setting)
        if chances is None or not all(0 < chance <= 1 for chance in chances):
            return False
        for index, monomial in self.numbers.items():
            factors = (chances[factor] for factor in monomial.factors)
            self.space.search.reals[index] = monomial.coefficient * math.prod(factors)
        return True


def parametric_space(
    target: Callable[[Setting], VerificationTarget],
    chances: Chances,
    name: str,
    ranges: Mapping[str, tuple[float, float]],
    fixed: Setting,
    limits: StateLimits,
) -> ParametricSpace | None:
    """The states for a property, for all values of some parameters; `None` if there are too many states, or if the
    factors of some number are not found.

    Args:
        target: the model for a setting.
        name: the name of the property.
        ranges: parameter -> its least and its greatest value.
        fixed: the other parameters.
    """
    spaces, generic = [], []
    for setting in _generic_settings(ranges, fixed):
        try:
            values = chances.at(setting)
            if values is None or not all(0 < chance < 1 for chance in values):
                return None
            space = _space(target(setting), name, limits)
        except (ValueError, FaultError):
            return None
        if space is None:
            return None
        spaces.append(space)
        generic.append(values)
    numbers = _numbers(spaces, generic)
    return None if numbers is None else ParametricSpace(spaces[0], chances, numbers, tuple(ranges))


def _space(target: VerificationTarget, name: str, limits: StateLimits) -> Space | None:
    checker = checker_of(asking(target, [name]), [name])
    property_ = next(iter(checker.compiled_properties), None)
    return None if property_ is None else attempt(checker, property_, limits).space


def _varying(model: Model, names: Collection[str]) -> tuple[Expression, ...]:
    """The different probabilities that depend on constants; empty if anything else does."""
    dependent = set(names)
    for constant in model.constants:
        if constant.value is not None and constant.name not in names and _mentions(constant.value, dependent):
            dependent.add(constant.name)
    constants = {constant.name for constant in model.constants}
    probabilities: dict[Expression, None] = {}
    automata = []
    for automaton in model.automata:
        edges = []
        for edge in automaton.edges:
            destinations = []
            for destination in edge.destinations:
                clause = destination.probability
                if clause is not None and _mentions(clause.exp, dependent):
                    if not _names(clause.exp) <= constants:
                        return ()
                    probabilities[clause.exp] = None
                destinations.append(replace(destination, probability=None))
            edges.append(replace(edge, destinations=tuple(destinations)))
        automata.append(replace(automaton, edges=tuple(edges)))
    rest = replace(model, automata=tuple(automata), constants=())
    types = [constant.type for constant in model.constants]
    if _mentions(rest, dependent) or any(_mentions(type_, dependent) for type_ in types):
        return ()
    return tuple(probabilities)


def _names(node: Any) -> set[str]:
    return {part.identifier for part in _parts(node) if isinstance(part, Name)}


def _mentions(node: Any, names: set[str]) -> bool:
    return any(isinstance(part, Name) and part.identifier in names for part in _parts(node))


def _parts(node: Any) -> Iterator[Node]:
    """A node and all nodes inside it."""
    waiting = [node]
    while waiting:
        part = waiting.pop()
        if isinstance(part, tuple):
            waiting.extend(part)
        elif isinstance(part, Node):
            yield part
            waiting.extend(getattr(part, name) for name in part.__struct_fields__)


def _number(value: Value) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan


def _numbers(spaces: Sequence[Space], chances: Sequence[Sequence[float]]) -> dict[int, Monomial] | None:
    """How the numbers of two searches with the same states depend on the probabilities; `None` if their states differ,
    or if the factors of a number are not found."""
    first, second = (space.search for space in spaces)
    if first.count != second.count or memoryview(first.start)[first.count] != memoryview(second.start)[second.count]:
        return None
    end = memoryview(first.start)[first.count]
    if memoryview(first.code)[:end] != memoryview(second.code)[:end]:
        return None
    numbers: dict[int, Monomial] = {}
    for index in range(min(len(first.reals), len(second.reals))):
        low, high = first.reals[index], second.reals[index]
        if not _agree(low, high):
            monomial = _monomial((low, high), chances)
            if monomial is None:
                return None
            numbers[index] = monomial
    return numbers


def _monomial(values: tuple[float, float], chances: Sequence[Sequence[float]]) -> Monomial | None:
    """The product with the fewest factors that has both values."""
    indexes = range(len(chances[0]))
    for count in range(1, MAX_FACTORS + 1):
        for factors in itertools.combinations_with_replacement(indexes, count):
            first, second = (
                value / math.prod(chances[place][factor] for factor in factors) for place, value in enumerate(values)
            )
            if _agree(first, second):
                return Monomial(first, factors)
    return None


def _agree(a: float, b: float) -> bool:
    return abs(a - b) <= _AGREEMENT * max(abs(a), abs(b))


class ParametricProgram(Record, frozen=True):
    """A compiled model for all values of some parameters, except where a probability is 0.

    Attributes:
        numbers: index of a destination -> how its probability depends on the probabilities of `chances`.
    """

    target: VerificationTarget
    checker: ModelChecker
    chances: Chances
    numbers: Mapping[int, Monomial]

    def at(self, setting: Setting) -> ModelChecker | None:
        """The compiled model for a setting; `None` if it may be another one."""
        values = self.chances.at(setting)
        if values is None or not all(0 < value < 1 for value in values):
            return None
        program = self.checker.program
        chances = _way_chances(program)
        for way, monomial in self.numbers.items():
            chances[way] = monomial.coefficient * math.prod(values[factor] for factor in monomial.factors)
        sums = array("d", program.way_sum)
        for first, end in itertools.pairwise(program.way_start):
            if any(way in self.numbers for way in range(first, end)):
                sums[first:end] = array("d", itertools.accumulate(chances[first:end]))
                sums[end - 1] = 1.0
        checker = copy(self.checker)
        checker.program = replace(program, way_sum=sums)
        return checker


def parametric_program(
    target: Callable[[Setting], VerificationTarget],
    chances: Chances,
    names: Sequence[str],
    ranges: Mapping[str, tuple[float, float]],
    fixed: Setting,
) -> ParametricProgram | None:
    """The compiled model for all values of some parameters; `None` if more than the probabilities of its destinations
    differ. Arguments are those of `parametric_space`; `names` are those of the properties."""
    targets, programs, generic = [], [], []
    for setting in _generic_settings(ranges, fixed):
        values = chances.at(setting)
        if values is None or not all(0 < value < 1 for value in values):
            return None
        try:
            targets.append(asking(target(setting), names))
            programs.append(checker_of(targets[-1], names))
        except (ValueError, FaultError):
            return None
        generic.append(values)
    first, second = (checker.program for checker in programs)
    others = (name for name in Program.__struct_fields__ if name != "way_sum")
    if not all(getattr(first, name) == getattr(second, name) for name in others):
        return None
    numbers: dict[int, Monomial] = {}
    for way, (low, high) in enumerate(zip(_way_chances(first), _way_chances(second), strict=True)):
        if not _agree(low, high):
            monomial = _monomial((low, high), generic)
            if monomial is None:
                return None
            numbers[way] = monomial
    return ParametricProgram(targets[0], programs[0], chances, numbers)


def _way_chances(program: Program) -> list[float]:
    """The probability of each destination; meaningless if it depends on the state."""
    chances = []
    for first, end in itertools.pairwise(program.way_start):
        before = 0.0
        for way in range(first, end):
            chances.append(program.way_sum[way] - before)
            before = program.way_sum[way]
    return chances


def _generic_settings(ranges: Mapping[str, tuple[float, float]], fixed: Setting) -> Iterator[Setting]:
    """Settings at which two different products of probabilities are different."""
    for number, place in enumerate(_PLACES):
        yield fixed + tuple(
            (parameter, repr(low + (high - low) * (place + 0.01 * index + 0.001 * number)))
            for index, (parameter, (low, high)) in enumerate(ranges.items())
        )
