# SPDX-License-Identifier: Apache-2.0
"""Distributions of numbers, and their discretisation for models with finitely many states
(docs/spec/distributions.md).

    laws      the distributions: `normal(2, 0.3)`; their probabilities
    data      distributions that are read from files
    outcomes  a distribution -> values with probabilities, and a bound of the error
"""

from roaml.regex import regex

_NAMES = (
    "bernoulli",
    "binomial",
    "categorical",
    "exponential",
    "geometric",
    "histogram",
    "normal",
    "poisson",
    "uniform",
)
"""The beginnings of the names of distributions."""
_CALL = regex(rf"\b(?:{'|'.join(_NAMES)}|uniform_int)\s*\(")


def calls_distribution(text: str) -> bool:
    """Whether a text may contain a call of a distribution. Most texts contain none of the names, which is found four
    times as fast as a match."""
    return any(name in text for name in _NAMES) and _CALL.search(text) is not None
