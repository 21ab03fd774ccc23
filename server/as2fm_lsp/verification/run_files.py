# SPDX-License-Identifier: Apache-2.0
"""A simulated run as files: CSV with the table of `roaml.simulation.table`, JSON with the steps as `trace_files` writes
them, and a timeline as SVG."""

from __future__ import annotations

import json
from collections.abc import Iterator

from as2fm_lsp.verification.trace_files import csv_line, step_row
from roaml.figures.assembly import moved
from roaml.figures.drawing import Drawing
from roaml.figures.geometry import Extent
from roaml.figures.svg import TIMELINE_STYLES, svg_file
from roaml.simulation import Session
from roaml.simulation.table import rows
from roaml.timeline import Axis, Timeline, View, draw_legend, draw_names, draw_timeline, position_of
from roaml.verification.target import VerificationTarget
from roaml.views.actors import names_of
from roaml.views.shared_names import shared_names


def csv_lines(session: Session, first: int = 0) -> Iterator[str]:
    """The header, and a line for each state from step `first` to the current position of the session, both included.
    The session moves to `first` and from there back to its position."""
    for number, row in enumerate(rows(session, first)):
        if number == 0:
            yield csv_line(row)
        yield csv_line(row.values())


TIMELINE_WIDTH, NAMES_WIDTH = 960.0, 200.0
"""The widths of a timeline and of the names of its rows, in pixels: together, they fit into a window without a smaller
scale."""


def timeline_svg(session: Session, title: str, theme: str) -> str:
    """The run up to the position of the session, as a timeline in SVG over the time of the model, or over the steps if
    the model has no clock."""
    timeline = Timeline(session)
    timeline.follow(session)
    axis = Axis.TIME if timeline.times else Axis.STEPS
    end = position_of(timeline, axis, session.position)
    return stretch_svg(timeline, View(axis, 0.0, end or 1.0, TIMELINE_WIDTH), title, theme)


def stretch_svg(timeline: Timeline, view: View, title: str, theme: str) -> str:
    """The part of a timeline that `view` selects, with the names of its rows, as SVG."""
    names, rows = draw_names(timeline, NAMES_WIDTH), draw_timeline(timeline, view)
    width, top = NAMES_WIDTH + rows.size.width, rows.size.height
    colors = draw_legend(timeline, width)
    size = Extent(width, top + colors.size.height)
    beside = (moved(group, NAMES_WIDTH, 0.0) for group in rows.groups)
    groups = (*names.groups, *beside, *(moved(group, 0.0, top) for group in colors.groups))
    return svg_file(Drawing(size, groups, {}), title, theme, TIMELINE_STYLES)


def json_text(session: Session, target: VerificationTarget) -> str:
    """The steps up to the position of the session as JSON, with the property, seed, trace, verdict and end of the
    run."""
    saved, end = session.save(), session.end
    automata = session.automata_of_model
    shown = shared_names(session.start, names_of(automata))
    value = {
        "property": saved.property,
        "trace": saved.trace,
        "seed": saved.seed,
        "by_hand": session.is_by_hand,
        "steps": [step_row(target, automata, shown, step) for step in session.steps[: session.position]],
        "verdict": session.verdict.value,
        "end": None if end is None else end.key,
    }
    return json.dumps(value, ensure_ascii=False, indent=1) + "\n"
