# SPDX-License-Identifier: Apache-2.0
"""The points of an experiment: the value of a property for one setting, with what is known about it."""

from __future__ import annotations

import math
from typing import Any, Protocol

from roaml.exhaustive import Vocabulary
from roaml.experiments.sweeps import Setting
from roaml.record import Record
from roaml.smc.goal import Question
from roaml.smc.run import Answer
from roaml.smc.statistics import Bounds
from roaml.verification.headline import too_wide, undecided_reason
from roaml.verification.number_text import without_noise
from roaml.verification.results import is_close, is_same
from roaml.verification.schedulers import is_minimised


class PointKind(Vocabulary):
    """How a value was computed."""

    EXACT = "exact"
    ESTIMATE = "estimate"
    UNKNOWN = "unknown"


class Schedulers(Vocabulary):
    """The schedulers for which a value is valid."""

    ALL = "all schedulers"
    MINIMUM = "minimum over all schedulers"
    MAXIMUM = "maximum over all schedulers"
    UNIFORM = "uniform choices"


class ExperimentPoint(Record, frozen=True):
    """The value of a property for one setting.

    Attributes:
        name: the name of the property.
        value: the value; not a number if there is none. Infinity is a value.
        low, high: the ends of the interval of an estimate, with the confidence of the experiment for each point by
            itself; for an exact value, bounds that enclose it.
        minimum, maximum, uniform: the exact values under other schedulers, as far as they were computed.
        states: the number of states that were explored; 0 for an estimate.
        traces: the number of traces; 0 for an exact value.
        note: what limits the meaning of the value, or why there is none.
        slopes: the derivatives by parameters, if they are requested and exist.
        limit: of an estimate, the option whose limit ended the search for exact values, such as `max-states`; "" if
            none did.
    """

    setting: Setting
    name: str
    kind: PointKind
    schedulers: Schedulers
    value: float
    low: float
    high: float
    minimum: float | None = None
    maximum: float | None = None
    uniform: float | None = None
    states: int = 0
    traces: int = 0
    note: str = ""
    slopes: tuple[tuple[str, float], ...] = ()
    limit: str = ""

    @property
    def key(self) -> str:
        """What identifies the point in its experiment, for views."""
        return " ".join([self.name, *(f"{parameter}={value}" for parameter, value in self.setting)])

    @property
    def has_value(self) -> bool:
        return not math.isnan(self.value)

    def as_json(self) -> dict[str, Any]:
        """The point as a value for JSON. Numbers that JSON cannot express are texts: `inf`."""
        fields = ("value", "low", "high", "minimum", "maximum", "uniform")
        return {
            "setting": dict(self.setting),
            "property": self.name,
            "kind": self.kind.value,
            "schedulers": self.schedulers.value,
            **{name: _json_number(getattr(self, name)) for name in fields},
            "states": self.states,
            "traces": self.traces,
            "note": self.note,
            "slopes": dict(self.slopes),
            "limit": self.limit,
        }


def point_from_json(data: dict[str, Any]) -> ExperimentPoint:
    """The point that `ExperimentPoint.as_json` has written.

    Raises:
        ValueError, KeyError, TypeError: the data are not those of a point.
    """
    value, low, high = (math.nan if data[name] is None else float(data[name]) for name in ("value", "low", "high"))
    minimum, maximum, uniform = (
        None if data[name] is None else float(data[name]) for name in ("minimum", "maximum", "uniform")
    )
    return ExperimentPoint(
        tuple((str(name), str(text)) for name, text in data["setting"].items()),
        str(data["property"]),
        PointKind(data["kind"]),
        Schedulers(data["schedulers"]),
        value,
        low,
        high,
        minimum,
        maximum,
        uniform,
        int(data["states"]),
        int(data["traces"]),
        str(data["note"]),
        tuple((str(name), float(slope)) for name, slope in data["slopes"].items()),
        str(data.get("limit", "")),
    )


def _json_number(number: float | None) -> float | str | None:
    if number is None or math.isnan(number):
        return None
    return number if math.isfinite(number) else str(number)


class ExactValues(Protocol):
    """The exact values of a property, such as `values.GoalValues` and `results.Exact`."""

    @property
    def minimum(self) -> Bounds: ...

    @property
    def maximum(self) -> Bounds: ...

    @property
    def uniform(self) -> Bounds | None: ...


def exact_point(
    setting: Setting,
    question: Question,
    values: ExactValues,
    *,
    states: int,
    can_get_stuck: bool,
    only_uniform: bool,
) -> ExperimentPoint:
    """The point with exact values.

    Args:
        only_uniform: whether the value under uniform choices is requested. It must be known then.
    """
    minimum, maximum, uniform = values.minimum, values.maximum, values.uniform
    if question.is_reward:
        minimum, maximum = without_noise(minimum), without_noise(maximum)
        uniform = None if uniform is None else without_noise(uniform)
    agrees = is_same(minimum, maximum)
    if uniform is None and is_close(minimum, maximum):
        uniform = Bounds(minimum.lower, maximum.upper)
    if agrees:
        schedulers, asked = Schedulers.ALL, minimum if uniform is None else uniform
    elif only_uniform:
        assert uniform is not None
        schedulers, asked = Schedulers.UNIFORM, uniform
    elif is_minimised(question):
        schedulers, asked = Schedulers.MINIMUM, minimum
    else:
        schedulers, asked = Schedulers.MAXIMUM, maximum
    return ExperimentPoint(
        setting,
        question.name,
        PointKind.EXACT,
        schedulers,
        _middle(asked),
        asked.lower,
        asked.upper,
        _extreme(minimum),
        _extreme(maximum),
        None if uniform is None else _middle(uniform),
        states,
        note="some traces get stuck" if can_get_stuck else "",
    )


def _extreme(bounds: Bounds) -> float | None:
    """The value of a minimum or maximum; `None` if only one of its bounds is known."""
    return None if bounds.lower != bounds.upper and math.inf in (-bounds.lower, bounds.upper) else _middle(bounds)


def _middle(bounds: Bounds) -> float:
    return bounds.lower if bounds.lower == bounds.upper else (bounds.lower + bounds.upper) / 2


def estimated_point(setting: Setting, answer: Answer, stuck: int = 0) -> ExperimentPoint:
    """The point with the estimate from traces with uniform choices.

    Args:
        stuck: the number of traces that got stuck.
    """
    tally = answer.tally
    notes = []
    if tally.undecided:
        notes.append(f"{tally.undecided:,} of {tally.traces:,} traces undecided, because {undecided_reason(answer)}")
    if stuck:
        notes.append(f"{stuck:,} of {tally.traces:,} traces got stuck")
    if answer.question.is_conditional and not tally.traces:
        notes.append(f"none of {tally.rejected:,} traces satisfies the condition")
    elif answer.is_too_wide:
        notes.append(too_wide(answer))
    value = math.nan if answer.is_unknown else answer.value
    return ExperimentPoint(
        setting,
        answer.question.name,
        PointKind.UNKNOWN if math.isnan(value) else PointKind.ESTIMATE,
        Schedulers.UNIFORM,
        value,
        answer.bounds.lower,
        answer.bounds.upper,
        traces=tally.traces,
        note="; ".join(notes),
    )


def unknown_point(setting: Setting, name: str, reason: str) -> ExperimentPoint:
    """The point of a property that has no value, with the reason."""
    nan = math.nan
    return ExperimentPoint(setting, name, PointKind.UNKNOWN, Schedulers.UNIFORM, nan, nan, nan, note=reason)
