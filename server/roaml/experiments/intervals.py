# SPDX-License-Identifier: Apache-2.0
"""Models in which parameters are only known to be in intervals (docs/spec/parameters.md#intervals).

If only probabilities depend on the parameters, and these are affine in each of them, each step whose probabilities
depend on them becomes a choice between the probabilities at the ends of the intervals: parameter lifting (T. Quatmann,
C. Dehnert, N. Jansen, S. Junges and J.-P. Katoen, Parameter Synthesis for Markov Models: Faster Than Ever, ATVA 2016).
The least and greatest values over all schedulers of the result enclose those for each value in the intervals.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from roaml.exact_number import exact_fraction
from roaml.experiments.grid import ParametricModel
from roaml.experiments.sweeps import Setting, number_text
from roaml.jani.constants import constant_values
from roaml.jani.expressions import Expression, Name, Real, walk
from roaml.jani.model import Edge, Model, ModelType
from roaml.jani.semantics import Value, evaluate
from roaml.record import Record, replace
from roaml.regex import regex
from roaml.verification.target import VerificationTarget

MAX_INTERVALS = 4
"""The maximum number of parameters with intervals: each doubles the number of choices."""
_INTERVAL = regex(r"\[([^\[\],]+),([^\[\],]+)\]\Z")
_CHECKED_PLACES = (0.381966011250105, 0.723606797749979, *(place / 17 for place in range(1, 17)))
"""Where it is checked that probabilities are affine: shares of an interval, the first two of them irrational."""
_ROUNDING = 1e-12


class IntervalError(ValueError):
    """The values of a property cannot be bounded for an interval; the message states the reason."""


class ParameterInterval(Record, frozen=True):
    """A parameter whose value is from `low` to `high`, both included."""

    name: str
    low: Fraction
    high: Fraction

    @property
    def text(self) -> str:
        return f"[{number_text(self.low)}, {number_text(self.high)}]"

    def at(self, share: float) -> str:
        """The value at a share of the interval, as text; exact at its ends."""
        if share in (0, 1):
            return number_text(self.high if share else self.low)
        return repr(float(self.low) + float(self.high - self.low) * share)


def interval_of(name: str, value: str) -> ParameterInterval | None:
    """The interval in a text such as `[0.85, 0.95]`; `None` if it is a single value.

    Raises:
        IntervalError: the text begins like an interval, but is none.
    """
    if not value.lstrip().startswith("["):
        return None
    match = _INTERVAL.match(value.strip())
    low, high = (exact_fraction(match[1].strip()), exact_fraction(match[2].strip())) if match else (None, None)
    if low is None or high is None or low >= high:
        raise IntervalError(
            f"`{value}` is not an interval of `{name}`; write it as `[0.85,0.95]`, the smaller end first"
        )
    return ParameterInterval(name, low, high)


def lifted_target(
    model: ParametricModel, intervals: Sequence[ParameterInterval], fixed: Setting = ()
) -> VerificationTarget:
    """A model whose least and greatest values over all schedulers enclose the values for all parameters in intervals.

    Args:
        fixed: the values of other parameters.

    Raises:
        IntervalError: there are too many intervals, or anything but probabilities depends on the parameters, or these
            are not affine.
        ValueError: as `ParametricModel.target`.
    """
    if len(intervals) > MAX_INTERVALS:
        raise IntervalError(f"{len(intervals)} parameters have intervals; at most {MAX_INTERVALS} are possible")
    names = ", ".join(f"`{interval.name}`" for interval in intervals)
    low = _setting(intervals, [0.0] * len(intervals), fixed)  # the middle may be no integer
    if model.chances({i.name: (float(i.low), float(i.high)) for i in intervals}, low) is None:
        raise IntervalError(
            f"no bounds are known for intervals of {names}, because not only probabilities depend on them, or none "
            "does; `as2fm-lsp experiment` computes single values"
        )
    ends = list(itertools.product((0.0, 1.0), repeat=len(intervals)))
    corners = [model.target(_setting(intervals, end, fixed)) for end in ends]
    numbers = [list(_numbers(corner.model)) for corner in corners]
    if any(min(corner, default=0.0) <= 0 or len(corner) != len(numbers[0]) for corner in numbers):
        raise IntervalError(
            f"no bounds are known for intervals of {names}, because a probability is 0 at one of their ends; use "
            "smaller intervals"
        )
    if corners[0].model.type not in (ModelType.DTMC, ModelType.MDP):
        raise IntervalError("intervals need a model of the type DTMC or MDP")
    for place in _CHECKED_PLACES:
        # Different places in different intervals, so that products of two parameters are seen.
        shares = [(place + 0.37 * index) % 1 for index in range(len(intervals))]
        inner = list(_numbers(model.target(_setting(intervals, shares, fixed)).model))
        if not _is_between(inner, numbers, [_weight(end, shares) for end in ends]):
            raise IntervalError(
                f"no bounds are known for intervals of {names}, because a probability is not affine in one of them; "
                "`as2fm-lsp experiment` computes single values"
            )
    first = corners[0]
    parameters = {**first.parameters, **{interval.name: interval.text for interval in intervals}}
    return replace(
        first, model=_lifted([corner.model for corner in corners]), parameters=parameters, has_intervals=True
    )


def _setting(intervals: Iterable[ParameterInterval], shares: Sequence[float], fixed: Setting) -> Setting:
    return (*fixed, *((i.name, i.at(share)) for i, share in zip(intervals, shares, strict=True)))


def _weight(end: Sequence[float], shares: Sequence[float]) -> float:
    """The weight of a corner in the multilinear interpolation at a place."""
    return math.prod(share if is_high else 1 - share for is_high, share in zip(end, shares, strict=True))


def _is_between(inner: Sequence[float], corners: Sequence[Sequence[float]], weights: Sequence[float]) -> bool:
    return all(
        abs(number - math.fsum(w * corner[index] for w, corner in zip(weights, corners, strict=True))) <= _ROUNDING
        for index, number in enumerate(inner)
    )


def _numbers(model: Model) -> Iterator[float]:
    """The probabilities of a model, in order."""
    known = constant_values(model)
    for automaton in model.automata:
        for edge in automaton.edges:
            for destination in edge.destinations:
                if destination.probability is not None and _is_fixed(destination.probability.exp, known):
                    yield _number(destination.probability.exp, known)


def _is_fixed(expression: Expression, known: Mapping[str, Value]) -> bool:
    return all(not isinstance(part, Name) or part.identifier in known for part in walk(expression))


def _with_numbers(edge: Edge, known: Mapping[str, Value]) -> Edge:
    """An edge in which numbers replace the probabilities that only depend on constants."""
    destinations = []
    for destination in edge.destinations:
        clause = destination.probability
        if clause is not None and _is_fixed(clause.exp, known):
            clause = replace(clause, exp=Real(_number(clause.exp, known)))
        destinations.append(replace(destination, probability=clause))
    return replace(edge, destinations=tuple(destinations))


def _number(expression: Expression, known: Mapping[str, Value]) -> float:
    value = evaluate(expression, known, {})
    assert isinstance(value, (int, float))
    return float(value)


def _lifted(corners: Sequence[Model]) -> Model:
    """The model with the edges of all corners."""
    first = corners[0]
    values = [constant_values(corner) for corner in corners]
    automata = []
    for number, automaton in enumerate(first.automata):
        edges: list[Edge] = []
        for index in range(len(automaton.edges)):
            variants = (
                _with_numbers(corner.automata[number].edges[index], known)
                for corner, known in zip(corners, values, strict=True)
            )
            edges += dict.fromkeys(variants)
        automata.append(replace(automaton, edges=tuple(edges)))
    type_ = ModelType.MDP if first.type is ModelType.DTMC else first.type
    return replace(first, automata=tuple(automata), type=type_)
