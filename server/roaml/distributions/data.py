# SPDX-License-Identifier: Apache-2.0
"""Distributions that are read from data (docs/spec/distributions.md#data)."""

from __future__ import annotations

import csv
from fractions import Fraction

from roaml.distributions.laws import LawError, ListedLaw
from roaml.exact_number import exact_fraction


def read_histogram(text: str) -> ListedLaw:
    """The distribution of the values in a CSV file: a column of values, and optionally one with their numbers.

    Raises:
        LawError: the file contains no values, or a row that is not valid.
    """
    counts: dict[Fraction, Fraction] = {}
    rows = ((number, row) for number, row in enumerate(csv.reader(text.splitlines()), 1) if _has_data(row))
    for place, (number, row) in enumerate(rows):
        value = exact_fraction(row[0])
        if value is None and place == 0:
            continue  # the names of the columns
        count = exact_fraction(row[1]) if len(row) > 1 and row[1].strip() else Fraction(1)
        if value is None or count is None or count < 0:
            raise LawError(f"line {number} is `{','.join(row)}` instead of a number, or of a value and its number")
        counts[value] = counts.get(value, Fraction(0)) + count
    total = sum(counts.values(), Fraction(0))
    if total <= 0:
        raise LawError("it contains no values")
    ordered = sorted(counts)
    return ListedLaw(tuple(ordered), tuple(float(counts[value] / total) for value in ordered))


def _has_data(row: list[str]) -> bool:
    return any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
