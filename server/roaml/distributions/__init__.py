# SPDX-License-Identifier: Apache-2.0
"""Distributions of numbers, and their discretisation for models with finitely many states
(docs/spec/distributions.md).

    laws      the distributions: `normal(2, 0.3)`; their probabilities
    data      distributions that are read from files
    outcomes  a distribution -> values with probabilities, and a bound of the error
"""

from roaml.regex import regex

CALL = regex(
    r"\b(?:bernoulli|binomial|categorical|exponential|geometric|histogram|normal|poisson|uniform|uniform_int)\s*\("
)
"""The begin of a call of a distribution."""
