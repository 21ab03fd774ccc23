# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp experiment --live`: the state of an experiment as JSON Lines on standard output while it runs, for
editors.

Each line is an object with the whole state:

| member | meaning |
| --- | --- |
| `model` | the absolute path of the model |
| `mocks` | the mocks of `--mock`, in which `$(var NAME)` is the value of a parameter |
| `done`, `total` | the number of known points, and of all points |
| `plots` | the plots: `title`, `description`, `width`, `height`, and `scene`, the content of an SVG |
| `columns` | the heads of the table: the parameters, then the properties |
| `rows` | a row for each setting: `setting`, and for each property its point, or null if it is not known |
| `notes` | sentences: what the values mean |
| `answers` | sentences: which values of a parameter are enough; empty without `--find`, and before the end |
| `files` | what an editor saves: the texts `csv` and `html`, and `svg`, one text for each plot |

A point has a `key`, which is `data-key` of its mark in the plots, the name of its `property`, its `text`, and its
`value`: null if it has none, a text if it is infinite.
"""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Mapping, Sequence
from typing import Any

from as2fm_lsp.cli.output import print_text
from roaml.experiments.points import ExperimentPoint
from roaml.experiments.results import ExperimentResult, cell
from roaml.figures.plot import HeatMap, LinePlot, description, drawing_of, plot_page, plot_svg, with_guide
from roaml.figures.svg import MARGIN, svg_scene

INTERVAL_S = 0.2
"""The minimum time between two lines, in s."""


class LiveExperiment:
    """Writes the lines of an experiment.

    Args:
        model: the absolute path of the model.
        total: the number of all points.
        units: parameter -> its unit.
    """

    def __init__(self, model: str, mocks: Sequence[str], total: int, units: Mapping[str, str]) -> None:
        self._common = {"model": model, "mocks": list(mocks), "total": total}
        self._units = units
        self._next = time.monotonic()

    @property
    def is_due(self) -> bool:
        return time.monotonic() >= self._next

    def write(
        self, result: ExperimentResult, guide: tuple[float, str] | None = None, answers: Sequence[str] = ()
    ) -> None:
        """Write a line.

        Args:
            result: the known points.
            guide: a number on the vertical axis, with its name.
            answers: sentences below the plots.
        """
        plots = result.plots(self._units, is_growing=True)
        plots = plots if guide is None else with_guide(plots, *guide)
        line = {
            **self._common,
            "done": len(result.points),
            "plots": [_plot(plot) for plot in plots],
            "columns": [*(sweep.name for sweep in result.sweeps), *result.properties],
            "rows": [
                {"setting": dict(setting), "points": [points.get(name) for name in result.properties]}
                for setting, points in _rows(result).items()
            ],
            "notes": result.notes(),
            "answers": list(answers),
            "files": {
                "csv": result.to_csv(),
                "html": plot_page(result.page_title, plots, result.to_html_table()),
                "svg": [plot_svg(plot) for plot in plots],
            },
        }
        print_text(json.dumps(line, ensure_ascii=True) + "\n")
        sys.stdout.flush()
        self._next = time.monotonic() + INTERVAL_S


def _rows(result: ExperimentResult) -> dict[tuple[tuple[str, str], ...], dict[str, dict[str, Any]]]:
    rows: dict[tuple[tuple[str, str], ...], dict[str, dict[str, Any]]] = {}
    for point in result.points:
        rows.setdefault(point.setting, {})[point.name] = _point(point)
    return rows


def _point(point: ExperimentPoint) -> dict[str, Any]:
    value = None if math.isnan(point.value) else point.value if math.isfinite(point.value) else str(point.value)
    return {"key": point.key, "text": cell(point), "value": value, "property": point.name}


def _plot(plot: LinePlot | HeatMap) -> dict[str, Any]:
    drawing = drawing_of(plot)
    return {
        "title": plot.title,
        "description": description(plot),
        "x": -MARGIN,
        "y": -MARGIN,
        "width": drawing.size.width + 2 * MARGIN,
        "height": drawing.size.height + 2 * MARGIN,
        "scene": svg_scene(drawing),
    }
