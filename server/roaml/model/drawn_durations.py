# SPDX-License-Identifier: Apache-2.0
"""Durations as users write them in mocks and channels: `250 ms`, or drawn from a distribution, `normal(8 s, 2 s)`
(docs/spec/mocks.md#durations, docs/spec/channels.md#delay)."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from roaml.exact_number import exact_fraction
from roaml.record import Record
from roaml.regex import regex
from roaml.suggest import close_names, did_you_mean

if TYPE_CHECKING:
    from roaml.distributions.outcomes import Outcomes

_DURATION = regex(r"(\d+(?:\.\d+)?)\s*(ms|s|min)\Z")
_DRAWN = regex(r"([^\s(]*)\s*\((.*)\)\Z")
_MILLISECONDS = {"ms": 1, "s": 1000, "min": 60_000}


class DurationError(ValueError):
    """A duration is not valid; the message states the reason."""


class DrawnDuration(Record, frozen=True):
    """A duration that is drawn from a distribution each time.

    Attributes:
        text: the distribution as it is written: `normal(8 s, 2 s)`.
        name: the name of the distribution.
        arguments: its arguments; durations in ms.
    """

    text: str
    name: str
    arguments: tuple[Fraction, ...]

    @property
    def is_continuous(self) -> bool:
        """Whether the duration can have any value in an interval."""
        from roaml.distributions.laws import LAWS  # noqa: PLC0415 - few models need it

        return LAWS[self.name].is_continuous

    def ticks(self, period: Fraction) -> Outcomes:
        """The numbers of periods that the duration takes, rounded up; 0 for a negative duration.

        Args:
            period: the length of a period, in ms.

        Raises:
            LawError: there are too many different numbers of periods.
        """
        from roaml.distributions.laws import LAWS  # noqa: PLC0415 - few models need it
        from roaml.distributions.outcomes import Outcomes, Rounding, outcomes  # noqa: PLC0415

        drawn = outcomes(LAWS[self.name].law(self.arguments), period, Rounding.UP)
        shares: dict[Fraction, float] = {}
        for value, share in sorted(zip(drawn.values, drawn.probabilities, strict=True)):
            ticks = max(value / period, Fraction(0))
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
    from roaml.distributions.laws import LAWS, LawError  # noqa: PLC0415 - few models need it

    match = _DRAWN.match(written)
    if match is None:
        raise DurationError(f"`{written}`{place} is not a distribution such as `normal(8 s, 2 s)`")
    name, arguments = match.groups()
    function = LAWS.get(name)
    if function is None or not function.has_units:
        known = [law.name for law in LAWS.values() if law.has_units]
        close = close_names(name, known)
        hint = did_you_mean(close) if close else f"; the distributions of durations are {', '.join(known)}"
        raise DurationError(f"`{name}`{place} is not a distribution of durations{hint}")
    values = []
    for position, argument in enumerate(arguments.split(",")):
        is_share = function.parameters[position % len(function.parameters)] == "p"
        value = exact_fraction(argument.strip()) if is_share else milliseconds(argument.strip())
        if value is None:
            what = "a probability such as 0.2" if is_share else "a duration such as `2 s` or `250 ms`"
            raise DurationError(f"`{argument.strip()}`{place} is not {what}")
        values.append(value)
    try:
        function.law(values)
    except LawError as error:
        raise DurationError(f"`{written}`{place} is not a distribution: {error}") from None
    return DrawnDuration(written, name, tuple(values))


def milliseconds(text: str) -> Fraction | None:
    """The duration in `text`, in ms; `None` if `text` is not a duration such as `2 s`."""
    match = _DURATION.match(text)
    return None if match is None else Fraction(match[1]) * _MILLISECONDS[match[2]]
