# SPDX-License-Identifier: Apache-2.0
"""Curves that follow from one set of traces with uniform choices, with their bands.

- *Simultaneous* bands contain the whole true curve with the stated confidence: for distribution functions by the
  inequality of Dvoretzky, Kiefer and Wolfowitz with the constant of Massart (1990); for medians by order statistics,
  with the error divided by the number of times (Bonferroni).
- *Pointwise* bands contain the true value at each single place with the stated confidence: Clopper-Pearson intervals
  for distribution functions, order statistics for medians.
- A trace that was cut might have gone on in any way. The lower end of a band assumes the one extreme, the upper end the
  other.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence

from roaml.experiments.bands import BandKind
from roaml.experiments.quantiles import value_of_rank
from roaml.experiments.traces import LEAST_TRACES, TraceEnd, Trajectories, trajectories, variable_named
from roaml.figures.plot import LinePlot, PlotAxis, PlotPoint, Series
from roaml.record import Record, replace
from roaml.smc.affordable import Affordable
from roaml.smc.goal import CompiledProperty
from roaml.smc.model import ModelChecker
from roaml.smc.program import FALSE, TRUE, UNKNOWN
from roaml.smc.run import Options
from roaml.smc.statistics import clopper_pearson

MAX_PLACES = 200
"""The maximum number of places at which a curve is computed."""
MEDIAN_PLACES = 60
"""The number of times at which the median of a variable is computed."""
DEFAULT_EPSILON = 0.02
"""Half the width of a simultaneous band, if it is not given."""
MEDIAN_TRACES = 1000
"""The number of traces for the median of a variable, if it is not given and they are not long."""
MEDIAN_STEPS = 10_000_000
"""The number of steps of these traces together. Reading a variable takes many times as long as a step."""


class CurvePoint(Record, frozen=True):
    """A place of a curve: the value, and the ends of the band there."""

    x: float
    value: float
    low: float
    high: float


class Curve(Record, frozen=True):
    """A curve with its band.

    Attributes:
        name: what the curve shows, for the legend.
        across: the name of the horizontal axis, with its unit.
        points: the places in ascending order. The value of a step function is valid until the next place.
        undecided: the number of traces that were cut.
        subject: what the curve is about; curves with the same subject have the same color. "" for a color of its own.
        is_dashed: whether it is drawn as a dashed line.
        remark: why there are fewer traces than usual, as a phrase; "" if there are not.
    """

    name: str
    across: str
    points: tuple[CurvePoint, ...]
    band: BandKind
    confidence: float
    traces: int
    undecided: int
    subject: str = ""
    is_dashed: bool = False
    remark: str = ""

    @property
    def band_words(self) -> str:
        """What the bands of such curves mean, as a sentence without a full stop."""
        what = "the whole curve" if self.band is BandKind.SIMULTANEOUS else "each value by itself"
        confidence = f"{self.confidence:g} confidence ({self.band.value})"
        cut = f"; {self.undecided:,} traces were cut, which widens the band" if self.undecided else ""
        remark = f" ({self.remark})" if self.remark else ""
        traces = f"{self.traces:,} traces with uniform choices{remark}"
        return f"{traces}; the shaded band contains {what} with {confidence}{cut}"


def traces_for(options: Options, default: float = DEFAULT_EPSILON) -> int:
    """The number of traces with which a simultaneous band has half the width `options.epsilon`; `options.max_traces`
    if there are fewer.

    Args:
        default: half the width if `options` has the default of estimates.
    """
    epsilon = default if options.epsilon == Options().epsilon else options.epsilon
    traces = math.ceil(math.log(2 / (1 - options.confidence)) / (2 * epsilon**2))
    return traces if options.max_traces is None else min(traces, options.max_traces)


def distribution(
    ends: Sequence[TraceEnd], place: Callable[[TraceEnd], float], verdict: int, name: str, across: str,
    band: BandKind, confidence: float,
) -> Curve:  # fmt: skip
    """The probability that a trace ends with a verdict at or before each place.

    Args:
        place: the place at which a trace ends: a time, a number of steps, or a reward.
        verdict: TRUE or FALSE.
    """
    reached = sorted(place(end) for end in ends if end.verdict == verdict)
    cut = sorted(place(end) for end in ends if end.verdict == UNKNOWN)
    every = sorted(place(end) for end in ends)
    count = len(ends)
    width = math.sqrt(math.log(2 / (1 - confidence)) / (2 * count))
    points = []
    for x in _places(reached, every):
        before, open_ = bisect_right(reached, x), bisect_right(cut, x)
        if band is BandKind.SIMULTANEOUS:
            low, high = before / count - width, (before + open_) / count + width
        else:
            low, high = clopper_pearson(before, count, confidence, open_)
        points.append(CurvePoint(x, before / count, max(0.0, low), min(1.0, high)))
    return Curve(name, across, tuple(points), band, confidence, count, len(cut))


def _places(reached: Sequence[float], every: Sequence[float]) -> list[float]:
    """The places of a step function: 0, where it rises, and the last end of a trace. If there are many, quantiles."""
    rises = sorted({place for place in reached if math.isfinite(place)})
    if len(rises) > MAX_PLACES:
        rises = [rises[round(i * (len(rises) - 1) / (MAX_PLACES - 1))] for i in range(MAX_PLACES)]
    last = max((place for place in every if math.isfinite(place)), default=0.0)
    return sorted({min(0.0, *rises[:1]), *rises, last})


def verdict_curves(
    checker: ModelChecker,
    property_: CompiledProperty,
    options: Options,
    clock: tuple[str, str] | None,
    band: BandKind = BandKind.SIMULTANEOUS,
) -> tuple[Curve, ...]:
    """The probability that a property is decided at or before a time, and holds, or fails. A curve without any trace
    is left out. For a reward, the distribution of the reward.

    Args:
        options: the confidence, the number of traces (`traces_for`), the limit of steps and the seed.
        clock: the variables with the seconds and nanoseconds of the time; `None` to count steps.
    """
    traces = trajectories(checker, property_, options, clock)
    chosen = _chosen(traces, traces_for(options), options)
    ends = list(traces.ends(chosen.traces))
    name, question = property_.question.name, property_.question
    if question.is_reward:
        label = f"{name}: distribution of the reward"
        curve = distribution(ends, _reward_of, TRUE, label, "reward", band, options.confidence)
        return (replace(curve, remark=chosen.remark),)
    across = "steps" if clock is None else "time (s)"
    curves = []
    for verdict, words in ((TRUE, "decided, holds"), (FALSE, "decided, fails")):
        if any(end.verdict == verdict for end in ends):
            label = f"{name}: {words}"
            curve = distribution(ends, _time_of, verdict, label, across, band, options.confidence)
            curves.append(replace(curve, subject=name, is_dashed=verdict == FALSE, remark=chosen.remark))
    return tuple(curves)


def _chosen(traces: Trajectories, wanted: int, options: Options, max_steps: int | None = None) -> Affordable:
    """How many traces are generated: as many as are asked for, otherwise fewer if they are long."""
    return Affordable(wanted, wanted) if options.max_traces is not None else traces.affordable(wanted, max_steps)


def _time_of(end: TraceEnd) -> float:
    return end.time


def _reward_of(end: TraceEnd) -> float:
    return end.reward


def median_curves(
    checker: ModelChecker,
    variable: str,
    options: Options,
    clock: tuple[str, str] | None,
    band: BandKind = BandKind.SIMULTANEOUS,
) -> tuple[Curve, ...]:
    """The median of a variable over time, with its band, and the values below which 5 and 95 percent of the traces are,
    without bands. The traces go on to their ends, whatever the properties are.

    Args:
        variable: `Machine.variable` or the name of a variable of the model.

    Raises:
        ValueError: there is no such variable.
    """
    storage = variable_named(checker, variable)
    if options.max_traces is None:
        options = replace(options, max_steps=min(options.max_steps, MEDIAN_STEPS // LEAST_TRACES))
    traces = trajectories(checker, checker.stuck, options, clock)
    chosen = _chosen(traces, options.max_traces or MEDIAN_TRACES, options, MEDIAN_STEPS)
    count = chosen.traces
    paths = list(traces.values(storage, count))
    end = max((path[-1][0] for path, _ in paths), default=0.0)
    times = [end * i / (MEDIAN_PLACES - 1) for i in range(MEDIAN_PLACES)] if end else [0.0]
    across = "steps" if clock is None else "time (s)"
    share = 1 if band is BandKind.POINTWISE else len(times)
    lower_rank = _rank(count, 1 - (1 - options.confidence) / share)
    cut = sum(is_cut for _, is_cut in paths)
    medians, fifth, ninety_fifth = [], [], []
    for time in times:
        known, unknown = [], 0
        for path, is_cut in paths:
            if is_cut and time > path[-1][0]:
                unknown += 1
            else:
                known.append(path[bisect_right(path, (time, math.inf)) - 1][1])
        known.sort()
        low = value_of_rank(known, lower_rank - unknown)
        high = value_of_rank(known, count + 1 - lower_rank)
        medians.append(CurvePoint(time, _quantile(known, 0.5), low, high))
        fifth.append(_plain(time, _quantile(known, 0.05)))
        ninety_fifth.append(_plain(time, _quantile(known, 0.95)))
    name = f"median of {variable}"
    curves = [Curve(name, across, tuple(medians), band, options.confidence, count, cut, remark=chosen.remark)]
    for points, share_words in ((fifth, "5"), (ninety_fifth, "95")):
        name = f"{share_words} % of the traces are below"
        curves.append(Curve(name, across, tuple(points), band, options.confidence, count, cut))
    return tuple(curves)


def _plain(time: float, value: float) -> CurvePoint:
    return CurvePoint(time, value, math.nan, math.nan)


def _rank(count: int, confidence: float) -> int:
    """The greatest rank from 1 such that the median is at least the value of this rank with an error of at most half of
    1 - `confidence`; 0 if there is none."""
    limit, total, rank = (1 - confidence) / 2, 0.0, 0
    while rank <= count:
        total += math.exp(
            math.lgamma(count + 1) - math.lgamma(rank + 1) - math.lgamma(count - rank + 1) - count * math.log(2)
        )
        if total > limit:
            return rank
        rank += 1
    return rank


def _quantile(known: Sequence[float], share: float) -> float:
    return known[min(len(known) - 1, max(0, math.ceil(share * len(known)) - 1))] if known else math.nan


def curve_plot(title: str, curves: Iterable[Curve], up: str = "probability") -> LinePlot:
    """A plot of curves. Notes below it state what the bands mean.

    Args:
        up: the name of the vertical axis.
    """
    curves = tuple(curves)
    is_probability = up == "probability"
    series = []
    for curve in curves:
        has_band = not _is_bare(curve)
        points = tuple(
            PlotPoint(p.x, p.value, p.low if has_band else None, p.high if has_band else None) for p in curve.points
        )
        is_dashed = curve.is_dashed or not has_band
        series.append(
            Series(curve.name, points, is_stepped=True, is_dashed=is_dashed, has_marks=False, subject=curve.subject)
        )
    notes = dict.fromkeys(curve.band_words for curve in curves if not _is_bare(curve))
    y = PlotAxis(up, low=0.0, high=1.0) if is_probability else PlotAxis(up)
    across = curves[0].across if curves else "time (s)"
    return LinePlot(
        title, PlotAxis(across, low=0.0) if is_probability else PlotAxis(across), y, tuple(series), tuple(notes)
    )


def _is_bare(curve: Curve) -> bool:
    """Whether a curve has no band."""
    return all(math.isnan(point.low) for point in curve.points)
