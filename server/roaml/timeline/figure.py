# SPDX-License-Identifier: Apache-2.0
"""The drawing of a part of a timeline.

Only visible parts are drawn, and parts that are narrower than a few pixels are drawn together with their neighbours. So
the size of a drawing and the time to create it depend on its width and not on the number of steps.
"""

from __future__ import annotations

import enum
import math
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Iterator, Mapping, Sequence

from roaml.durations import moment
from roaml.figures.drawing import Area, Drawing, Group, Item, Outline, Polyline, Shape, TextItem, Tone
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.text import ELLIPSIS, SMALL, text_width
from roaml.record import Record
from roaml.timeline.record import IDLE, Lane, LaneKind, Plot, SentMessage, Timeline

LANE, PLOT, AXIS, MESSAGES = 26.0, 54.0, 24.0, 38.0
"""The heights of a lane, a plot, the axis, and the row with the names of messages, in pixels."""
_LEGEND_DISTANCE, _LEGEND_LINE, _SWATCH = 12.0, 20.0, 12.0
"""The distance of the legend from what is above it, the height of its lines, and the size of its colors, in pixels."""
CURVES, CURVE_NAME = 120.0, 16.0
"""The minimum height of a row with several curves, and the height of the name of each, in pixels."""
MESSAGES_NAME = "messages: ● sent, ▾ received"
"""The name of the row of messages, with the marks at the ends of their lines."""
_MESSAGE_LINE, _MAX_NAMES = 15.0, 6
"""The height of a line with names of messages, in pixels, and the maximum number of names at one instant."""
_SPAN, _MARGIN = 20.0, 8.0
_TEXT_MARGIN = 9.0
"""The distance of the name of a state from its beginning, where arrows of messages are, in pixels."""
_DOT = 7.0
"""The size of the mark at the sender of a message, in pixels."""
_HEAD_DISTANCE = 8.0
"""The distance of the head of an arrow from the middle of its lane, in pixels, where dots of other messages at the same
instant may be."""
_LEAST_BAR = 3.0
"""The minimum drawn width of states that are drawn as one, in pixels."""
_LEAST = 5.0
"""The minimum width of a state, in pixels. Adjacent states that are narrower are drawn as one, and so are messages
without arrows whose distance is smaller."""
_SAMPLE = 50
"""The number of states drawn as one that are examined for a common color."""
_BESIDE = 8.0
"""The distance of the arrows of messages at one instant that would cover each other, in pixels."""
_MOST_BESIDE = 3
"""The maximum number of such arrows beside each other; further ones are at their instant."""
_ARROW_DISTANCE = 10.0
"""The minimum average distance of messages that are drawn with arrows, in pixels."""
_MACHINE_TONES = (Tone.ROS, Tone.TREE, Tone.BLACKBOARD, Tone.ACTION, Tone.CHANCE)
_CURVE_TONES = (Tone.ROS, Tone.CHANCE, Tone.ACTION, Tone.TREE, Tone.FAILURE, Tone.BLACKBOARD)
_STATUS_TONES: Mapping[str, Tone] = {
    "RUNNING": Tone.RUNNING,
    "SUCCESS": Tone.SUCCESS,
    "FAILURE": Tone.FAILURE,
}


class Axis(enum.Enum):
    """The quantity on the horizontal axis: the time of the model, or the steps of the run."""

    TIME = "time"
    STEPS = "steps"


class Mark(Record, frozen=True):
    """Something that has happened at a step of the run, such as the violation of a property."""

    step: int
    text: str


class View(Record, frozen=True):
    """The part of a timeline that is drawn.

    Attributes:
        start, end: the ends of the drawn range of the axis, in s or steps.
        width: the width of the drawing, in pixels.
        top, bottom: the vertical range whose rows are drawn, in pixels from the top of the timeline.
        cursor: the position of the run as a number of steps; -1 to draw none.
        curves: the names of the plots that are drawn over each other, in one row with a common range.
        marks: what is marked with a line across all rows.
        is_coarse: whether parts without a name are drawn together, without hints. A view shows a drawing of this kind
            for a moment, while the user zooms.
    """

    axis: Axis
    start: float
    end: float
    width: float
    top: float = 0.0
    bottom: float = math.inf
    cursor: int = -1
    curves: tuple[str, ...] = ()
    marks: tuple[Mark, ...] = ()
    is_coarse: bool = False


class _PlotRow(Record, frozen=True):
    """A row with the curve of one plot, or with several curves over each other; `top` and `height` are in pixels."""

    plots: tuple[Plot, ...]
    top: float
    height: float


def extent(timeline: Timeline, axis: Axis) -> float:
    """The end of a timeline on an axis, in s or steps."""
    return timeline.times[-1] if axis is Axis.TIME and timeline.times else float(timeline.count)


def position_of(timeline: Timeline, axis: Axis, step: int) -> float:
    """The position of the state after `step` steps on an axis, in s or steps."""
    return timeline.times[step] if axis is Axis.TIME and timeline.times else float(step)


def step_at(timeline: Timeline, axis: Axis, position: float) -> int:
    """The number of steps that have been taken at a position on an axis, in s or steps; at most the steps of the
    run."""
    if axis is Axis.TIME and timeline.times:
        return max(0, bisect_right(timeline.times, position) - 1)
    return max(0, min(timeline.count, math.floor(position)))


def height_of(timeline: Timeline, curves: Collection[str] = ()) -> float:
    rows = _plot_rows(timeline, curves)
    return rows[-1].top + rows[-1].height if rows else _lane_top(len(timeline.lanes))


def draw_names(timeline: Timeline, width: float, curves: Collection[str] = ()) -> Drawing:
    """The column with the names of the rows."""
    groups = [Group("name", Tone.PLAIN, (_text(MESSAGES_NAME, 4.0, AXIS + MESSAGES / 2, width - 8.0, "muted"),))]
    for index, lane in enumerate(timeline.lanes):
        bold = lane.kind is LaneKind.MACHINE
        text = _text(lane.name, 4.0, _middle(index), width - 8.0, "text", bold=bold)
        groups.append(Group("name", Tone.PLAIN, (text,), hint=lane.name))
    for row in _plot_rows(timeline, curves):
        groups += _plot_names(row, width)
    return Drawing(Extent(width, height_of(timeline, curves)), tuple(groups), {})


class LegendEntry(Record, frozen=True):
    """What the color of a state or status means; `tones` are several if the colors have one meaning together."""

    tones: tuple[Tone, ...]
    words: str


def legend(timeline: Timeline) -> tuple[LegendEntry, ...]:
    """The meaning of the colors of the rows: the states of machines, and the statuses of nodes that have occurred."""
    machines = [lane for lane in timeline.lanes if lane.kind is LaneKind.MACHINE]
    statuses = {state for lane in timeline.lanes if lane.kind is LaneKind.NODE for state in lane.ranks}
    entries = []
    if count := max((len(lane.ranks) for lane in machines), default=0):
        words = "states, in order of entry"
        entries.append(LegendEntry(_MACHINE_TONES[:count], words))
    shown = (IDLE, *_STATUS_TONES)
    return (*entries, *(LegendEntry((_status_tone(name),), name) for name in shown if name in statuses))


def draw_legend(timeline: Timeline, width: float) -> Drawing:
    """The legend in lines that are at most `width` pixels wide."""
    groups = []
    x, top = 4.0, _LEGEND_DISTANCE
    for entry in legend(timeline):
        size = _SWATCH * len(entry.tones) + 6.0 + text_width(entry.words, SMALL)
        if x > 4.0 and x + size > width:
            x, top = 4.0, top + _LEGEND_LINE
        for number, tone in enumerate(entry.tones):
            box = Box(x + _SWATCH * number, top + (_LEGEND_LINE - _SWATCH) / 2, _SWATCH, _SWATCH)
            groups.append(Group("color", tone, (Shape(box, Outline.RECTANGLE, "span"),)))
        start = x + _SWATCH * len(entry.tones) + 6.0
        text = _text(entry.words, start, top + _LEGEND_LINE / 2, width, "muted")
        groups.append(Group("color", Tone.PLAIN, (text,)))
        x += size + 18.0
    return Drawing(Extent(width, top + _LEGEND_LINE if groups else 0.0), tuple(groups), {})


def draw_timeline(timeline: Timeline, view: View) -> Drawing:
    """The axis with the rows below it, without the names of the rows."""
    painter = _Painter(timeline, view)
    return Drawing(Extent(view.width, painter.height), tuple(painter.groups()), {})


class _Painter:
    def __init__(self, timeline: Timeline, view: View) -> None:
        self._timeline = timeline
        self._view = view
        self._scale = view.width / max(view.end - view.start, 1e-9)
        self._end = self._x(timeline.count)
        self._first_message, last = self._visible_messages()
        visible = timeline.messages[self._first_message : last]
        self._has_arrows = bool(visible) and len(visible) <= view.width / _ARROW_DISTANCE
        ranges = [self._crossed(message) for message in visible] if self._has_arrows else []
        self._shifts = self._beside_each_other(ranges)
        """How far the arrow of each visible message is beside the instant of the message, in pixels."""
        self._arrow_places = [(x + shift, *rows) for (x, *rows), shift in zip(ranges, self._shifts, strict=True)]
        self.height = height_of(timeline, view.curves)

    def _x(self, step: int) -> float:
        return (position_of(self._timeline, self._view.axis, step) - self._view.start) * self._scale

    def _first_step(self, x: float) -> int:
        """The number of the first step at or right of a horizontal position in pixels."""
        position = self._view.start + x / self._scale
        if self._view.axis is Axis.TIME and self._timeline.times:
            return bisect_left(self._timeline.times, position)
        return math.ceil(position)

    def groups(self) -> Iterator[Group]:
        timeline = self._timeline
        rules, names = self._axis()
        yield rules
        for index, lane in enumerate(timeline.lanes):
            if self._is_visible(_lane_top(index), LANE):
                yield from self._joined(self._lane(index, lane))
        for row in _plot_rows(timeline, self._view.curves):
            if self._is_visible(row.top, row.height):
                yield from (self._plot(row, number) for number in range(len(row.plots)))
        yield from self._joined(self._messages())
        yield from self._mark_lines()
        if self._view.cursor >= 0:
            x = self._x(self._view.cursor)
            if 0 <= x <= self._view.width:
                line = Polyline((Point(x, 0), Point(x, self.height)), role="cursor")
                yield Group("cursor", Tone.FAILURE, (line,))
        yield names  # above the rows that are scrolled beneath it
        yield from self._mark_names()

    def _joined(self, groups: Iterator[Group]) -> Iterator[Group]:
        """The groups of a row; in a coarse drawing, those of one rectangle are one area for each color."""
        areas: dict[tuple[Tone, str], list[Point]] = {}
        for group in groups:
            item = group.items[0]
            if not self._view.is_coarse or len(group.items) > 1 or not isinstance(item, Shape):
                yield group
                continue
            role = "coarse" if item.role == "span" else item.role
            box = item.box
            # Along the lower border, the outline returns on itself.
            areas.setdefault((group.tone, role), []).extend(
                (Point(box.x, box.bottom), Point(box.x, box.y), Point(box.right, box.y), Point(box.right, box.bottom))
            )
        for (tone, role), points in areas.items():
            yield Group("state", tone, (Area(tuple(points), role),))

    def _is_visible(self, top: float, height: float) -> bool:
        return top + height >= self._view.top and top <= self._view.bottom

    # ------------------------------------------------------------ axis

    def _axis(self) -> tuple[Group, Group]:
        """The grid lines of the axis, and its numbers."""
        view = self._view
        distance = _round_distance((view.end - view.start) * 90.0 / max(view.width, 1.0))
        if view.axis is Axis.STEPS:
            distance = max(1.0, distance)
        unit = " s" if view.axis is Axis.TIME and self._timeline.times else ""
        digits = max(0, -math.floor(math.log10(distance)))
        rules: list[Item] = []
        names: list[Item] = [Shape(Box(0.0, 0.0, view.width, AXIS), Outline.RECTANGLE, "axis-card")]
        last = min(view.end, extent(self._timeline, view.axis))
        free_from = 0.0
        for number in range(math.ceil(view.start / distance - 1e-9), math.floor(last / distance + 1e-9) + 1):
            x = (number * distance - view.start) * self._scale
            rules.append(Polyline((Point(x, AXIS), Point(x, self.height)), role="rule"))
            text = f"{number * distance:,.{digits}f}{unit}" + self._time_beside(round(number * distance))
            width = text_width(text, SMALL)
            left = min(max(x - width / 2, 0.0), view.width - width)
            if left >= free_from:
                names.append(TextItem(text, left, AXIS - 8.0, SMALL, "muted"))
                free_from = left + width + 6.0
        return Group("axis", Tone.PLAIN, tuple(rules)), Group("axis-names", Tone.PLAIN, tuple(names))

    def _time_beside(self, step: int) -> str:
        """The time that is written beside the number of a step on an axis of steps."""
        times = self._timeline.times
        return f" · {times[step]:.6g} s" if self._view.axis is Axis.STEPS and step < len(times) else ""

    # ------------------------------------------------------------ marks

    def _visible_marks(self) -> Iterator[tuple[float, Mark]]:
        for mark in self._view.marks:
            if 0.0 <= (x := self._x(mark.step)) <= self._view.width:
                yield x, mark

    def _mark_lines(self) -> Iterator[Group]:
        for x, mark in self._visible_marks():
            line = Polyline((Point(x, AXIS), Point(x, self.height)), role="mark")
            yield Group("event", Tone.FAILURE, (line,), hint=mark.text, step=mark.step)

    def _mark_names(self) -> Iterator[Group]:
        """The texts of the marks, in the row of the axis. Those that would cover an earlier one are left out. They end
        at their lines, because most are at the end of a run."""
        free_from = 0.0
        for x, mark in self._visible_marks():
            text = _fitting(mark.text, self._view.width - 12.0)
            width = text_width(text, SMALL) + 8.0
            left = max(x - width, 0.0)
            if left < free_from or not text:
                continue
            free_from = left + width + 4.0
            card = Shape(Box(left, 1.0, width, AXIS - 4.0), Outline.ROUNDED, "mark-card")
            name = TextItem(text, left + 4.0, AXIS - 8.0, SMALL, "text")
            yield Group("axis-names", Tone.FAILURE, (card, name), hint=mark.text, step=mark.step)

    # ------------------------------------------------------------ lanes

    def _lane(self, index: int, lane: Lane) -> Iterator[Group]:
        y = _lane_top(index) + (LANE - _SPAN) / 2
        starts = lane.starts
        right = min(self._view.width, self._end)
        number = max(0, bisect_right(starts, self._first_step(0.0)) - 1)
        while number < len(starts):
            x, end = self._ends(starts, number)
            if x > right:
                return
            if end - x >= _LEAST:
                if end > 0:
                    yield self._span(lane, number, max(x, 0.0), min(end, self._view.width), y)
                number += 1
                continue
            first, left = number, x
            while end - x < _LEAST and x <= right:
                # Skip the states that begin in the same pixel.
                number = max(number + 1, bisect_left(starts, self._first_step(x + 1.0), number) - 1)
                if number == len(starts):
                    x = self._end
                    break
                x, end = self._ends(starts, number)
            yield self._busy(lane, first, number, left, x, y)

    def _ends(self, starts: Sequence[int], number: int) -> tuple[float, float]:
        """The positions where a state begins and ends, in pixels."""
        end = self._x(starts[number + 1]) if number + 1 < len(starts) else self._end
        return self._x(starts[number]), end

    def _span(self, lane: Lane, number: int, x: float, end: float, y: float) -> Group:
        state = lane.states[number]
        box = Box(x, y, end - x, _SPAN)
        items: list[Item] = [Shape(box, Outline.RECTANGLE, "span")]
        left, right = self._free_part(x, end, y, text_width(state, SMALL))
        text = _fitting(state, right - left)
        if text:
            items.append(TextItem(text, left, y + _SPAN / 2 + SMALL * 0.35, SMALL, "text"))
        hint = f"{lane.name}: {state}, {self._when(lane.starts[number])}"
        return Group("state", _tone(lane, state), tuple(items), hint=hint, step=lane.starts[number])

    def _free_part(self, x: float, end: float, y: float, width: float) -> tuple[float, float]:
        """The ends of the first part of a state, between the arrows that cross it, that is at least `width` wide;
        otherwise of the widest part."""
        middle = y + _SPAN / 2
        arrows = sorted(
            place
            for place, top, bottom in self._arrow_places
            if x - _TEXT_MARGIN <= place < end and top <= middle <= bottom
        )
        starts = [place + _TEXT_MARGIN for place in (x, *arrows)]
        ends = [*(place - _TEXT_MARGIN for place in arrows), end - 3.0]
        parts = list(zip(starts, ends, strict=True))
        fitting = (part for part in parts if part[1] - part[0] >= width)
        return next(fitting, max(parts, key=lambda part: part[1] - part[0]))

    def _busy(self, lane: Lane, first: int, number: int, x: float, end: float, y: float) -> Group:
        box = Box(max(x, 0.0), y, max(min(end, self._view.width) - max(x, 0.0), _LEAST_BAR), _SPAN)
        box = box._replace(x=max(0.0, min(box.x, self._view.width - box.width)))
        count = number - first
        counted = lane.states[first] if count == 1 else f"{count:,} states from step {lane.starts[first]:,}"
        tones = {_tone(lane, state) for state in lane.states[first : min(number, first + _SAMPLE)]}
        tone = tones.pop() if len(tones) == 1 else Tone.PLAIN
        hint = f"{lane.name}: {counted}" + (f", {self._when(lane.starts[first])}" if count == 1 else "")
        items = (Shape(box, Outline.RECTANGLE, "busy"),)
        return Group("state", tone, items, hint=hint, step=lane.starts[first] if count == 1 else None)

    def _when(self, step: int) -> str:
        return f"step {step:,}" + (f", {moment(self._timeline.times[step])}" if self._timeline.times else "")

    # ------------------------------------------------------------ messages

    def _messages(self) -> Iterator[Group]:
        """Marks for the messages, with their names if there is space; those at one instant share a text, in their
        order. If there are too many messages, they have no arrows, and those that are close to each other have one
        mark."""
        messages = self._timeline.messages
        first, last = self._visible_messages()
        has_arrows = self._has_arrows
        free_from = -math.inf
        number = named = first
        while number < last:
            following = number + 1 if has_arrows else self._behind_mark(number, last)
            marked = messages[number:following]
            number = following
            x, end = self._x(marked[0].received), self._x(marked[-1].received)
            if x > self._view.width:
                return
            box = Box(x - 1.0, AXIS + 2.0, min(end, self._view.width) - x + 2.0, MESSAGES - 4.0)
            items: list[Item] = [Shape(box, Outline.RECTANGLE, "pulse")]
            following = bisect_left(messages, self._first_step(end + 1.0), following, last, key=_received)
            beside = self._x(messages[following].received) if following < last else min(self._view.width, self._end)
            name = ", ".join(dict.fromkeys(message.name for message in marked[:_SAMPLE]))
            here = messages[number - len(marked) : min(following, number + _SAMPLE)]
            names = tuple(dict.fromkeys(message.name for message in here))
            texts = _beside(names, x, end, free_from, beside) if number > named else []
            named = max(named, following)
            items += texts
            free_from = max(free_from, end + 6.0, *(text.box.right + 6.0 for text in texts))
            if has_arrows:
                items += self._arrows(marked[0], self._shifts[number - 1 - self._first_message])
            # There, the message is in the ROS graph, and the next step is at the line that receives it.
            step = marked[0].received - 1 if len(marked) == 1 else None
            yield Group("event", Tone.PLAIN, tuple(items), hint=self._message_hint(name, marked), step=step)

    def _visible_messages(self) -> tuple[int, int]:
        """The number of the first visible message, and that behind the last one."""
        messages = self._timeline.messages
        first = bisect_left(messages, self._first_step(0.0), key=_received)
        return first, bisect_right(messages, self._first_step(self._view.width + 1.0), key=_received)

    def _crossed(self, message: SentMessage) -> tuple[float, float, float]:
        """The horizontal position of the arrow of a message, and the vertical range that it crosses."""
        lanes = [_middle(lane) for lane in (message.sender, *message.receivers)]
        return self._x(message.received), min(lanes) - _DOT, max(lanes) + _DOT

    def _beside_each_other(self, ranges: Sequence[tuple[float, float, float]]) -> list[float]:
        """How far each arrow is beside its place, so that it covers no other one at the same instant: to the right, or
        to the left at the end of the run."""
        places: list[tuple[float, float, float]] = []
        shifts = []
        for x, top, bottom in ranges:
            side = 1 if x + _MOST_BESIDE * _BESIDE < min(self._view.width, self._end) else -1
            taken = {place for place, upper, lower in places if upper < bottom and top < lower}
            candidates = (side * _BESIDE * number for number in range(_MOST_BESIDE))
            shift = next((s for s in candidates if all(abs(x + s - place) >= _BESIDE for place in taken)), 0.0)
            places.append((x + shift, top, bottom))
            shifts.append(shift)
        return shifts

    def _behind_mark(self, number: int, last: int) -> int:
        """The number of the first message after the mark that begins with a message."""
        messages = self._timeline.messages
        x = self._x(messages[number].received)
        following = number + 1
        while following < last and (beside := self._x(messages[following].received)) - x < _LEAST:
            # Skip the messages in the same pixel.
            following = max(
                following + 1,
                bisect_left(messages, self._first_step(beside + 1.0), following, last, key=_received),
            )
            x = self._x(messages[following - 1].received)
        return following

    def _arrows(self, message: SentMessage, shift: float) -> Iterator[Item]:
        """The lines from the sender to the receivers, with a dot at the sender."""
        start = Point(self._x(message.sent) + shift, _middle(message.sender))
        others = [receiver for receiver in message.receivers if receiver != message.sender]
        for receiver in others:
            middle = _middle(receiver)
            end = Point(self._x(message.received) + shift, middle - math.copysign(_HEAD_DISTANCE, middle - start.y))
            yield Polyline((start, end), True, "message", is_round=False)
        if others:
            yield Shape(Box(start.x - _DOT / 2, start.y - _DOT / 2, _DOT, _DOT), Outline.PILL, "dot")

    def _message_hint(self, name: str, marked: Sequence[SentMessage]) -> str:
        first = marked[0]
        if len(marked) > 1:
            return f"{len(marked):,} messages from step {first.received:,}: {name}"
        names = ", ".join(self._timeline.lanes[receiver].name for receiver in first.receivers)
        return f"{name}: {self._timeline.lanes[first.sender].name} → {names}, {self._when(first.received)}"

    # ------------------------------------------------------------ plots

    def _plot(self, row: _PlotRow, number: int) -> Group:
        """One of the curves of a row."""
        plot = row.plots[number]
        points = self._points_of(plot, row)
        items: list[Item] = []
        if number == 0:
            bottom = row.top + row.height
            items.append(Polyline((Point(0.0, bottom), Point(self._view.width, bottom)), role="rule"))
        if len(points) > 1:
            items.append(Polyline(tuple(points), role="plot", is_round=False))
        return Group("variable", _curve_tone(row, number), tuple(items), hint=plot.name)

    def _points_of(self, plot: Plot, row: _PlotRow) -> list[Point]:
        """The corners of a curve. In one pixel, only the first, the last, the least and the greatest value are used."""
        first = max(0, bisect_right(plot.steps, self._first_step(0.0)) - 1)
        last = bisect_right(plot.steps, self._first_step(self._view.width))
        low, high = _range(row.plots)
        space = row.height - 2 * _MARGIN

        def y(value: float) -> float:
            clipped = min(max(value, low), high) if not math.isnan(value) else low
            return row.top + row.height - _MARGIN - (clipped - low) / ((high - low) or 1.0) * space

        points: list[Point] = []
        number = first
        while number < last:
            x = max(0.0, self._x(plot.steps[number]))
            if x > self._view.width:
                break
            following = max(number + 1, bisect_left(plot.steps, self._first_step(x + 1.0), number, last))
            values = plot.values[number:following]
            if points:
                points.append(Point(x, points[-1].y))
            points.append(Point(x, y(values[0])))
            if len(values) > 2:
                points += (Point(x, y(min(values))), Point(x, y(max(values))))
            if len(values) > 1:
                points.append(Point(x, y(values[-1])))
            number = following
        if points:
            points.append(Point(max(points[-1].x, min(self._view.width, self._end)), points[-1].y))
        return points


def _plot_rows(timeline: Timeline, curves: Collection[str]) -> list[_PlotRow]:
    """The rows below the lanes: first that of the curves over each other, if there are any."""
    together = tuple(plot for plot in timeline.plots if plot.name in curves)
    rows = []
    top = _lane_top(len(timeline.lanes))
    if together:
        rows.append(_PlotRow(together, top, max(CURVES, CURVE_NAME * (len(together) + 1))))
        top += rows[0].height
    alone = (plot for plot in timeline.plots if plot.name not in curves)
    rows += (_PlotRow((plot,), top + PLOT * index, PLOT) for index, plot in enumerate(alone))
    return rows


def _curve_tone(row: _PlotRow, number: int) -> Tone:
    return _CURVE_TONES[number % len(_CURVE_TONES)] if len(row.plots) > 1 else Tone.ROS


def _plot_names(row: _PlotRow, width: float) -> Iterator[Group]:
    """The names of the curves of a row, and right of them the ends of their range at their heights, where no line
    crosses them."""
    low, high = _range(row.plots)
    is_flag = all(plot.is_flag for plot in row.plots)
    numbers = [("true" if is_flag else _number(high), row.top + _MARGIN)]
    if low != high:
        numbers.append(("false" if is_flag else _number(low), row.top + row.height - _MARGIN))
    # The name of a single curve is between the ends of the range.
    free = width - 8.0
    if len(row.plots) > 1:
        free -= max(text_width(number, SMALL) + 6.0 for number, _ in numbers)
    ends = [_text(number, width - 4.0 - text_width(number, SMALL), y, width, "muted") for number, y in numbers]
    first = row.top + row.height / 2 - CURVE_NAME * (len(row.plots) - 1) / 2
    for number, plot in enumerate(row.plots):
        y, role = first + CURVE_NAME * number, "curve" if len(row.plots) > 1 else "muted"
        items = (_text(plot.name, 4.0, y, free, role), *(ends if number == 0 else ()))
        yield Group("name", _curve_tone(row, number), items, hint=plot.name)


def _range(plots: Sequence[Plot]) -> tuple[float, float]:
    """The lowest and the highest finite value of plots; 0 and 1 for flags."""
    finite = [value for plot in plots for value in plot.values if math.isfinite(value)] or [0.0]
    return (0.0, 1.0) if all(plot.is_flag for plot in plots) else (min(finite), max(finite))


def _beside(names: Sequence[str], x: float, end: float, free_from: float, beside: float) -> list[TextItem]:
    """The names of messages beside their mark from `x` to `end`: right of it if they end before `beside`, otherwise on
    the side with more space, of which the left one begins at `free_from`."""
    before = x - 3.0 - max(free_from, 0.0)
    behind = beside - end - 6.0 if end >= free_from - 6.0 else 0.0
    lines = _lines(names, behind)
    is_left = before > behind and ", ".join(lines) != ", ".join(names)
    if is_left:
        lines = _lines(names, before)
    y = AXIS + (MESSAGES - _MESSAGE_LINE * (len(lines) - 1)) / 2 + SMALL * 0.35
    lefts = [x - 3.0 - text_width(line, SMALL) if is_left else end + 3.0 for line in lines]
    return [
        TextItem(line, left, y + _MESSAGE_LINE * row, SMALL, "text")
        for row, (line, left) in enumerate(zip(lines, lefts, strict=True))
    ]


def _lines(names: Sequence[str], width: float) -> list[str]:
    """One or two short lines with as many of the names as fit into a width, and the number of the others; a first name
    for which there is no space is shortened."""

    def longest(lines: Sequence[str]) -> float:
        return max(text_width(line, SMALL) for line in lines)

    if longest(names[:1]) > width:
        return [text] if (text := _fitting(names[0], width)) else []
    for count in range(min(len(names), _MAX_NAMES), 0, -1):
        parts = [*names[:count], *([f"+{len(names) - count}"] if count < len(names) else [])]
        pairs = ((", ".join(parts[:first]), ", ".join(parts[first:])) for first in range(1, len(parts) + 1))
        lines = [line for line in min(pairs, key=longest) if line]
        if longest(lines) <= width:
            return lines
    return [names[0]]


def _received(message: SentMessage) -> int:
    return message.received


def _lane_top(index: int) -> float:
    return AXIS + MESSAGES + LANE * index


def _middle(index: int) -> float:
    return _lane_top(index) + LANE / 2


def _tone(lane: Lane, state: str) -> Tone:
    if lane.kind is LaneKind.NODE:
        return _status_tone(state)
    return _MACHINE_TONES[lane.ranks[state] % len(_MACHINE_TONES)]


def _status_tone(status: str) -> Tone:
    return _STATUS_TONES.get(status, Tone.IDLE)


def _text(text: str, x: float, middle: float, width: float, role: str, *, bold: bool = False) -> TextItem:
    return TextItem(_fitting(text, width, bold=bold), x, middle + SMALL * 0.35, SMALL, role, bold)


def _fitting(text: str, width: float, *, bold: bool = False) -> str:
    """The text, shortened to a width in pixels; "" if fewer than three characters fit."""
    if text_width(text, SMALL, bold=bold) <= width:
        return text
    while len(text) > 3 and text_width(text + ELLIPSIS, SMALL, bold=bold) > width:
        text = text[:-1]
    return text + ELLIPSIS if text_width(text + ELLIPSIS, SMALL, bold=bold) <= width else ""


def _round_distance(distance: float) -> float:
    """The smallest of …, 0.5, 1, 2, 5, 10, 20, … that is at least `distance`."""
    power = 10.0 ** math.floor(math.log10(max(distance, 1e-9)))
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= distance * (1 - 1e-9))


def _number(value: float) -> str:
    return f"{value:.6g}"
