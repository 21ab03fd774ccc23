# SPDX-License-Identifier: Apache-2.0
"""Durations as users write them in mocks and channels: `250 ms`, or drawn from a distribution, `normal(8 s, 2 s)` or
`geometric(0.9) * 100 ms` (docs/spec/mocks.md#durations, docs/spec/channels.md#delay)."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from roaml.exact_number import exact_fraction
from roaml.record import Record, replace
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean

if TYPE_CHECKING:
    from roaml.distributions.outcomes import Outcomes

_DURATION = regex(r"(\d+(?:\.\d+)?)\s*(ms|s|min)\Z")
_DRAWN = regex(r"([^\s(]*)\s*\((.*)\)\s*(?:\*\s*([^()*]*))?\Z")
_MILLISECONDS = {"ms": 1, "s": 1000, "min": 60_000}
_DATA = regex(r"""\s*(?P<quote>['"])(?P<file>[^'"]+)(?P=quote)\s*,\s*(?P<unit>[^\s,]+)\s*\Z""")
HISTOGRAM_FORM = "histogram('times.csv', s)"
"""How a distribution from data is written."""
DataReader: TypeAlias = Callable[[str], "str | None"]
"""The name of a file with data, as it is written -> its text; `None` if it cannot be read."""


class DurationError(ValueError):
    """A duration is not valid; the message states the reason."""


class DurationData(Record, frozen=True):
    """The file with the data of a distribution, and the unit of its values in ms."""

    file: str
    unit: Fraction


class DrawnDuration(Record, frozen=True):
    """A duration that is drawn from a distribution each time.

    Attributes:
        text: the distribution as it is written: `normal(8 s, 2 s)`.
        name: the name of the distribution.
        arguments: its arguments; durations in ms.
        data: the data of a histogram that has not been read yet; `None` for all others.
        unit: the duration in ms by which a drawn number is multiplied; `None` if the distribution is one of durations.
    """

    text: str
    name: str
    arguments: tuple[Fraction, ...]
    data: DurationData | None = None
    unit: Fraction | None = None

    def with_data(self, read: DataReader) -> DrawnDuration:
        """This distribution with its data: the distribution `categorical` of the values in the file.

        Raises:
            DurationError: the file cannot be read, or is not valid.
        """
        if self.data is None:
            return self
        from roaml.distributions.data import read_histogram  # noqa: PLC0415 - few models need it
        from roaml.distributions.laws import CATEGORICAL, LawError  # noqa: PLC0415

        text = read(self.data.file)
        if text is None:
            raise DurationError(f"there is no file `{self.data.file}` that can be read for `{self.text}`")
        try:
            law = read_histogram(text)
        except LawError as error:
            raise DurationError(f"`{self.data.file}`: {error}") from None
        shares = zip(law.values, law.probabilities, strict=True)
        arguments = tuple(number for value, share in shares for number in (value * self.data.unit, Fraction(share)))
        return replace(self, name=CATEGORICAL, arguments=arguments, data=None)

    @property
    def is_continuous(self) -> bool:
        """Whether the duration can have any value in an interval."""
        from roaml.distributions.laws import LAWS  # noqa: PLC0415 - few models need it

        return LAWS[self.name].is_continuous

    @property
    def parts(self) -> tuple[Fraction, ...]:
        """Durations in ms of which each value of a distribution that is not continuous is a multiple."""
        return self.arguments[::2] if self.unit is None else (self.unit,)

    def ticks(self, period: Fraction) -> Outcomes:
        """The numbers of periods that the duration takes, rounded up; 0 for a negative duration. The data of a
        histogram have been read.

        Args:
            period: the length of a period, in ms.

        Raises:
            LawError: there are too many different numbers of periods.
        """
        from roaml.distributions.laws import LAWS  # noqa: PLC0415 - few models need it
        from roaml.distributions.outcomes import Outcomes, Rounding, outcomes  # noqa: PLC0415

        law = LAWS[self.name].law(self.arguments)
        drawn = outcomes(law, period, Rounding.UP) if self.unit is None else outcomes(law)
        shares: dict[Fraction, float] = {}
        for value, share in sorted(zip(drawn.values, drawn.probabilities, strict=True)):
            ticks = Fraction(max(math.ceil(value * (self.unit or 1) / period), 0))
            shares[ticks] = shares.get(ticks, 0.0) + share
        return Outcomes(tuple(shares), tuple(shares.values()), cut=drawn.cut)


def read_duration(written: str, place: str) -> Fraction | DrawnDuration:
    """The duration in a text such as `2 s` or `normal(8 s, 2 s)`, in ms or as a distribution.

    Args:
        place: what messages say about the text: `` in `Drive: 0.9 in 2 s` ``.

    Raises:
        DurationError: `written` is not a duration.
    """
    if "(" in written:
        return _drawn_duration(written, place)
    duration = milliseconds(written)
    if duration is None:
        raise DurationError(
            f"`{written}`{place} is not a duration such as `2 s`, `250 ms`, `1 min` or `normal(8 s, 2 s)`"
        )
    return duration


def _drawn_duration(written: str, place: str) -> DrawnDuration:
    from roaml.distributions.laws import HISTOGRAM, LAWS, LawError  # noqa: PLC0415 - few models need it

    match = _DRAWN.match(written)
    if match is None:
        raise DurationError(f"`{written}`{place} is not a distribution such as `normal(8 s, 2 s)`")
    name, arguments, factor = match.groups()
    if name == HISTOGRAM and factor is None:
        return DrawnDuration(written, name, (), _data(written, arguments, place))
    function = LAWS.get(name)
    if function is None:
        close = close_names(name, LAWS)
        hint = did_you_mean(close) if close else f"; the distributions of durations are {', '.join(LAWS)}"
        raise DurationError(f"`{name}`{place} is not a distribution{hint}")
    is_time = function.has_units or name == HISTOGRAM
    if is_time and factor is not None:
        raise DurationError(f"`{written}`{place} is already a duration; remove `* {factor.strip()}`")
    values = []
    for position, argument in enumerate(arguments.split(",")):
        is_number = not is_time or function.parameters[position % len(function.parameters)] == "p"
        value = exact_fraction(argument.strip()) if is_number else milliseconds(argument.strip())
        if value is None:
            what = "a duration such as `2 s` or `250 ms`"
            if is_number:
                what = "a probability such as 0.2" if is_time else "a number without a unit"
            raise DurationError(f"`{argument.strip()}`{place} is not {what}")
        values.append(value)
    unit = None if is_time else milliseconds((factor or "").strip())
    if unit is None and not is_time:
        call = f"{name}({arguments.strip()})"
        raise DurationError(
            f"`{written}`{place} is not a duration, because `{name}` draws a number; multiply it by a duration, as in "
            f"`{call} * 100 ms`"
        )
    try:
        function.law(values)
    except LawError as error:
        raise DurationError(f"`{written}`{place} is not a distribution: {error}") from None
    return DrawnDuration(written, name, tuple(values), unit=unit)


def _data(written: str, arguments: str, place: str) -> DurationData:
    match = _DATA.match(arguments)
    unit = _MILLISECONDS.get(match["unit"]) if match is not None else None
    if match is None or unit is None:
        raise DurationError(
            f"`{written}`{place} is not a distribution: it needs the name of a file in quotes and the unit of its "
            f"values, {', '.join(_MILLISECONDS)}; write for example `{HISTOGRAM_FORM}`"
        )
    return DurationData(match["file"], Fraction(unit))


def milliseconds(text: str) -> Fraction | None:
    """The duration in `text`, in ms; `None` if `text` is not a duration such as `2 s`."""
    match = _DURATION.match(text)
    return None if match is None else Fraction(match[1]) * _MILLISECONDS[match[2]]
