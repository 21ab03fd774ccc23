# SPDX-License-Identifier: Apache-2.0
"""Scales, and what plots contain."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

from hypothesis import given
from hypothesis import strategies as st

from roaml.figures.drawing import Area, Polyline, Shape, TextItem
from roaml.figures.plot import (
    NAME_DISTANCE,
    HeatMap,
    LinePlot,
    PlotAxis,
    PlotPoint,
    Series,
    description,
    drawing_of,
    plot_pdf,
    plot_svg,
)
from roaml.figures.scales import ScaleKind, scale_of
from roaml.figures.text import SMALL
from roaml.figures.themes import THEMES
from roaml.record import replace

NUMBERS = st.floats(-1e9, 1e9, allow_nan=False).filter(lambda number: number == 0 or abs(number) > 1e-6)


@given(st.lists(NUMBERS, min_size=1, max_size=20))
def test_linear_scales_contain_all_numbers_and_few_ticks(numbers: list[float]) -> None:
    scale = scale_of(numbers)
    assert scale.low < scale.high
    slack = 1e-9 * max(abs(scale.low), abs(scale.high))
    assert all(scale.low - slack <= number <= scale.high + slack for number in numbers)
    assert 2 <= len(scale.ticks) <= 8
    assert all(scale.low - slack <= tick <= scale.high + slack for tick in scale.ticks)


@given(st.lists(st.floats(1e-6, 1e9), min_size=1, max_size=20))
def test_logarithmic_scales_contain_all_numbers(numbers: list[float]) -> None:
    scale = scale_of(numbers, ScaleKind.LOGARITHMIC)
    assert all(-1e-6 <= scale.place(number) <= 1 + 1e-6 for number in numbers)
    assert len(scale.ticks) >= 2


def test_nice_scales() -> None:
    assert scale_of([0.31, 0.97], limits=(0, 1)).ticks == (0.2, 0.4, 0.6, 0.8, 1.0)
    assert scale_of([1, 1], limits=(0, 1)).high == 1
    assert scale_of([20, 200]).ticks == (0, 50, 100, 150, 200)
    assert scale_of([math.nan, math.inf]).ticks[0] == 0
    assert scale_of([3, 4000], ScaleKind.LOGARITHMIC).ticks == (1, 10, 100, 1000, 10000)


def line(*points: tuple[float, float], **more: bool) -> Series:
    return Series("line", tuple(PlotPoint(x, y, y - 0.1, y + 0.1) for x, y in points), **more)


def test_a_missing_value_is_a_gap() -> None:
    plot = LinePlot("t", PlotAxis("x (s)"), PlotAxis("y"), (line((0, 0.5), (1, math.nan), (2, 0.5), (3, 0.6)),))
    items = [item for _, item in drawing_of(plot).walk()]
    assert len([item for item in items if isinstance(item, Polyline) and item.role == "curve"]) == 2  # with the legend
    assert "no value at 1" in description(plot)


def test_the_description_and_the_names() -> None:
    plot = LinePlot("title", PlotAxis("x (s)"), PlotAxis("probability"), (line((0, 0.5), (2, 0.6)),), ("a note",))
    assert description(plot) == (
        "Plot of probability by x (s). line: 0.5 in [0.4, 0.6] at 0, 0.6 in [0.5, 0.7] at 2. a note."
    )
    texts = {item.text for _, item in drawing_of(plot).walk() if isinstance(item, TextItem)}
    assert {"title", "x (s)", "probability", "line", "a note"} <= texts
    assert any(isinstance(item, Area) and item.role == "band" for _, item in drawing_of(plot).walk())


def test_all_themes_and_formats() -> None:
    plot = LinePlot(
        "t", PlotAxis("mode", words=("fast", "slow")), PlotAxis("y"), (line((0, 0.5), (1, 0.6), has_line=False),)
    )
    heat = HeatMap("t", "a", "b", ("1", "2"), ("x",), ((0.5, math.nan),), "probability")
    for picture in (plot, heat):
        for theme in (*THEMES, "auto"):
            root = ET.fromstring(plot_svg(picture, theme))
            assert root.find("{http://www.w3.org/2000/svg}desc") is not None
            assert not re.search(r"var\(|nan|inf", plot_svg(picture, theme).replace("notation", ""))
        assert plot_pdf(picture) == plot_pdf(picture)


def test_the_name_of_a_guide_does_not_cover_that_of_the_axis() -> None:
    for number, is_above in ((0.99, False), (0.5, True)):
        plot = LinePlot("t", PlotAxis("x"), PlotAxis("probability", limits=(0, 1)), (line((0, 0.2), (1, 0.9)),))
        drawing = drawing_of(replace(plot, guides=((number, "≥ p"),)))
        (guide,) = (group for group in drawing.groups if group.role == "guide-line")
        stroke = next(item for item in guide.items if isinstance(item, Polyline))
        name = next(item for item in guide.items if isinstance(item, TextItem))
        assert (name.y < stroke.points[0].y) == is_above
        texts = [item for group in drawing.groups for item in group.items if isinstance(item, TextItem)]
        axis = next(item for item in texts if item.text == "probability")
        assert name.y - axis.y >= SMALL


def test_a_line_under_equal_ones_is_wider_than_these() -> None:
    points = ((0, 0.5), (1, 0.6), (2, 0.9))
    lines = (line(*points), line((0, 0.5), (1, 0.7), (2, 0.9)), line(*points), line(*points))
    drawing = drawing_of(LinePlot("t", PlotAxis("x"), PlotAxis("y"), lines))
    assert [group.kind for group in drawing.groups if group.role == "series"] == ["covered-2", "", "covered-1", ""]
    marks = [item for group in drawing.groups if group.role == "point" for item in group.items]
    first, third = marks[0], marks[6]
    assert isinstance(first, Shape)
    assert isinstance(third, Area)
    assert first.box.width > max(p.x for p in third.points) - min(p.x for p in third.points)


def test_lines_with_the_same_subject_have_the_same_color() -> None:
    points = (PlotPoint(0, 0.5), PlotPoint(1, 0.6))
    lines = tuple(Series(f"{subject}{n}", points, subject=subject) for n, subject in enumerate(("a", "a", "b", "", "")))
    drawing = drawing_of(LinePlot("t", PlotAxis("x"), PlotAxis("y"), lines))
    for role in ("series", "legend"):
        first, second, *others = [group.tone for group in drawing.groups if group.role == role]
        assert first == second
        assert len({first, *others}) == 4


def test_a_line_that_the_title_names_has_no_legend() -> None:
    for title, has_legend in (("line by x", False), ("p by x", True)):
        plot = LinePlot(title, PlotAxis("x"), PlotAxis("y"), (line((0, 0.5), (1, 0.6)),))
        assert any(group.role == "legend" for group in drawing_of(plot).groups) == has_legend


def test_names_of_lines_are_beside_their_ends() -> None:
    ends = (0.9, 0.1, 0.88, 0.9)
    lines = tuple(
        Series(f"p = {number}", (PlotPoint(0, 0.3 * number), PlotPoint(1, end))) for number, end in enumerate(ends)
    )
    drawing = drawing_of(LinePlot("t", PlotAxis("x"), PlotAxis("y", low=0, high=1), lines))
    legend = [group for group in drawing.groups if group.role == "legend"]
    names = [item for group in legend for item in group.items if isinstance(item, TextItem)]
    assert sorted(names, key=lambda name: name.y) == [names[3], names[0], names[2], names[1]]
    assert names[0].y - names[3].y >= NAME_DISTANCE
    curves = [group.items[0] for group in drawing.groups if group.role == "series"]
    leaders = [group.items[0] for group in drawing.groups if group.role == "leader-line"]
    for curve, leader, name in zip(curves, leaders, names, strict=True):
        assert isinstance(curve, Polyline)
        assert isinstance(leader, Polyline)
        assert leader.points[0] == curve.points[-1]
        assert leader.points[-1].x < name.x
        assert abs(leader.points[-1].y + 4 - name.y) < 0.01
        assert name.box.right <= drawing.size.width


def test_long_names_of_lines_are_above_them() -> None:
    lines = tuple(replace(line((0, 0.5), (1, end)), name=f"{'name ' * 12}{end}") for end in (0.1, 0.9))
    drawing = drawing_of(LinePlot("t", PlotAxis("x"), PlotAxis("y"), lines))
    names = [item for g in drawing.groups if g.role == "legend" for item in g.items if isinstance(item, TextItem)]
    curves = [item for _, item in drawing.walk() if isinstance(item, Polyline) and item.role == "axis-line"]
    assert max(name.y for name in names) < min(point.y for curve in curves for point in curve.points)
    assert not any(group.role == "leader-line" for group in drawing.groups)


def test_six_lines_have_six_marks() -> None:
    lines = tuple(line((0, number), (1, number + 1)) for number in range(6))
    drawing = drawing_of(LinePlot("t", PlotAxis("x"), PlotAxis("y"), lines))
    forms = set()
    for group in drawing.groups:
        if group.role == "legend":
            mark = group.items[1]
            if isinstance(mark, Shape):
                forms.add(str(mark.outline))
            elif isinstance(mark, Area):
                first = mark.points[0]
                forms.add(str([(round(p.x - first.x, 3), round(p.y - first.y, 3)) for p in mark.points]))
    assert len(forms) == 6


def test_numbers_in_cells_fit() -> None:
    values = tuple(0.008561234 * 7 ** (number % 3) for number in range(11))
    drawing = drawing_of(HeatMap("t", "a", "b", tuple(map(str, range(11))), ("x",), (values,), "value"))
    cells = [group for group in drawing.groups if group.role == "heat" and len(group.items) > 1]
    assert len(cells) == 11
    for group, value in zip(cells, values, strict=True):
        shape, text = group.items
        assert isinstance(shape, Shape)
        assert isinstance(text, TextItem)
        assert shape.box.x < text.x < text.box.right < shape.box.right
        assert math.isclose(float(text.text), value, rel_tol=0.01)


def test_points_lie_inside_the_drawing() -> None:
    for plot in (
        LinePlot(
            "t", PlotAxis("x", low=0, high=1), PlotAxis("y", low=0, high=1), (line((0.5, 3), (2, 0.5), (0.2, 0.95)),)
        ),
        HeatMap("t", "a", "b", tuple("123"), tuple("ab"), ((0.1, 0.2, 0.3), (1, math.inf, math.nan)), "value"),
    ):
        drawing = drawing_of(plot)
        for _, item in drawing.walk():
            for point in getattr(item, "points", ()):
                assert -1 <= point.x <= drawing.size.width + 1
                assert -1 <= point.y <= drawing.size.height + 1
