# SPDX-License-Identifier: Apache-2.0
"""The values that an experiment gives to a parameter, from the texts in which users write them.

- Numbers are exact: `0.1` is a tenth, and `1/3` a third, so a range contains the numbers that it names.
- A range is written with its step at the end (`20:200:20`) or in the middle, as in PRISM and Storm (`0.1:0.1:0.9`).
  Usually only one of these has more than one number. If both have, and they differ, the text is refused.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TypeAlias

from roaml.exact_number import exact_fraction
from roaml.record import Record

MAX_VALUES = 100_000
"""The maximum number of values of one parameter, and of points of one experiment."""
Setting: TypeAlias = tuple[tuple[str, str], ...]
"""The name of each parameter with its value, as it is written in files and on the command line."""


class SweepError(ValueError):
    """Raised if a text does not state the values of a parameter. The message contains the reason."""


class Sweep(Record, frozen=True):
    """A parameter with its values, as texts.

    Attributes:
        values: the values, in the order in which the user has written them, without repetitions.
    """

    name: str
    values: tuple[str, ...]

    @property
    def numbers(self) -> tuple[float, ...] | None:
        """The values as numbers; `None` if one of them is not a number."""
        numbers = [exact_fraction(value) for value in self.values]
        return tuple(float(number) for number in numbers if number is not None) if None not in numbers else None


def number_text(number: Fraction) -> str:
    """A number as text: as a decimal number if it has few digits, otherwise as a fraction."""
    rest, twos_and_fives = number.denominator, 0
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
            twos_and_fives += 1
    if rest != 1 or twos_and_fives > 60:
        return f"{number.numerator}/{number.denominator}"
    digits = next(d for d in itertools.count() if (number * 10**d).denominator == 1)
    scaled = abs(number.numerator) * 10**digits // number.denominator
    text = str(scaled).rjust(digits + 1, "0")
    sign = "-" if number < 0 else ""
    return sign + (f"{text[:-digits]}.{text[-digits:]}" if digits else text)


def sweep_of(text: str) -> Sweep:
    """The sweep in a text such as `capacity=20:200:20`, `loss=0,0.01,1/20` or `mode=fast,slow`.

    Raises:
        SweepError: the text does not have this form.
    """
    name, equals, values = (part.strip() for part in text.partition("="))
    if not name or not equals or not values:
        raise SweepError(f"write `NAME=VALUES`, such as `capacity=20:200:20` or `loss=0,0.01`, instead of `{text}`")
    return Sweep(name, values_in(values, name))


def values_in(text: str, name: str) -> tuple[str, ...]:
    """The values that a text lists: numbers, words, and ranges, separated by commas.

    Raises:
        SweepError: an entry is empty, or a range is not valid.
    """
    values: dict[str, None] = {}
    for part in text.split(","):
        entry = part.strip()
        if not entry:
            raise SweepError(f"a value of `{name}` is missing in `{text}`")
        for value in _range(entry, name) if ":" in entry else (entry,):
            values[value] = None
        if len(values) > MAX_VALUES:
            raise SweepError(f"`{name}` has more than {MAX_VALUES:,} values")
    return tuple(values)


def _range(text: str, name: str) -> Iterator[str]:
    parts = [exact_fraction(part) for part in text.split(":")]
    if len(parts) not in (2, 3) or None in parts:
        raise SweepError(
            f"`{text}` is not a range of `{name}`; write `LOW:HIGH:STEP` or `LOW:STEP:HIGH` with numbers, such as "
            "`20:200:20`"
        )
    low, second, *rest = [part for part in parts if part is not None]
    readings = ((rest[0], second), (second, rest[0])) if rest else ((Fraction(1), second),)
    ranges = {
        (low, step, count) for step, high in readings if step > 0 and (count := math.floor((high - low) / step)) > 0
    }
    if not ranges:
        step_of = "" if rest else " with the step 1"
        raise SweepError(
            f"the range `{text}` of `{name}` contains fewer than two numbers{step_of}; write the values with commas, "
            "or `LOW:HIGH:STEP`"
        )
    if len(ranges) > 1:
        raise SweepError(
            f"the range `{text}` of `{name}` can be read with its step at the end and with its step in the middle; "
            "write the values with commas"
        )
    ((low, step, count),) = ranges
    if count >= MAX_VALUES:
        raise SweepError(f"`{name}` has more than {MAX_VALUES:,} values")
    yield from (number_text(low + index * step) for index in range(count + 1))


def sweeps_of(texts: Iterable[str]) -> tuple[Sweep, ...]:
    """The sweeps in texts.

    Raises:
        SweepError: a text is not valid, a parameter is named twice, or there are too many points.
    """
    sweeps: dict[str, Sweep] = {}
    for text in texts:
        sweep = sweep_of(text)
        if sweep.name in sweeps:
            raise SweepError(f"the values of `{sweep.name}` are given twice; separate all of them by commas")
        sweeps[sweep.name] = sweep
    points = math.prod(len(sweep.values) for sweep in sweeps.values())
    if points > MAX_VALUES:
        raise SweepError(f"the experiment has {points:,} points, more than {MAX_VALUES:,}")
    return tuple(sweeps.values())


def settings_of(sweeps: Sequence[Sweep]) -> list[Setting]:
    """All points of a grid, the values of the last parameter varying fastest."""
    names = [sweep.name for sweep in sweeps]
    return [tuple(zip(names, values, strict=True)) for values in itertools.product(*(s.values for s in sweeps))]
