# SPDX-License-Identifier: Apache-2.0
"""Requests for what a client shows beside the source: the timeline of the run, the active parts of pictures, and the
moments that are played."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from as2fm_lsp.debug.arguments import Arguments, RequestError
from as2fm_lsp.debug.moments import MAX_MOMENTS, moments
from as2fm_lsp.debug.session import Body, DebugSession, Handler
from roaml.debugging.activity import active_edges, active_nodes, nodes_of_automata
from roaml.debugging.debugger import Debugger
from roaml.exhaustive import Vocabulary
from roaml.figures.svg import svg_scene
from roaml.figures.themes import THEMES
from roaml.jani.node import Origin
from roaml.simulation.session import Session
from roaml.smc.record import TraceVerdict
from roaml.timeline import (
    Axis,
    Mark,
    Timeline,
    View,
    draw_legend,
    draw_names,
    draw_timeline,
    extent,
    height_of,
    position_of,
    step_at,
)
from roaml.views.story import as_mermaid

MAX_WIDTH = 20_000
"""The maximum width of a drawing in pixels."""
NAMES_WIDTH = 180.0
"""The width of the names of rows, in pixels."""
LEGEND_WIDTH = 480.0
"""The width of the legend, in pixels: narrower than most views, which do not scroll it."""

T = TypeVar("T")


class TimelineFormat(Vocabulary):
    """A format in which a timeline is exported."""

    SVG = "svg"
    CSV = "csv"
    MERMAID = "mermaid"


_FORMATS = {format_.value: format_ for format_ in TimelineFormat}


class TimelineRequests:
    """The handlers of requests for the timeline and for active parts."""

    def __init__(self, session: DebugSession) -> None:
        self._session = session
        self._run: Session | None = None
        self._timeline: Timeline | None = None
        self.handlers: Mapping[str, Handler] = {
            "timeline": self._show,
            "exportTimeline": self._export,
            "pictures": self._pictures,
            "moments": self._moments,
        }

    def _followed(self, debugger: Debugger) -> Timeline:
        """The timeline of the run, with all steps that have been taken."""
        if self._timeline is None or self._run is not debugger.session:
            self._run, self._timeline = debugger.session, Timeline(debugger.session)
        self._timeline.follow(debugger.session)
        return self._timeline

    def _show(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        timeline = self._followed(debugger)
        view = _view(arguments, timeline, debugger)
        names: dict[str, Any] = {}
        if arguments.flag("names", False):
            colors = draw_legend(timeline, LEGEND_WIDTH)
            names = {
                "names": svg_scene(draw_names(timeline, NAMES_WIDTH, view.curves)),
                "legend": svg_scene(colors),
                "legendHeight": colors.size.height,
                "plots": [plot.name for plot in timeline.plots],
                "lanes": list(nodes_of_automata(debugger, (lane.automaton for lane in timeline.lanes))),
            }
        return {
            "scene": svg_scene(draw_timeline(timeline, view)),
            **names,
            "from": view.start,
            "to": view.end,
            "width": view.width,
            "height": height_of(timeline, view.curves),
            "extent": extent(timeline, view.axis),
            "hasTime": bool(timeline.times),
            "step": debugger.session.position,
            "steps": timeline.count,
            "cursor": position_of(timeline, view.axis, debugger.session.position),
            "first": step_at(timeline, view.axis, view.start),
        }

    def _export(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        timeline = self._followed(debugger)
        view = _view(arguments, timeline, debugger)
        first, last = (step_at(timeline, view.axis, position) for position in (view.start, view.end))
        word = arguments.text("format", None)
        format_ = _FORMATS.get(word)
        if format_ is TimelineFormat.SVG:
            from as2fm_lsp.verification.run_files import stretch_svg  # noqa: PLC0415 - only here

            theme = arguments.text("theme")
            title = Path(debugger.sources.target.path).name
            return {"text": stretch_svg(timeline, view, title, theme if theme in THEMES else "light")}
        if format_ is TimelineFormat.CSV:
            from as2fm_lsp.verification.run_files import csv_lines  # noqa: PLC0415

            return {"text": _at(debugger, last, lambda session: "".join(csv_lines(session, first)))}
        if format_ is TimelineFormat.MERMAID:

            def place_of(origin: Origin) -> str:
                place = debugger.sources.place(origin)
                return f"{Path(place.path).name}:{place.line}" if place else ""

            return {"text": _at(debugger, last, lambda session: as_mermaid(session.story(), place_of, first))}
        raise RequestError(f"`format` is `{word}`; it must be `svg`, `csv` or `mermaid`")

    def _pictures(self, arguments: Arguments) -> Body:
        return self._activity(self._session.stopped)

    def _activity(self, debugger: Debugger) -> dict[str, Any]:
        return {
            "nodes": [
                {
                    "kind": node.picture.value,
                    "source": self._session.client.source(node.path),
                    "node": node.node,
                    "look": node.look,
                }
                for node in active_nodes(debugger)
            ],
            "edges": [{"from": edge.source, "to": edge.target} for edge in active_edges(debugger)],
            "verdicts": {name: verdict.value for name, verdict in debugger.verdicts.items()},
        }

    def _moments(self, arguments: Arguments) -> Body:
        debugger = self._session.stopped
        timeline = self._followed(debugger)
        axis = _axis(arguments, timeline)
        start, by = arguments.decimal("from", 0.0), arguments.decimal("by", 1.0)
        count = arguments.natural("count", 1)
        after = arguments.natural("after", 0) if arguments.has("after") else None
        if start < 0 or by <= 0 or not 1 <= count <= MAX_MOMENTS:
            raise RequestError(f"`from` must be at least 0, `by` greater than 0, and `count` from 1 to {MAX_MOMENTS}")
        with debugger.elsewhere() as session:
            shown = [
                {
                    "step": step,
                    "position": position,
                    "time": session.time,
                    "isEnd": session.end is not None,
                    "stop": reason,
                    **self._activity(debugger),
                }
                for step, position, reason in moments(debugger, timeline, axis, start, by, count, after)
            ]
        return {"moments": shown}


def _axis(arguments: Arguments, timeline: Timeline) -> Axis:
    return Axis.STEPS if arguments.text("axis") == "steps" or not timeline.times else Axis.TIME


def _view(arguments: Arguments, timeline: Timeline, debugger: Debugger) -> View:
    axis = _axis(arguments, timeline)
    start = max(0.0, arguments.decimal("from", 0.0))
    end = arguments.decimal("to", extent(timeline, axis))
    width = arguments.decimal("width", 1000.0)
    if not 1 <= width <= MAX_WIDTH:
        raise RequestError(f"`width` must be a number from 1 to {MAX_WIDTH}")
    if end < start:
        raise RequestError("`to` must not be smaller than `from`")
    top, bottom = arguments.decimal("top", 0.0), arguments.decimal("bottom", math.inf)
    curves = tuple(arguments.texts("curves"))
    violated = tuple(
        Mark(decided.position, f"violated: {decided.name}")
        for decided in debugger.decided
        if decided.verdict is TraceVerdict.FAILED
    )
    is_coarse = arguments.flag("coarse", False)
    return View(axis, start, end, width, top, bottom, curves=curves, marks=violated, is_coarse=is_coarse)


def _at(debugger: Debugger, step: int, read: Callable[[Session], T]) -> T:
    """The result of `read` at a step of the run. Afterwards, the run is at its previous position again."""
    with debugger.elsewhere() as session:
        session.jump(step)
        return read(session)
