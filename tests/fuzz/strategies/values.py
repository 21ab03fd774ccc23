# SPDX-License-Identifier: Apache-2.0
"""Random JANI networks: the exact values over all states, the same after reductions, and the traces of the same
networks."""

from __future__ import annotations

import json
from collections.abc import Iterator
from random import Random

from scipy.stats import binom

from fuzz.networks import NetworkCase, bounded
from fuzz.strategy import Failure, Strategy
from roaml import api
from roaml.explicit.independence import can_be_reduced
from roaml.explicit.space import LimitError, StateLimits, explore
from roaml.explicit.values import NoValueError, values_of
from roaml.jani.reader import read_model
from roaml.json_syntax import parse
from roaml.smc.fault import FaultError
from roaml.smc.pool import Alone
from roaml.smc.run import EstimationMethod, Options
from roaml.smc.statistics import Bounds

MAX_STATES = 20_000
TRACES = 2_000
STEPS = 2_000
ERROR = 1e-9
"""The probability with which a correct answer is a failure: once in a billion cases."""
TOLERANCE = 1e-9
"""Of the bounds of exact values, which are rounded."""


class Network(NetworkCase):
    def run(self) -> Iterator[Failure]:
        value, _ = parse(json.dumps(self.written))
        model, _ = read_model(value, "model.jani")
        assert model is not None
        try:
            checker = api.checker(model)
            property_ = checker.compiled_properties[0]
            space = explore(checker, property_, StateLimits(states=MAX_STATES))
            if space.problem is not None:
                return
            exact = values_of(space)
        except (FaultError, LimitError, NoValueError):
            return
        compiled = checker.compiled(property_)
        if can_be_reduced(compiled.program, compiled.goal):
            reduced = values_of(explore(checker, property_, StateLimits(states=MAX_STATES), is_reduced=True))
            if not _overlap(reduced.minimum, exact.minimum) or not _overlap(reduced.maximum, exact.maximum):
                yield Failure("reductions change the exact values", f"{exact}\n{reduced}")
        options = Options(method=EstimationMethod.FIXED, max_traces=TRACES, max_steps=STEPS, seed=self.seed)
        try:
            tally = checker.answer(property_, options, Alone(checker.compiled(property_))).tally
        except FaultError as error:
            yield Failure("a trace has an error, and no state has", str(error))
            return
        lower, upper = exact.uniform
        # Each interval contains its value. So those of ordered values may overlap.
        ordered = exact.minimum.lower - TOLERANCE <= upper and lower <= exact.maximum.upper + TOLERANCE
        if not ordered or any(low > high for low, high in (exact.minimum, exact.uniform, exact.maximum)):
            yield Failure("the exact values are not in order", f"{exact}")
        successes, possible = tally.successes, tally.successes + tally.undecided
        too_many = binom.sf(successes - 1, TRACES, min(1.0, upper + TOLERANCE))
        too_few = binom.cdf(possible, TRACES, max(0.0, lower - TOLERANCE))
        if min(too_many, too_few) < ERROR:
            details = f"{successes} to {possible} of {TRACES} traces; the exact value is in [{lower!r}, {upper!r}]"
            yield Failure("the exact value contradicts the traces", details)


def _overlap(one: Bounds, other: Bounds) -> bool:
    return max(one.lower, other.lower) <= min(one.upper, other.upper) + TOLERANCE


def make(seed: int) -> Network:
    return Network(seed, bounded(Random(seed)))


STRATEGY = Strategy("values", "compares exact values of random JANI networks with their traces", make)
