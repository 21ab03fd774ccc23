# SPDX-License-Identifier: Apache-2.0
"""Comparisons with a number as users write them: `>= 0.95`; what one is worth that is not known to hold for all
schedulers."""

from __future__ import annotations

import math

from roaml.exhaustive import Vocabulary
from roaml.record import Record
from roaml.regex import regex

_SPELLINGS = {">=": ">=", "≥": ">=", "<=": "<=", "≤": "<=", ">": ">", "<": "<", "==": "==", "=": "=="}
_FORM = regex(r"\s*(>=|<=|==|≥|≤|>|<|=)\s*(\S+)\s*")


class Comparison(Record, frozen=True):
    """A comparison with `number`. `relation` is one of `>=`, `<=`, `>`, `<` and `==`."""

    relation: str
    number: float


class UniformPolicy(Vocabulary):
    """What an expectation is worth that is met under uniform choices, but not known to be met under all schedulers.

    Attributes:
        ACCEPT: it is met.
        WARN: it is met, and a warning reports it.
        FAIL: it is not met.
    """

    ACCEPT = "accept"
    WARN = "warn"
    FAIL = "fail"


def read_comparison(text: str) -> Comparison | None:
    """The comparison in `text`; `None` if `text` is not an operator followed by a number."""
    match = _FORM.fullmatch(text)
    try:
        number = float(match[2]) if match else math.nan
    except ValueError:
        return None
    return None if match is None or math.isnan(number) else Comparison(_SPELLINGS[match[1]], number)


def effect_on_probabilities(comparison: Comparison) -> str:
    """What every probability does with an expectation: "always met" or "never met"; "" if it depends on the
    probability."""
    number, is_equality = comparison.number, comparison.relation == "=="
    if is_equality:
        return "" if 0 <= number <= 1 else "never met"
    is_lower = comparison.relation in (">=", ">")
    is_strict = comparison.relation in (">", "<")
    beyond_all = number - 1 if is_lower else -number  # 0 at the last probability that can meet it
    beneath_all = -number if is_lower else number - 1
    if beyond_all > 0 or (beyond_all == 0 and is_strict):
        return "never met"
    return "always met" if beneath_all > 0 or (beneath_all == 0 and not is_strict) else ""


def as_written(value: float) -> str:
    """A number that a user has written, with all of its digits."""
    text = f"{value:g}"
    return text if float(text) == value else repr(value).removesuffix(".0")
