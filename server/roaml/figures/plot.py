# SPDX-License-Identifier: Apache-2.0
"""Plots of numbers: lines with bands, and heat maps.

- Every axis has a name, with its unit; every line has its name at its end, or in a legend if the names have no space
  there, and marks that differ without colors.
- A number that does not exist is a gap in its line, or an empty cell; it is never drawn as 0.
- The description of a plot contains the numbers that it shows, for readers who do not see it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from html import escape
from typing import TypeAlias

from roaml.figures.drawing import Area, Drawing, Group, Item, Outline, Polyline, Shape, TextItem, Tone
from roaml.figures.end_labels import label_heights
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.pdf import pdf_file
from roaml.figures.scales import Scale, ScaleKind, number_label, scale_of
from roaml.figures.svg import PLOT_STYLES, svg_file
from roaml.figures.text import LINE_HEIGHT, MEDIUM, SMALL, text_width, wrap
from roaml.figures.themes import AUTOMATIC, THEMES, contrast_style
from roaml.record import Record, replace

WIDTH, HEIGHT = 560.0, 300.0
"""The size of the area of the lines or cells, in pixels."""
MAX_MARKS = 40
"""The maximum number of points of a line that are marked. Lines with more points are drawn without marks."""
HEAT_LEVELS = 10
MAX_DESCRIBED = 12
"""The maximum number of points of a line that its description lists; they are chosen at equal distances."""
MAX_COVERS = 3
"""The maximum number of equal lines over a line for which the line becomes wider."""
MAX_NAME_WIDTH, MAX_NAMES, NAME_DISTANCE = 240.0, 16, 18.0
"""The maximum width of the names at the ends of lines, in pixels, their maximum number, and their minimum distance."""
_NAMES_FROM, _SAMPLE = 26.0, 26.0
"""The distance of these names from the area of the lines, and the width of the samples before them, in pixels."""
_MARK = 4.0
_Corners: TypeAlias = tuple[tuple[float, float], ...]
_CROSS: _Corners = tuple(
    (x * 1.4, y * 1.4)
    for x, y in (
        *((-0.3, -1.0), (0.3, -1.0), (0.3, -0.3), (1.0, -0.3), (1.0, 0.3), (0.3, 0.3)),
        *((0.3, 1.0), (-0.3, 1.0), (-0.3, 0.3), (-1.0, 0.3), (-1.0, -0.3), (-0.3, -0.3)),
    )
)
_Placed: TypeAlias = Callable[[float, float], Point]
_TONES = (Tone.SERIES_1, Tone.SERIES_2, Tone.SERIES_3, Tone.SERIES_4, Tone.SERIES_5, Tone.SERIES_6)


class PlotAxis(Record, frozen=True):
    """An axis.

    Attributes:
        name: what the numbers are, with their unit in parentheses, such as `time (s)`.
        kind: how numbers are placed.
        low, high: the ends; `None` to fit the numbers.
        limits: the least and the greatest number that the ends may be, if they fit the numbers.
        words: what is written instead of the numbers 0, 1, 2, …, for values that are not numbers.
    """

    name: str
    kind: ScaleKind = ScaleKind.LINEAR
    low: float | None = None
    high: float | None = None
    limits: tuple[float, float] = (-math.inf, math.inf)
    words: tuple[str, ...] = ()


class PlotPoint(Record, frozen=True):
    """A point of a line, or a cell of a heat map.

    Attributes:
        x: the place on the horizontal axis.
        y: the value; not a number if there is none.
        low, high: the ends of the interval that belongs to the value; `None` if there is none.
        note: what is shown if the mouse is over the point, instead of its numbers.
        key: what identifies the point in a view in which it can be clicked.
    """

    x: float
    y: float
    low: float | None = None
    high: float | None = None
    note: str = ""
    key: str = ""


class Series(Record, frozen=True):
    """A line.

    Attributes:
        points: the points, with ascending `x`.
        is_stepped: whether the value of a point is valid until the next point.
        is_dashed: whether the line is dashed, as lines for comparison are.
        has_line: whether the points are connected.
        has_marks: whether the points are marked, unless there are too many.
        subject: what the line is about; lines with the same subject have the same color and marks. "" for a color of
            its own.
    """

    name: str
    points: tuple[PlotPoint, ...]
    is_stepped: bool = False
    is_dashed: bool = False
    has_line: bool = True
    has_marks: bool = True
    subject: str = ""


class LinePlot(Record, frozen=True):
    """Lines over one axis.

    Attributes:
        title: what is shown.
        notes: sentences below the plot, such as what the bands mean.
        guides: numbers on the vertical axis at which a line is drawn, with their names.
    """

    title: str
    x: PlotAxis
    y: PlotAxis
    series: tuple[Series, ...]
    notes: tuple[str, ...] = ()
    guides: tuple[tuple[float, str], ...] = ()


class HeatMap(Record, frozen=True):
    """Values over two axes.

    Attributes:
        columns, rows: the values on the horizontal and the vertical axis, ascending, as they are written.
        values: the values by rows, then columns; not a number where there is none.
        value: the name of the values, with their unit.
        hints: what is shown if the mouse is over a cell, as `values`; the numbers if it is empty.
        keys: what identifies each cell in a view, as `values`; empty if the cells cannot be clicked.
    """

    title: str
    x: str
    y: str
    columns: tuple[str, ...]
    rows: tuple[str, ...]
    values: tuple[tuple[float, ...], ...]
    value: str
    notes: tuple[str, ...] = ()
    hints: tuple[tuple[str, ...], ...] = ()
    keys: tuple[tuple[str, ...], ...] = ()


def with_guide(plots: Sequence[LinePlot | HeatMap], number: float, name: str) -> list[LinePlot | HeatMap]:
    """Plots with a line at a number on the vertical axis, where there is such an axis."""
    return [replace(plot, guides=((number, name),)) if isinstance(plot, LinePlot) else plot for plot in plots]


def plot_svg(plot: LinePlot | HeatMap, theme: str = AUTOMATIC) -> str:
    """The text of an SVG file with a plot.

    Args:
        theme: one of `themes.THEMES`, or `AUTOMATIC`.
    """
    return svg_file(drawing_of(plot), plot.title, theme, PLOT_STYLES, description(plot))


def plot_pdf(plot: LinePlot | HeatMap) -> bytes:
    """A PDF file with a plot."""
    return pdf_file(plot_svg(plot, "light"))


def plot_page(title: str, plots: Sequence[LinePlot | HeatMap], body: str = "") -> str:
    """The text of an HTML page with plots, in the colors of `page`.

    Args:
        body: HTML that follows the plots.
    """
    figures = "".join(f"<figure>{plot_svg(plot)}</figure>\n" for plot in plots)
    return page(title, f"{figures}{body}", PLOT_STYLES)


def page(title: str, body: str, styles: tuple[str, ...]) -> str:
    """The text of an HTML page, which is light, or dark if the reader prefers dark colors, and has a high contrast if
    the reader prefers that.

    Args:
        styles: the names of the style sheets of the pictures in the body.
    """
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>\n{_PAGE_STYLE}'
        f"<h1>{escape(title)}</h1>\n{body}\n<style>\n{contrast_style(styles)}{_PAGE_CONTRAST}</style></html>\n"
    )


_PAGE_STYLE = f"""\
<style>
:root {{ background: {THEMES["light"]["background"]}; }}
@media (prefers-color-scheme: dark) {{ :root {{ background: {THEMES["dark"]["background"]}; }} }}
</style>
"""
"""The background of pages is that of their pictures."""
_PAGE_CONTRAST = """\
@media (prefers-contrast: more) {
th, td { border-bottom-color: currentColor; } .changed td { background: none; }
.changed td:first-child { box-shadow: inset 4px 0 currentColor; }
}
"""
_PAGE_STYLE += """\
<meta name="viewport" content="width=device-width"><meta name="color-scheme" content="light dark">
<style>
body { font-family: system-ui, sans-serif; margin: 2rem auto; max-width: 60rem; padding: 0 1rem; line-height: 1.45; }
figure { margin: 1rem 0; } svg { max-width: 100%; height: auto; }
table { border-collapse: collapse; }
th, td { padding: 0.2rem 0.8rem; text-align: left; border-bottom: 1px solid #8886; }
td { font-variant-numeric: tabular-nums; }
.changed td { font-weight: 700; background: #e5c45438; } .changed td:first-child { box-shadow: inset 4px 0 #bf8700; }
</style>
"""


def description(plot: LinePlot | HeatMap) -> str:
    """What a plot shows, as text."""
    notes = "".join(f" {note}." for note in plot.notes)
    if isinstance(plot, HeatMap):
        rows = "; ".join(
            f"{plot.y} {row}: "
            + ", ".join(f"{_shown(value)} at {plot.x} {c}" for c, value in zip(plot.columns, values, strict=True))
            for row, values in zip(plot.rows, plot.values, strict=True)
        )
        return f"Heat map of {plot.value} by {plot.x} and {plot.y}. {rows}.{notes}"
    lines = (
        f"{series.name}: " + ", ".join(_point_text(plot, point) for point in _some(series.points))
        for series in plot.series
    )
    return f"Plot of {plot.y.name} by {plot.x.name}. {'; '.join(lines)}.{notes}"


def _some(points: Sequence[PlotPoint]) -> Sequence[PlotPoint]:
    if len(points) <= MAX_DESCRIBED:
        return points
    return [points[round(i * (len(points) - 1) / (MAX_DESCRIBED - 1))] for i in range(MAX_DESCRIBED)]


def _point_text(plot: LinePlot, point: PlotPoint) -> str:
    has_none = point.low is None or point.high is None or math.isnan(point.y)
    between = "" if has_none else f" in [{point.low:.4g}, {point.high:.4g}]"
    return f"{_shown(point.y)}{between} at {_word(plot.x, point.x)}"


def _shown(value: float) -> str:
    return "no value" if math.isnan(value) else f"{value:.4g}"


def _word(axis: PlotAxis, number: float) -> str:
    return axis.words[round(number)] if axis.words else number_label(number)


def drawing_of(plot: LinePlot | HeatMap) -> Drawing:
    """The drawing of a plot. Its upper left corner is that of the title."""
    return _heat_map(plot) if isinstance(plot, HeatMap) else _lines(plot)


# ------------------------------------------------------------ lines


def _lines(plot: LinePlot) -> Drawing:
    x, y = _scales(plot)
    labels = [number_label(tick) for tick in y.ticks] if not plot.y.words else list(plot.y.words)
    left = max(text_width(label, SMALL) for label in labels) + 10
    is_named = len(plot.series) == 1 and plot.series[0].name in plot.title  # a legend would repeat the title
    has_end_names = not is_named and _has_space_for_names(plot.series)
    head, top = _head(plot.title, () if is_named or has_end_names else plot.series, left, plot.y.name)
    area = Box(left, top, WIDTH, HEIGHT)

    def placed(across: float, up: float) -> Point:
        return Point(area.x + x.place(across) * area.width, area.bottom - y.place(up) * area.height)

    groups = [*head, Group("axis", Tone.PLAIN, tuple(_axes(plot, area, x, y)))]
    for value, name in plot.guides:
        if y.shows(value):
            at = placed(x.low, value).y
            height = LINE_HEIGHT * SMALL
            is_at_top = at - area.y < height  # above the line, its name would cover that of the axis
            groups.append(
                Group(
                    "guide-line",
                    Tone.PLAIN,
                    (
                        Polyline((Point(area.x, at), Point(area.right, at)), role="guide"),
                        TextItem(name, area.x + 6, at + height if is_at_top else at - 4, SMALL, "muted"),
                    ),
                )
            )
    clipped = [(series, _clipped(series, x, y)) for series in plot.series]
    for place, (number, (series, points)) in enumerate(zip(_numbers(plot.series), clipped, strict=True)):
        covers = _covers(points, [later for _, later in clipped[place + 1 :]], placed)
        tone = _TONES[number % len(_TONES)]
        bands = tuple(_bands(series, points, placed))
        if bands:
            groups.append(Group("bands", tone, bands))
        groups += _curve(plot, series, number, points, placed, covers)
    right = area.right + 12
    if has_end_names:
        groups += _end_names(plot.series, [points for _, points in clipped], area, placed)
        right = max(
            [right] + [item.box.right for group in groups for item in group.items if isinstance(item, TextItem)]
        )
    foot, bottom = _foot(plot.notes, left, area.bottom + 44)
    return Drawing(Extent(right, bottom), (*groups, *foot), {})


def _numbers(series: Sequence[Series]) -> list[int]:
    """The number of each line, on which its color and its marks depend."""
    numbers: dict[object, int] = {}
    return [numbers.setdefault(line.subject or index, len(numbers)) for index, line in enumerate(series)]


def _has_space_for_names(series: Sequence[Series]) -> bool:
    """Whether the names of lines are written at their ends. Points without lines have a legend."""
    widest = max((text_width(line.name, SMALL) for line in series), default=0.0)
    return len(series) <= MAX_NAMES and widest <= MAX_NAME_WIDTH and all(line.has_line for line in series)


def _end_names(
    series: Sequence[Series], clipped: Sequence[Sequence[PlotPoint]], area: Box, placed: _Placed
) -> Iterator[Group]:
    """The names of lines beside their ends; a fine line leads from each end to the name."""
    paths = [[placed(p.x, p.y) for p in points if not math.isnan(p.y)] for points in clipped]
    heights = label_heights([[p.y for p in path] for path in paths], NAME_DISTANCE, area.y, area.bottom)
    at = area.right + _NAMES_FROM
    for number, line, path, height in zip(_numbers(series), series, paths, heights, strict=True):
        name = TextItem(line.name, at + _SAMPLE + 8, height + 4, SMALL, "")
        kind = "dashed" if line.is_dashed else ""
        if path:
            leader = Polyline((path[-1], Point(at - 4, height)), role="leader", is_round=False)
            yield Group("leader-line", _TONES[number % len(_TONES)], (leader,))
        yield Group(
            "legend", _TONES[number % len(_TONES)], (*_sample(line, number, Point(at, height)), name), kind=kind
        )


def _scales(plot: LinePlot) -> tuple[Scale, Scale]:
    points = [point for series in plot.series for point in series.points]
    ends = [e for p in points for e in (p.low, p.high) if e is not None]
    if plot.x.words:
        x = Scale(ScaleKind.LINEAR, -0.5, len(plot.x.words) - 0.5, tuple(map(float, range(len(plot.x.words)))))
    else:
        x = scale_of([p.x for p in points], plot.x.kind, plot.x.low, plot.x.high, plot.x.limits)
    guides = [value for value, _ in plot.guides]
    y = scale_of([p.y for p in points] + ends + guides, plot.y.kind, plot.y.low, plot.y.high, plot.y.limits)
    return x, y


def _clipped(series: Series, x: Scale, y: Scale) -> list[PlotPoint]:
    """The points, with the ends of intervals that lie on the axis. A point without a place has no value."""
    clipped = []
    for point in series.points:
        low, high = (None if e is None else min(max(e, y.low), y.high) for e in (point.low, point.high))
        value = point.y if y.shows(point.y) else math.nan
        if x.shows(point.x):
            clipped.append(PlotPoint(point.x, value, low, high, point.note, point.key))
    return clipped


def _bands(series: Series, points: Sequence[PlotPoint], placed: _Placed) -> Iterator[Item]:
    """The areas between the ends of the intervals; for points that are not connected, lines with the same ends."""
    for run in _runs(points, lambda p: p.low is not None and p.high is not None):
        if series.has_line and len(run) > 1:
            upper = _path([(p.x, p.high or 0.0) for p in run], is_stepped=series.is_stepped)
            lower = _path([(p.x, p.low or 0.0) for p in run], is_stepped=series.is_stepped)
            yield Area(tuple(placed(*p) for p in (*upper, *reversed(lower))), "band")
        else:
            for point in run:
                ends = (placed(point.x, point.low or 0.0), placed(point.x, point.high or 0.0))
                yield Polyline(ends, role="whisker")


def _covers(points: Sequence[PlotPoint], later: Sequence[Sequence[PlotPoint]], placed: _Placed) -> int:
    """How many of the lines that are drawn later cover a whole line; at most `MAX_COVERS`."""
    heights = _heights(points, placed)
    covering = 0
    for line in later if heights else ():
        others = _heights(line, placed)
        covering += all(abs(others.get(x, math.inf) - height) < 1 for x, height in heights.items())
    return min(covering, MAX_COVERS)


def _heights(points: Sequence[PlotPoint], placed: _Placed) -> dict[float, float]:
    """The numbers on the horizontal axis -> the vertical positions of the points that have a value, in pixels."""
    return {p.x: placed(p.x, p.y).y for p in points if not math.isnan(p.y)}


def _curve(
    plot: LinePlot, series: Series, number: int, points: Sequence[PlotPoint], placed: _Placed, covers: int
) -> Iterator[Group]:
    """A line with its marks; they are wider if others cover it, so that they are seen below these."""
    tone = _TONES[number % len(_TONES)]
    if series.has_line:
        for run in _runs(points, lambda p: not math.isnan(p.y)):
            line = _path([(p.x, p.y) for p in run], is_stepped=series.is_stepped)
            if len(line) > 1:
                path = Polyline(tuple(placed(*p) for p in line), role="curve", is_round=False)
                kinds = (*(["dashed"] if series.is_dashed else []), *([f"covered-{covers}"] if covers else []))
                yield Group("series", tone, (path,), kind=" ".join(kinds))
    if series.has_marks and len(points) <= MAX_MARKS:
        for point in points:
            if not math.isnan(point.y):
                hint = point.note or f"{series.name}: {_point_text(plot, point)}"
                mark = _mark(number, placed(point.x, point.y), 1 + 0.5 * covers)
                yield Group("point", tone, (mark,), hint=hint, key=point.key)


def _path(points: Sequence[tuple[float, float]], *, is_stepped: bool) -> list[tuple[float, float]]:
    if not is_stepped:
        return list(points)
    path = list(points[:1])
    for x, y in points[1:]:
        path += [(x, path[-1][1]), (x, y)]
    return path


def _runs(points: Sequence[PlotPoint], has_value: Callable[[PlotPoint], bool]) -> Iterator[list[PlotPoint]]:
    """The longest parts of the points that have a value."""
    run: list[PlotPoint] = []
    for point in points:
        if has_value(point):
            run.append(point)
        elif run:
            yield run
            run = []
    if run:
        yield run


def _mark(number: int, at: Point, scale: float = 1.0) -> Item:
    """The mark of a point: its form names the line without colors."""
    half = _MARK * scale
    box = Box(at.x - half, at.y - half, 2 * half, 2 * half)
    corners: _Corners
    match number % len(_TONES):
        case 0:
            return Shape(box, Outline.PILL, "mark")
        case 1:
            return Shape(box, Outline.RECTANGLE, "mark")
        case 2:
            corners = ((0.0, -1.4), (1.3, 0.9), (-1.3, 0.9))
        case 3:
            corners = ((0.0, -1.4), (1.4, 0.0), (0.0, 1.4), (-1.4, 0.0))
        case 4:
            corners = ((0.0, 1.4), (1.3, -0.9), (-1.3, -0.9))
        case _:
            corners = _CROSS
    return Area(tuple(Point(at.x + half * x, at.y + half * y) for x, y in corners), "mark")


def _axes(plot: LinePlot, area: Box, x: Scale, y: Scale) -> Iterator[Item]:
    for tick in y.ticks:
        at = area.bottom - y.place(tick) * area.height
        label = _word(plot.y, tick)
        yield Polyline((Point(area.x, at), Point(area.right, at)), role="grid-line")
        yield TextItem(label, area.x - 8 - text_width(label, SMALL), at + 4, SMALL, "muted")
    yield from _below(area, [(x.place(tick), _word(plot.x, tick)) for tick in x.ticks], plot.x.name)
    corners = (Point(area.x, area.y), Point(area.x, area.bottom), Point(area.right, area.bottom))
    yield Polyline(corners, role="axis-line", is_round=False)


def _below(area: Box, ticks: Sequence[tuple[float, str]], name: str) -> Iterator[Item]:
    """The labels below an area, as many as there is room for, and the name of the axis."""
    widest = max((text_width(label, SMALL) for _, label in ticks), default=0.0) + 10
    stride = max(1, math.ceil(len(ticks) * widest / (area.width + widest)))
    for place, label in ticks[::stride]:
        at, width = area.x + place * area.width, text_width(label, SMALL)
        yield Polyline((Point(at, area.bottom), Point(at, area.bottom + 4)), role="axis-line")
        yield TextItem(label, at - width / 2, area.bottom + 18, SMALL, "muted")
    yield TextItem(name, area.x + (area.width - text_width(name, SMALL)) / 2, area.bottom + 38, SMALL, "")


def _head(title: str, series: Sequence[Series], left: float, up: str) -> tuple[list[Group], float]:
    """The title, the legend and the name of the vertical axis; and the height of these."""
    items: list[Item] = []
    at = 0.0
    for line in wrap(title, MEDIUM, left + WIDTH, bold=True):
        at += MEDIUM * LINE_HEIGHT
        items.append(TextItem(line, 0.0, at - 5, MEDIUM, "", bold=True))
    groups = [Group("title", Tone.PLAIN, tuple(items))]
    place, at = 0.0, at + (20 if series else 0)
    for number, line_ in zip(_numbers(series), series, strict=True):
        width = _SAMPLE + 8 + text_width(line_.name, SMALL) + 18
        if place and place + width > left + WIDTH:
            place, at = 0.0, at + 20
        tone, kind = _TONES[number % len(_TONES)], "dashed" if line_.is_dashed else ""
        sample = _sample(line_, number, Point(place, at - 4))
        name = TextItem(line_.name, place + _SAMPLE + 8, at, SMALL, "")
        groups.append(Group("legend", tone, (*sample, name), kind=kind))
        place += width
    at += 26
    groups.append(Group("label-up", Tone.PLAIN, (TextItem(up, 0.0, at, SMALL, ""),)))
    return groups, at + 12


def _sample(line: Series, number: int, at: Point) -> Iterator[Item]:
    """A short piece of a line with its mark, which begins at a point."""
    if line.has_line:
        yield Polyline((at, Point(at.x + _SAMPLE, at.y)), role="curve")
    if line.has_marks and len(line.points) <= MAX_MARKS:
        yield _mark(number, Point(at.x + _SAMPLE / 2, at.y))


def _foot(notes: Sequence[str], left: float, at: float) -> tuple[list[Group], float]:
    items: list[Item] = []
    for note in notes:
        for line in wrap(note, SMALL, left + WIDTH):
            at += SMALL * LINE_HEIGHT
            items.append(TextItem(line, 0.0, at, SMALL, "muted"))
    return ([Group("notes", Tone.PLAIN, tuple(items))] if items else []), at + 4


# ------------------------------------------------------------ heat maps


def _heat_map(plot: HeatMap) -> Drawing:
    values = [value for row in plot.values for value in row if math.isfinite(value)]
    least, greatest = min(values, default=0.0), max(values, default=1.0)
    left = max(text_width(label, SMALL) for label in plot.rows) + 12
    head, top = _head(plot.title, (), left, plot.y)
    width, height = WIDTH / len(plot.columns), min(HEIGHT / len(plot.rows), 60.0)
    area = Box(left, top, WIDTH, height * len(plot.rows))
    shows_texts = width >= text_width("0.0000", SMALL) + 6 and height >= SMALL + 4
    groups = list(head)
    for number, row in enumerate(reversed(plot.values)):
        line = len(plot.rows) - 1 - number
        for column, value in enumerate(row):
            box = Box(area.x + column * width, area.y + number * height, width, height)
            hint = plot.hints[line][column] if plot.hints else ""
            level = _level(value, least, greatest)
            text = _cell_text(value, width - 6) if not math.isnan(value) else "–"
            items: list[Item] = [Shape(box, Outline.RECTANGLE, "cell")]
            if shows_texts:
                place = box.x + (width - text_width(text, SMALL)) / 2, box.y + height / 2 + 4
                items.append(TextItem(text, *place, SMALL, "on-cell" if level > 6 else ""))
            name = f"{plot.value}: {_shown(value)} at {plot.x} {plot.columns[column]}, {plot.y} {plot.rows[line]}"
            kind = "unknown" if level < 0 else f"heat-{level}"
            key = plot.keys[line][column] if plot.keys else ""
            groups.append(Group("heat", Tone.SERIES_1, tuple(items), kind=kind, hint=hint or name, key=key))
    groups.append(Group("axis", Tone.PLAIN, tuple(_heat_axes(plot, area, height))))
    legend, bottom = _heat_legend(plot.value, least, greatest, area.bottom + 56)
    groups += legend
    foot, bottom = _foot(plot.notes, left, bottom)
    return Drawing(Extent(area.right + 12, bottom), (*groups, *foot), {})


def _cell_text(value: float, width: float) -> str:
    """A number with as many of four digits as fit into a width, at least two."""
    texts = [f"{value:.{digits}g}" for digits in (4, 3, 2)]
    return next((text for text in texts if text_width(text, SMALL) <= width), texts[-1])


def _heat_axes(plot: HeatMap, area: Box, height: float) -> Iterator[Item]:
    stride = max(1, math.ceil((SMALL + 4) / height))
    for number, label in list(enumerate(reversed(plot.rows)))[::stride]:
        at = area.y + (number + 0.5) * height + 4
        yield TextItem(label, area.x - 8 - text_width(label, SMALL), at, SMALL, "muted")
    ticks = [((column + 0.5) / len(plot.columns), label) for column, label in enumerate(plot.columns)]
    yield from _below(area, ticks, plot.x)


def _heat_legend(name: str, least: float, greatest: float, at: float) -> tuple[list[Group], float]:
    """The colors of the values, from the least to the greatest one."""
    low, high = f"{least:.4g}", f"{greatest:.4g}"
    place = text_width(name, SMALL) + 12
    groups = [Group("legend", Tone.PLAIN, (TextItem(name, 0.0, at + 11, SMALL, ""),))]
    groups.append(Group("legend", Tone.PLAIN, (TextItem(low, place, at + 11, SMALL, "muted"),)))
    place += text_width(low, SMALL) + 8
    for level in range(HEAT_LEVELS):
        cell = Shape(Box(place, at, 18.0, 14.0), Outline.RECTANGLE, "cell")
        groups.append(Group("heat", Tone.SERIES_1, (cell,), kind=f"heat-{level}"))
        place += 18
    groups.append(Group("legend", Tone.PLAIN, (TextItem(high, place + 8, at + 11, SMALL, "muted"),)))
    return groups, at + 18


def _level(value: float, least: float, greatest: float) -> int:
    """The color of a value, from 0 to `HEAT_LEVELS - 1`; -1 if there is no value."""
    if math.isnan(value):
        return -1
    if least == greatest:
        return HEAT_LEVELS // 2 - 1
    if math.isinf(value):
        return HEAT_LEVELS - 1 if value > 0 else 0
    return min(HEAT_LEVELS - 1, int((value - least) / (greatest - least) * HEAT_LEVELS))
