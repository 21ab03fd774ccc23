# SPDX-License-Identifier: Apache-2.0
"""Reports how numbers from distributions are discretised (docs/spec/distributions.md#error)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from roaml.text import Location

if TYPE_CHECKING:
    from roaml.expansion.draws import DrawnNumber


def lines(drawn: Sequence[DrawnNumber], place_of: Callable[[Location], str]) -> Iterator[str]:
    """A line for each distribution whose values are not exact."""
    for number in drawn:
        if not number.shift and not number.cut:
            continue
        values = f"{number.values:,} values"
        if number.shift:
            shift = f"{float(number.shift):g} {number.unit}".rstrip()
            values += f", each at most {shift} from the drawn number"
        cut = f"; numbers with a probability of at most {number.cut:.1g} are cut" if number.cut > 0 else ""
        yield f"drawn: {number.text} ({place_of(Location(number.path, number.span))}) with {values}{cut}"


def rows(drawn: Sequence[DrawnNumber], place_of: Callable[[Location], dict[str, Any]]) -> list[dict[str, Any]]:
    """The distributions as values for JSON: each with its place, the number of values, how far they are from the drawn
    numbers at most, and the probability of the numbers that are cut."""
    return [
        {
            "distribution": number.text,
            **place_of(Location(number.path, number.span)),
            "values": number.values,
            "shift": float(number.shift),
            "cut": number.cut,
            **({"unit": number.unit} if number.unit else {}),
        }
        for number in drawn
    ]
