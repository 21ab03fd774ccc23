# SPDX-License-Identifier: Apache-2.0
"""A plot of times by sizes, with logarithmic scales on both axes, so that linear growth is a line with slope 1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roaml.figures.plot import LinePlot, PlotAxis, PlotPoint, Series, plot_svg
from roaml.figures.scales import ScaleKind


def growth_svg(title: str, series: Mapping[str, Sequence[tuple[float, float]]], across: str, up: str) -> str:
    """A plot as SVG, with a dashed line of linear growth below all points.

    Args:
        series: name -> points. All numbers are positive.
        across, up: the names of the axes, with units.
    """
    points = [point for line in series.values() for point in line]
    left, right = min(x for x, _ in points), max(x for x, _ in points)
    slope = min(y / x for x, y in points)
    linear = (PlotPoint(left, left * slope), PlotPoint(right, right * slope))
    lines = [Series(name, tuple(PlotPoint(x, y) for x, y in line)) for name, line in series.items()]
    lines.append(Series("linear growth", linear, is_dashed=True, has_marks=False))
    kind = ScaleKind.LOGARITHMIC
    return plot_svg(LinePlot(title, PlotAxis(across, kind), PlotAxis(up, kind), tuple(lines)))
