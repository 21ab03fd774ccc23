# SPDX-License-Identifier: Apache-2.0
"""The result of an experiment: its points, as tables and plots."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from html import escape
from typing import Any

from roaml.exact_number import exact_fraction
from roaml.experiments.beside import BesideValue, is_same
from roaml.experiments.grid import ExperimentOptions
from roaml.experiments.points import ExperimentPoint, PointKind, Schedulers, unknown_point
from roaml.experiments.sweeps import Sweep, settings_of
from roaml.figures.plot import HeatMap, LinePlot, PlotAxis, PlotPoint, Series, plot_page, plot_svg
from roaml.record import Record, replace
from roaml.smc.statistics import Bounds
from roaml.verification.number_text import exact_number, with_interval

MAX_LINES = 6
"""The maximum number of lines of a plot. With more values of the second parameter, the plot is a heat map."""
COLUMNS = ("value", "low", "high", "kind", "schedulers", "minimum", "maximum", "uniform", "states", "traces", "note")

ESTIMATE_NOTE = "estimates from traces with uniform choices"
EXACT_NOTES = {
    Schedulers.ALL: "the same for all schedulers",
    Schedulers.MINIMUM: "the minimum over all schedulers where these differ",
    Schedulers.MAXIMUM: "the maximum over all schedulers where these differ",
    Schedulers.UNIFORM: "those under uniform choices where schedulers differ",
}


def estimate_note(points: Iterable[ExperimentPoint], *, only_uniform: bool) -> str:
    """What the estimates among points mean, and which limits ended the searches for exact values.

    Args:
        only_uniform: whether the value under uniform choices is requested.
    """
    if only_uniform:
        return ESTIMATE_NOTE
    limits = [limit for limit in dict.fromkeys(point.limit for point in points) if limit]
    stopped = f"searches stopped at the limit {' or '.join(limits)}: raise it, or explore all states"
    where = f", because {stopped}"
    return f"{ESTIMATE_NOTE} (the minimum and maximum over all schedulers are undecided{where if limits else ''})"


def exact_note(points: Sequence[ExperimentPoint]) -> str:
    """What the exact values among points mean. If they are minima of some properties and maxima of others, the note
    names these properties."""
    names: dict[Schedulers, dict[str, None]] = {}
    for point in points:
        if point.kind is PointKind.EXACT and point.schedulers is not None:
            names.setdefault(point.schedulers, {})[point.name] = None
    has_both = Schedulers.MINIMUM in names and Schedulers.MAXIMUM in names
    meanings = [
        f"{note} ({', '.join(names[schedulers])})" if has_both and schedulers is not Schedulers.ALL else note
        for schedulers, note in EXACT_NOTES.items()
        if schedulers in names
    ]
    return f"exact values from all states: {'; '.join(meanings)}"


class ExperimentResult(Record, frozen=True):
    """The points of an experiment. A notebook shows the plot.

    Attributes:
        path: the file of the model.
        points: the points by setting, the values of the last parameter varying fastest, then by property.
        beside: values from elsewhere, which tables and plots show beside the points.
    """

    path: str
    sweeps: tuple[Sweep, ...]
    properties: tuple[str, ...]
    points: tuple[ExperimentPoint, ...]
    options: ExperimentOptions
    beside: tuple[BesideValue, ...] = ()

    def point(self, name: str, **setting: object) -> ExperimentPoint:
        """The point of a property with parameters.

        Raises:
            KeyError: there is no such point.
        """
        asked = {parameter: str(value) for parameter, value in setting.items()}
        for point in self.points:
            if point.name == name and asked.items() <= dict(point.setting).items():
                return point
        raise KeyError(f"no point of `{name}` with {asked}")

    def rows(self) -> list[dict[str, Any]]:
        """A row for each point, with a column for each parameter; for example for `pandas.DataFrame`."""
        return [
            {
                **dict(point.setting),
                "property": point.name,
                **{column: getattr(point, column) for column in COLUMNS},
                "kind": point.kind.value,
                "schedulers": point.schedulers.value,
                **{f"slope {name}": slope for name, slope in point.slopes},
            }
            for point in self.points
        ]

    def to_csv(self) -> str:
        """The rows as CSV (RFC 4180) with a header. A number that does not exist is an empty field."""
        names = dict.fromkeys(f"slope {name}" for point in self.points for name, _ in point.slopes)
        return csv_text([*(sweep.name for sweep in self.sweeps), "property", *COLUMNS, *names], self.rows())

    def as_json(self) -> dict[str, Any]:
        """The result as a value for JSON."""
        sampling = self.options.sampling
        return {
            "model": self.path,
            "parameters": {sweep.name: list(sweep.values) for sweep in self.sweeps},
            "properties": list(self.properties),
            "confidence": sampling.confidence,
            "epsilon": sampling.epsilon,
            "seed": sampling.seed,
            "points": [point.as_json() for point in self.points],
        }

    def to_markdown(self) -> str:
        """The points as a table in Markdown: a row for each setting, a column for each property."""
        head = [*(sweep.name for sweep in self.sweeps), *self._columns(lambda name: f"`{name}`")]
        rows = [[*(value for _, value in setting), *cells] for setting, cells in self._cells()]
        lines = ["| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows]]
        return "\n".join([*lines, "", *(f"{note[0].upper()}{note[1:]}.  " for note in self.notes()), ""])

    def to_text(self) -> str:
        """The points as a table for terminals."""
        head = [*(sweep.name for sweep in self.sweeps), *self._columns()]
        rows = [head, *([*(value for _, value in setting), *cells] for setting, cells in self._cells())]
        widths = [max(len(row[column]) for row in rows) for column in range(len(head))]
        count = len(self.sweeps)
        lines = (
            "  ".join(
                text.rjust(width) if column < count else text.ljust(width)
                for column, (text, width) in enumerate(zip(row, widths, strict=True))
            ).rstrip()
            for row in rows
        )
        return "".join(f"{line}\n" for line in (*lines, *self.notes()))

    def _cells(self) -> Iterable[tuple[tuple[tuple[str, str], ...], list[str]]]:
        by_setting: dict[tuple[tuple[str, str], ...], dict[str, ExperimentPoint]] = {}
        for point in self.points:
            by_setting.setdefault(point.setting, {})[point.name] = point
        for setting, points in by_setting.items():
            cells = []
            for name in self.properties:
                cells.append(cell(points[name]) if name in points else "")
                for source in self._sources(name):
                    values = (v for v in self.beside if v.source == source and v.name == name and v.is_at(setting))
                    cells.append(", ".join(_beside_cell(value) for value in values))
            yield setting, cells

    def _sources(self, name: str) -> tuple[str, ...]:
        """The sources of values from elsewhere for a property."""
        return tuple(dict.fromkeys(value.source for value in self.beside if value.name == name))

    def _columns(self, written: Callable[[str], str] = str) -> Iterator[str]:
        """The heads of the columns of all properties."""
        for name in self.properties:
            yield written(name)
            for source in self._sources(name):
                yield source if len(self.properties) == 1 else f"{written(name)}, {source}"

    def notes(self) -> list[str]:
        """Sentences without a full stop: what the values mean, and what limits them."""
        kinds = {point.kind for point in self.points}
        notes = []
        if PointKind.EXACT in kinds:
            notes.append(exact_note(self.points))
        if PointKind.ESTIMATE in kinds:
            sampling = self.options.sampling
            notes.append(
                f"{estimate_note(self.points, only_uniform=self.options.only_uniform)}: "
                f"{sampling.confidence:g} confidence for each point by itself, seed {sampling.seed}"
            )
        limited: dict[str, list[ExperimentPoint]] = {}
        for point in self.points:
            if point.note:
                limited.setdefault(f"`{point.name}`: {point.note}", []).append(point)
        for note, points in limited.items():
            where = ", ".join(f"{name}={value}" for name, value in points[0].setting)
            more = f" and {len(points) - 1} more points" if len(points) > 1 else ""
            notes.append(f"{note} (at {where or 'the only point'}{more})")
        return notes

    def plots(self, units: Mapping[str, str] | None = None, *, is_growing: bool = False) -> list[LinePlot | HeatMap]:
        """A plot for each property: lines over the first parameter, one for each value of the others; or a heat map,
        if a second parameter has more than `MAX_LINES` values. With one parameter, all properties share a plot if their
        values have the same meaning.

        Args:
            units: parameter -> its unit.
            is_growing: whether points are not known yet. Their places are kept free, so that the axes and the legend
                stay as they are while the plot grows.
        """
        if is_growing:
            return self._complete().plots(units)
        if not self.sweeps:
            return []
        order = sorted(self.sweeps, key=lambda sweep: len(sweep.values), reverse=True)
        across, others = order[0], [sweep for sweep in order[1:] if len(sweep.values) > 1]
        if len(others) == 1 and len(others[0].values) > MAX_LINES:
            return [self._heat_map(name, across, others[0], units or {}) for name in self.properties]
        if not others and len(self.properties) <= MAX_LINES:
            return [self._plot(self.properties, across, (), units or {})]
        return [self._plot((name,), across, others, units or {}) for name in self.properties]

    def _complete(self) -> ExperimentResult:
        """The result with points without a value in the places of those that are missing."""
        known = {(point.setting, point.name): point for point in self.points}
        keys = [(setting, name) for setting in settings_of(self.sweeps) for name in self.properties]
        return replace(self, points=tuple(known.get(key) or unknown_point(*key, "") for key in keys))

    def _plot(self, names: Sequence[str], across: Sweep, others: Sequence[Sweep], units: Mapping[str, str]) -> LinePlot:
        numbers = across.numbers
        place = dict(zip(across.values, numbers or map(float, range(len(across.values))), strict=True))
        lines: dict[str, list[PlotPoint]] = {}
        for point in self.points:
            if point.name in names:
                setting = dict(point.setting)
                words = [point.name] if len(names) > 1 or not others else []
                words += [f"{other.name} = {setting[other.name]}" for other in others]
                lines.setdefault(", ".join(words), []).append(self._plotted(place[setting[across.name]], point))
        series = tuple(
            Series(name, tuple(sorted(points, key=lambda point: point.x)), has_line=numbers is not None)
            for name, points in lines.items()
        )
        series += tuple(self._beside_series(names, across, others, place))
        name = _with_unit(across.name, units)
        x = PlotAxis(name) if numbers is not None else PlotAxis(name, words=across.values)
        by = " and ".join(sweep.name for sweep in (across, *others))
        title = f"{', '.join(names)} by {by}"
        return LinePlot(title, x, self._axis(names), series, self._plot_notes(across))

    def _beside_series(
        self, names: Sequence[str], across: Sweep, others: Sequence[Sweep], place: Mapping[str, float]
    ) -> Iterator[Series]:
        """The values from elsewhere, as marks without a line. They need not have the place of a point,
        if the values of the parameter are numbers."""
        marks: dict[str, list[PlotPoint]] = {}
        for value in self.beside:
            setting = dict(value.setting)
            x = next((at for text, at in place.items() if is_same(text, setting[across.name])), None)
            if x is None and across.numbers is not None:
                number = exact_fraction(setting[across.name])
                x = float(number) if number is not None else None
            if value.name in names and x is not None:
                words = [value.source, *([value.name] if len(names) > 1 else [])]
                words += [f"{other.name} = {setting[other.name]}" for other in others if other.name in setting]
                where = ", ".join(f"{name} = {text}" for name, text in value.setting)
                note = f"{value.source}: {value.name} {_beside_cell(value)} at {where}"
                marks.setdefault(", ".join(words), []).append(PlotPoint(x, value.value, value.low, value.high, note))
        for name, points in marks.items():
            yield Series(name, tuple(sorted(points, key=lambda point: point.x)), has_line=False)

    def _plot_notes(self, across: Sweep) -> tuple[str, ...]:
        fixed = [f"{s.name} = {s.values[0]}" for s in self.sweeps if len(s.values) == 1 and s is not across]
        return (*(["with " + ", ".join(fixed)] if fixed else []), *self.notes())

    def _axis(self, names: Sequence[str]) -> PlotAxis:
        """The axis of the values. It is that of probabilities if all of them are between 0 and 1."""
        values = [p.value for p in self.points if p.name in names and p.has_value]
        values += [value.value for value in self.beside if value.name in names]
        if all(0 <= value <= 1 for value in values):
            return PlotAxis("probability", limits=(0.0, 1.0))
        return PlotAxis("value")

    def _plotted(self, x: float, point: ExperimentPoint) -> PlotPoint:
        note = f"{point.name}: {cell(point)} at {', '.join(f'{n} = {v}' for n, v in point.setting)}"
        has_band = point.kind is PointKind.ESTIMATE
        low, high = (point.low, point.high) if has_band else (None, None)
        return PlotPoint(x, point.value, low, high, note, point.key)

    def _heat_map(self, name: str, across: Sweep, up: Sweep, units: Mapping[str, str]) -> HeatMap:
        points = {(dict(p.setting)[across.name], dict(p.setting)[up.name]): p for p in self.points if p.name == name}
        columns, rows = _ascending(across), _ascending(up)
        grid = [[points[column, row] for column in columns] for row in rows]
        return HeatMap(
            f"{name} by {across.name} and {up.name}",
            _with_unit(across.name, units),
            _with_unit(up.name, units),
            columns,
            rows,
            tuple(tuple(point.value for point in row) for row in grid),
            self._axis((name,)).name,
            (*self._plot_notes(across), *self._beside_notes(name)),
            keys=tuple(tuple(point.key for point in row) for row in grid),
        )

    def _beside_notes(self, name: str) -> Iterator[str]:
        """The values from elsewhere, as sentences without a full stop, for a plot without marks."""
        for source in self._sources(name):
            values = [value for value in self.beside if value.name == name and value.source == source]
            shown = (
                f"{_beside_cell(value)} at {', '.join(f'{n} = {v}' for n, v in value.setting)}"
                for value in values[:MAX_LINES]
            )
            more = f"; and {len(values) - MAX_LINES} more" if len(values) > MAX_LINES else ""
            yield f"{source}: {'; '.join(shown)}{more}"

    @property
    def page_title(self) -> str:
        return f"Experiment with {self.path}"

    def to_html_table(self) -> str:
        """The points and notes in HTML."""
        head = [*(sweep.name for sweep in self.sweeps), *self._columns()]
        rows = [[*(value for _, value in setting), *cells] for setting, cells in self._cells()]
        body = "".join(f"<tr>{''.join(f'<td>{escape(text)}</td>' for text in row)}</tr>\n" for row in rows)
        notes = "".join(f"<p>{escape(note)}.</p>\n" for note in self.notes())
        return f"<table><tr>{''.join(f'<th>{escape(text)}</th>' for text in head)}</tr>\n{body}</table>\n{notes}"

    def to_html(self) -> str:
        """A page with the plots and a table of all points."""
        return plot_page(self.page_title, self.plots(), self.to_html_table())

    def _repr_svg_(self) -> str:
        return plot_svg(self.plots()[0])


def _with_unit(name: str, units: Mapping[str, str]) -> str:
    return f"{name} ({units[name]})" if name in units else name


def _beside_cell(value: BesideValue) -> str:
    """A value from elsewhere, with its interval."""
    has_interval = value.low is not None and value.high is not None
    return f"{value.value:g}" + (f" in [{value.low:g}, {value.high:g}]" if has_interval else "")


def _ascending(sweep: Sweep) -> tuple[str, ...]:
    if sweep.numbers is None:
        return sweep.values
    return tuple(value for _, value in sorted(zip(sweep.numbers, sweep.values, strict=True)))


def cell(point: ExperimentPoint) -> str:
    """The value of a point with its interval, as text."""
    if not point.has_value:
        return "unknown"
    if point.kind is PointKind.EXACT:
        slopes = "".join(f", d/d{name} {slope:.6g}" for name, slope in point.slopes)
        return f"{exact_number(point.low, point.high)}{slopes}"
    return with_interval(point.value, Bounds(point.low, point.high))


def csv_text(columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> str:
    """A table as CSV (RFC 4180), with a header. `None` and numbers that do not exist are empty fields."""
    lines = [",".join(_quoted(column) for column in columns)]
    lines += [",".join(_quoted(_field(row.get(column))) for column in columns) for row in rows]
    return "".join(f"{line}\n" for line in lines)


def _quoted(text: str) -> str:
    quoted = text.replace('"', '""')
    return f'"{quoted}"' if any(mark in text for mark in ',"\r\n') else text


def _field(value: Any) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return repr(value) if isinstance(value, float) else str(value)
