# SPDX-License-Identifier: Apache-2.0
"""Exact values under a condition (docs/verification.md#conditions): of the traces that satisfy it, not of all traces.

- A probability is the quotient of two: that the path and the condition hold, and that the condition holds.
- A reward until a condition that is reached with the probability 1 is that of all traces; otherwise, see
  `roaml.explicit.reached_reward`.

A value is that of all schedulers if both probabilities are the same for all of them, or if nothing is to be chosen.
Otherwise, it is that under uniform choices: other schedulers would need to know the condition in advance, and the
minimum and the maximum are not computed.
"""

from __future__ import annotations

import math

from roaml.explicit.space import Space
from roaml.jani.operators import BinaryOperator
from roaml.jani.properties import BinaryFormula, Filter, Probability, Property
from roaml.record import replace
from roaml.smc.fault import FaultError
from roaml.smc.goal import CompiledProperty, Question
from roaml.smc.model import ModelChecker
from roaml.smc.statistics import Bounds
from roaml.verification.results import Exact


def of_condition(exact: Exact, question: Question, space: Space | None) -> Exact | None:
    """The exact value of a reward among the traces that reach its condition; `None` if it is not known.

    Args:
        exact: the values of all traces.
        space: the states from which they were computed.
    """
    if question.is_reward and not math.isinf(exact.maximum.upper):
        return exact  # it is infinite if a scheduler need not reach the condition
    if space is None:
        return None
    from roaml.to_jani.counters import is_counter  # noqa: PLC0415 - JANI models need no translation

    counters = [variable.name for variable in space.checker.model.variables if is_counter(variable.name)]
    from roaml.explicit.reached_reward import reached_reward  # noqa: PLC0415 - most rewards have no condition

    reached = reached_reward(space, counters)
    return None if reached is None else _valued(exact, reached.value, is_for_all=reached.is_deterministic)


def parts_of(checker: ModelChecker, property_: CompiledProperty) -> tuple[ModelChecker, ModelChecker] | None:
    """Model checkers for the probability that the path of a property and its condition hold, and that the condition
    holds; `None` if the property has another form."""
    given = property_.given
    if given is None or property_.question.is_reward or property_.question.name in checker.outputs:
        return None
    joint = _joint(property_.property, given)
    if joint is None:
        return None
    try:
        return checker.asking(joint), checker.asking(given)
    except FaultError:
        return None


def _joint(property_: Property, given: Property) -> Property | None:
    match property_.expression, given.expression:
        case (
            Filter(values=Probability(operator=operator, path=path)) as whole,
            Filter(values=Probability(path=condition)),
        ):
            both = Probability(operator, BinaryFormula(BinaryOperator.AND, path, condition))
            return replace(property_, expression=replace(whole, values=both))
    return None


def quotient(joint: Exact, given: Exact) -> Exact | None:
    """The conditional probability; `None` if no trace satisfies the condition, or the values are not known."""
    is_for_all = joint.agrees and given.agrees
    whole, condition = (joint.uniform, given.uniform) if not is_for_all else (joint.minimum, given.minimum)
    if whole is None or condition is None or condition.lower <= 0.0:
        return None
    if is_for_all:
        whole = Bounds(joint.minimum.lower, joint.maximum.upper)
        condition = Bounds(given.minimum.lower, given.maximum.upper)
    value = Bounds(max(0.0, whole.lower / condition.upper), min(1.0, whole.upper / condition.lower))
    return _valued(joint, value, is_for_all=is_for_all)


def _valued(exact: Exact, value: Bounds, *, is_for_all: bool) -> Exact:
    """The values with another one under uniform choices. If it is not that of all schedulers, the minimum is only known
    not to be greater, and the maximum not to be less."""
    minimum = value if is_for_all else Bounds(-math.inf, value.upper)
    maximum = value if is_for_all else Bounds(value.lower, math.inf)
    return replace(exact, minimum=minimum, maximum=maximum, uniform=value, proof=None, traces=())
