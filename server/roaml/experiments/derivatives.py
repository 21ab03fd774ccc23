# SPDX-License-Identifier: Apache-2.0
"""The derivative of an exact probability by parameters on which only probabilities depend.

The probability V of reaching a target satisfies V = P V + b on the states from which the target is neither certain nor
impossible. So dV/dp = λ dP/dp V, where λ, the expected numbers of visits, is the solution of one adjoint system
λ = e + λ P (`visits`), for any number of parameters.

All schedulers must have the same value. Then every scheduler reaches a state from which the target is certain or
impossible, so the equations of any of them have one solution. Two schedulers are compared: if their derivatives differ,
the minimum and the maximum have a kink here, and there is no derivative.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from roaml.exact_number import exact_fraction
from roaml.experiments.parametric import ParametricSpace
from roaml.experiments.sweeps import Setting
from roaml.experiments.visits import SlowChainError, expected_visits
from roaml.explicit import codes, solver
from roaml.explicit.values import MAXIMUM, MINIMUM, NOTHING
from roaml.record import Record
from roaml.smc.goal import NOT
from roaml.smc.program import AT_END, FALSE, TRUE, UNKNOWN

_STEP = 1e-3
"""The difference of a parameter from which the derivatives of probabilities are computed."""


class NoDerivativeError(ValueError):
    """Raised if there is no derivative, or if it cannot be computed. The message contains the reason."""


class ProbabilityDerivative(Record, frozen=True):
    """The value of a property for a setting, and its derivatives by parameters, in their order."""

    value: float
    slopes: tuple[tuple[str, float], ...]


def derivative(space: ParametricSpace, setting: Setting, names: Sequence[str]) -> ProbabilityDerivative:
    """The derivatives of a probability by parameters.

    Args:
        setting: the values of all parameters.
        names: the parameters; their values are numbers.

    Raises:
        NoDerivativeError: the property is not the probability of reaching a state, or schedulers with different
            derivatives have the same value.
    """
    question = space.space.compiled_property.question
    goal = space.space.compiled_property.goal
    is_until = len(goal.left) == 1 and goal.lower[0] != AT_END
    if question.is_reward or not is_until or goal.is_bounded or question.is_stuck or len(space.space.roots) != 1:
        raise NoDerivativeError("only probabilities of reaching a state without a bound have derivatives here")
    slopes_of_numbers = [_slopes(space, setting, name) for name in names]
    if not space.is_at(setting):
        raise NoDerivativeError("a probability of the model is 0 or 1 here, where the states may change")
    is_negated = goal.formula.count(NOT) % 2 == 1
    target = FALSE if is_negated else TRUE
    modes = {}
    for mode in (MINIMUM, MAXIMUM):
        own = solver.Solver(space.space.search, mode)
        own.probability(target, 0, NOTHING)
        modes[mode] = [own.low[state] for state in range(space.space.states)]
    root = space.space.roots[0]
    low, high = modes[MINIMUM][root], modes[MAXIMUM][root]
    if abs(high - low) > 1e-7:
        raise NoDerivativeError("schedulers have different values, so the derivative depends on the scheduler")
    values = modes[MAXIMUM]
    found, other = (
        _adjoint(_Chain(space, values, root, is_last=last), values, slopes_of_numbers) for last in (False, True)
    )
    if any(abs(a - b) > 1e-6 * max(1.0, abs(a)) for a, b in zip(found, other, strict=True)):
        raise NoDerivativeError("schedulers with the same value have different derivatives")
    value = 1 - high if is_negated else high
    slopes = [0.0 - slope for slope in found] if is_negated else found  # 0.0, not -0.0
    return ProbabilityDerivative(value, tuple(zip(names, slopes, strict=True)))


def _slopes(space: ParametricSpace, setting: Setting, name: str) -> dict[int, float]:
    """The derivatives of the numbers of the search by a parameter, where they are not 0: by central differences of the
    probabilities of the model with an extrapolation, which are exact for polynomials up to the fourth degree."""
    value = exact_fraction(dict(setting)[name])
    if value is None:
        raise NoDerivativeError(f"the value of `{name}` is not a number")
    here = space.chances.at(setting)
    wide, narrow = (_difference(space, setting, name, float(value), step) for step in (_STEP, _STEP / 2))
    if here is None or wide is None or narrow is None:
        raise NoDerivativeError("a probability of the model is 0 or 1 here, where the states may change")
    slopes = [(4 * fine - coarse) / 3 for coarse, fine in zip(wide, narrow, strict=True)]
    result = {}
    for index, monomial in space.numbers.items():
        product = monomial.coefficient * math.prod(here[factor] for factor in monomial.factors)
        slope = product * math.fsum(slopes[factor] / here[factor] for factor in monomial.factors)
        if slope:
            result[index] = slope
    return result


def _difference(space: ParametricSpace, setting: Setting, name: str, value: float, step: float) -> list[float] | None:
    ends = []
    for end in (value - step, value + step):
        chances = space.chances.at(tuple((key, repr(end) if key == name else text) for key, text in setting))
        if chances is None:
            return None
        ends.append(chances)
    return [(high - low) / (2 * step) for low, high in zip(*ends, strict=True)]


class _Chain:
    """The Markov chain of a scheduler that takes the first or the last choice of each state, on the states from which
    the target is neither certain nor impossible.

    Attributes:
        steps: state -> its destinations, each with the number of its probability in the search; -1 for 1.
    """

    def __init__(self, space: ParametricSpace, values: Sequence[float], root: int, *, is_last: bool) -> None:
        self.search = space.space.search
        self.root = root
        self.steps: dict[int, list[tuple[int, int]]] = {}
        waiting = [root]
        while waiting:
            state = waiting.pop()
            decided = self.search.label[state] & codes.STATUS != UNKNOWN
            if state in self.steps or decided or values[state] == 0.0:
                continue
            self.steps[state] = self._choice(state, is_last=is_last)
            waiting += [successor for successor, _ in self.steps[state]]

    def chance(self, number: int) -> float:
        return 1.0 if number < 0 else float(self.search.reals[number])

    def _choice(self, state: int, *, is_last: bool) -> list[tuple[int, int]]:
        code, at, end = self.search.code, self.search.start[state], self.search.start[state + 1]
        chosen: list[tuple[int, int]] = []
        while at < end and (is_last or not chosen):
            size = code[at]
            if size >= 0:
                chosen, at = [(size, -1)], at + 1
            else:
                chosen = [(code[at + 3 + 2 * k], code[at + 4 + 2 * k]) for k in range(-size)]
                at += 3 - 2 * size
        return chosen


def _adjoint(chain: _Chain, values: Sequence[float], slopes_of_numbers: Sequence[Mapping[int, float]]) -> list[float]:
    """λ dP/dp V for each parameter p."""
    try:
        visits = expected_visits(chain.steps, chain.root, chain.chance)
    except SlowChainError as error:
        raise NoDerivativeError(str(error)) from None
    result = [0.0] * len(slopes_of_numbers)
    for state, steps in chain.steps.items():
        for successor, number in steps:
            for place, slopes in enumerate(slopes_of_numbers):
                result[place] += visits[state] * slopes.get(number, 0.0) * values[successor]
    return result
