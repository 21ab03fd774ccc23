# SPDX-License-Identifier: Apache-2.0
"""Timelines: their lanes and plots against the states of the run, and their drawings."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from bisect import bisect_right
from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run
from roaml import api
from roaml.figures.drawing import Area, Drawing, Group, Outline, Polyline, Shape, TextItem, Tone
from roaml.figures.geometry import Box, Extent, Point
from roaml.figures.svg import svg_scene
from roaml.figures.text import text_width
from roaml.record import replace
from roaml.simulation import Session
from roaml.simulation.state import NodeStatus
from roaml.timeline import (
    Axis,
    LaneKind,
    Timeline,
    View,
    draw_legend,
    draw_names,
    draw_timeline,
    extent,
    position_of,
    step_at,
)

EXAMPLES = Path(__file__).parents[2] / "examples"
ROBOT = EXAMPLES / "assembly_robot" / "main_with_bug.xml"
CASE_STUDY = EXAMPLES / "case_study" / "main.xml"
DELIVERY = EXAMPLES / "delivery_robot" / "main.xml"


def timeline_of(session: Session) -> Timeline:
    timeline = Timeline(session)
    timeline.follow(session)
    return timeline


@pytest.mark.parametrize("path", [ROBOT, DELIVERY], ids=lambda path: path.parent.name)
def test_lanes_and_plots_show_the_states_of_the_run(path: Path) -> None:
    session = api.session(api.load(str(path)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    lanes = {lane.name: lane for lane in timeline.lanes}
    plots = {plot.name: plot for plot in timeline.plots}
    compared = set()
    for position in range(session.position + 1):
        session.jump(position)
        state = session.state()
        assert timeline.times[position] == state.time
        for machine in state.machines:
            if machine.name not in lanes:
                assert machine.name.endswith("__observer")
                continue
            lane = lanes[machine.name]
            if lane.kind is LaneKind.MACHINE:
                assert lane.states[bisect_right(lane.starts, position) - 1] == machine.state, position
            for name, value in machine.variables.items():
                plot = plots.get(f"{machine.name}.{name}")
                if plot is not None:
                    assert plot.values[bisect_right(plot.steps, position) - 1] == value
                    compared.add(plot.name)
        for node in state.nodes:
            lane = lanes[node.name]
            if node.status is not NodeStatus.TICKED:
                assert lane.states[bisect_right(lane.starts, position) - 1] == node.status.value, position
    assert compared


def test_messages_lead_from_their_sender_to_their_receivers() -> None:
    session = api.session(api.load(str(ROBOT)), seed=3)
    session.until_decided()
    timeline = timeline_of(session)
    names = [lane.name for lane in timeline.lanes]
    first = timeline.messages[0]
    assert (first.name, names[first.sender]) == ("/arm/command", "PickUp")
    assert [names[receiver] for receiver in first.receivers] == ["Arm"]
    assert first.sent < first.received
    assert session.steps[first.received - 1].action == "topic_arm__command_msg_on_receive"


def test_a_call_goes_through_its_handler_to_the_server() -> None:
    session = api.session(api.load(str(CASE_STUDY)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    names = [lane.name for lane in timeline.lanes]
    calls = {
        (message.name, names[message.sender], names[receiver])
        for message in timeline.messages
        for receiver in message.receivers
        if message.name.startswith("/block/pick_up")
    }
    assert calls == {
        ("/block/pick_up request", "Recoverer", "Mover"),
        ("/block/pick_up response", "Mover", "Recoverer"),
    }


def test_a_timeline_is_continued_and_read_again_after_a_choice() -> None:
    session = api.session(api.load(str(ROBOT)), seed=3)
    timeline = Timeline(session)
    for _ in range(40):
        session.turn()
        timeline.follow(session)
    assert timeline.lanes == timeline_of(session).lanes
    assert timeline.plots == timeline_of(session).plots
    before = list(timeline.times)
    while len(session.choices()) < 2:
        session.back()
    other = next(choice for choice in session.choices() if session.upcoming().parts[0].automaton not in choice.automata)
    session.step(other)
    timeline.follow(session)
    assert timeline.count == session.position
    assert timeline.messages == timeline_of(session).messages
    assert timeline.times == before[: session.position + 1]


@pytest.mark.parametrize("axis", Axis)
def test_drawings_stay_within_their_width(axis: Axis) -> None:
    session = api.session(api.load(str(ROBOT)), seed=3)
    session.until_decided()
    timeline = timeline_of(session)
    whole = extent(timeline, axis)
    for start, end, width in ((0.0, whole, 900.0), (whole / 3, whole / 2, 900.0), (0.0, whole, 40.0), (0.0, 0.0, 90.0)):
        drawing = draw_timeline(timeline, View(axis, start, end, width, cursor=session.position))
        items = list(drawing.walk())
        assert len(items) <= (len(timeline.lanes) + len(timeline.plots) + 2) * (width / 3 + 10)
        texts = _texts(drawing)
        assert all(text.box.x >= -0.1 and text.box.right <= width + 0.1 for text in texts)
        rows = {text.y for text in texts}
        for row in rows:
            boxes = sorted(text.box for text in texts if text.y == row and text.role != "muted")
            assert all(left.right <= right.x for left, right in itertools.pairwise(boxes))


def test_messages_at_one_time_have_a_dot_at_each_sender() -> None:
    session = api.session(api.load(str(DELIVERY)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    drawing = draw_timeline(timeline, View(Axis.TIME, 0.0, extent(timeline, Axis.TIME), 900.0))
    places = []
    for group in drawing.groups:
        lines = [item for item in group.items if isinstance(item, Polyline) and item.role == "message"]
        dots = [item.box for item in group.items if isinstance(item, Shape) and item.role == "dot"]
        assert len(dots) == min(1, len(lines))
        for dot in dots:
            middle = Point(dot.x + dot.width / 2, dot.y + dot.height / 2)
            assert {line.points[0] for line in lines} == {middle}
            places.append(middle.x)
    assert len(places) > 4


def test_messages_at_one_time_are_all_named() -> None:
    session = api.session(api.load(str(DELIVERY)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    drawing = draw_timeline(timeline, View(Axis.TIME, 0.0, extent(timeline, Axis.TIME), 1500.0))
    by_time: dict[float, list[str]] = {}
    for message in timeline.messages:
        by_time.setdefault(timeline.times[message.received], []).append(message.name)
    assert any(len(set(names)) > 1 for names in by_time.values())
    events = [group for group in drawing.groups if group.role == "event"]
    lines = [tuple(item.text for item in group.items if isinstance(item, TextItem)) for group in events]
    written = [", ".join(texts).split(", ") for texts in lines if texts]
    assert written == [list(dict.fromkeys(names)) for names in by_time.values()]
    assert max(map(len, lines)) == 2
    # Where names are left of their mark, a later mark at the same instant has no name of its own.
    robot = api.session(api.load(str(ROBOT)), seed=3)
    robot.until_decided()
    timeline_of_robot = timeline_of(robot)
    for width in range(400, 1200, 50):
        view = View(Axis.TIME, 0.0, extent(timeline_of_robot, Axis.TIME), float(width))
        named: dict[float, int] = {}
        for group in draw_timeline(timeline_of_robot, view).groups:
            if group.role == "event" and any(isinstance(item, TextItem) for item in group.items):
                mark = next(item.box.x for item in group.items if isinstance(item, Shape))
                named[mark] = named.get(mark, 0) + 1
        assert set(named.values()) == {1}, width
    # With less space, the others are counted, and only a single name is shortened.
    narrow = draw_timeline(timeline, View(Axis.TIME, 0.0, extent(timeline, Axis.TIME), 700.0))
    texts = [
        item.text
        for group in narrow.groups
        if group.role == "event"
        for item in group.items
        if isinstance(item, TextItem)
    ]
    assert any(text.endswith(", +1") or text == "+1" for text in texts)
    assert not any("…" in text and "," in text for text in texts)


@pytest.mark.parametrize("axis", list(Axis))
@pytest.mark.parametrize("path", [ROBOT, DELIVERY, CASE_STUDY], ids=lambda path: path.parent.name)
def test_no_arrow_is_on_the_name_of_a_state(path: Path, axis: Axis) -> None:
    session = api.session(api.load(str(path)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    arrows = 0
    for share, width in itertools.product((1.0, 0.3, 0.05), (500.0, 1600.0)):
        drawing = draw_timeline(timeline, View(axis, 0.0, extent(timeline, axis) * share, width))
        states = [group for group in drawing.groups if group.role == "state"]
        texts = [item.box for group in states for item in group.items if isinstance(item, TextItem)]
        for _, item in drawing.walk():
            if not isinstance(item, Polyline) or item.role != "message":
                continue
            (x, start), (right, end) = item.points
            arrows += 1
            assert x == right or axis is Axis.STEPS
            for text in texts if x == right else ():
                is_beside = text.bottom < min(start, end) or max(start, end) < text.y
                assert is_beside or not text.x - 4.5 < x < text.right + 4.5
    assert arrows


@pytest.mark.parametrize("axis", list(Axis))
@pytest.mark.parametrize("path", [ROBOT, DELIVERY, CASE_STUDY], ids=lambda path: path.parent.name)
def test_names_of_messages_overlap_no_name_and_no_mark(path: Path, axis: Axis) -> None:
    session = api.session(api.load(str(path)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    end = extent(timeline, axis)
    named = 0
    for start, stop, width in ((0.0, end, 700.0), (0.0, end / 3, 900.0), (end / 2, end * 1.2, 500.0)):
        drawing = draw_timeline(timeline, View(axis, start, stop, width))
        events = [group for group in drawing.groups if group.role == "event"]
        shapes = [item for group in events for item in group.items if isinstance(item, Shape)]
        marks = [shape.box for shape in shapes if shape.role == "pulse"]
        texts = [item for group in events for item in group.items if isinstance(item, TextItem)]
        named += len(texts)
        boxes = sorted((text.x, text.x + text_width(text.text, text.size)) for text in texts)
        for row in {text.y for text in texts}:
            own = sorted(text.box for text in texts if text.y == row)
            assert all(left.right <= right.x for left, right in itertools.pairwise(own))
        for left, right in boxes:
            assert 0.0 <= left <= right <= width
            assert not any(left < mark.x + mark.width / 2 < right for mark in marks)
    assert named


@pytest.mark.parametrize("width", [60.0, 120.0])
def test_messages_that_are_close_to_each_other_have_one_mark(width: float) -> None:
    session = api.session(api.load(str(DELIVERY)), seed=9)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    end = extent(timeline, Axis.TIME)
    drawing = draw_timeline(timeline, View(Axis.TIME, 0.0, end, width))
    groups = [group for group in drawing.groups if group.role == "event"]
    marks = [next(item.box for item in group.items if isinstance(item, Shape)) for group in groups]
    assert all(mark.right + 2.0 < following.x for mark, following in itertools.pairwise(marks))
    places = [timeline.times[message.received] / end * width for message in timeline.messages]
    marked = [sum(mark.x <= place <= mark.right for place in places) for mark in marks]
    assert sum(marked) == len(places)
    assert max(marked) > 1
    for group, count in zip(groups, marked, strict=True):
        if count > 1:
            assert group.hint.startswith(f"{count} messages from step ")
            assert group.step is None
        else:
            assert group.step is not None


@pytest.mark.parametrize("width", [180.0, 120.0])
@pytest.mark.parametrize("path", [ROBOT, DELIVERY], ids=lambda path: path.parent.name)
def test_the_ends_of_the_range_of_a_plot_are_beside_its_name_and_cross_no_line(path: Path, width: float) -> None:
    session = api.session(api.load(str(path)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    names = draw_names(timeline, width)
    by_hint = {group.hint: [item for item in group.items if isinstance(item, TextItem)] for group in names.groups}
    numbered = 0
    for plot in timeline.plots:
        name, *numbers = by_hint[plot.name]
        ends = ["true", "false"] if plot.is_flag else [f"{value:.6g}" for value in sorted({*plot.values}, reverse=True)]
        assert [number.text for number in numbers] == [*ends[:1], *ends[1:][-1:]]
        assert not any(name.box.overlaps(number.box) or number.box.right > width for number in numbers)
        assert [number.y for number in numbers] == sorted(number.y for number in numbers)
        numbered += len(numbers)
    assert numbered > 1
    rows = draw_timeline(timeline, View(Axis.STEPS, 0.0, float(timeline.count), 900.0))
    plots = [group for group in rows.groups if group.role == "variable"]
    assert len(plots) == len(timeline.plots)
    assert not any(isinstance(item, TextItem) for group in plots for item in group.items)


def _texts(drawing: Drawing) -> list[TextItem]:
    return [item for _, item in drawing.walk() if isinstance(item, TextItem)]


def test_only_the_visible_rows_are_drawn() -> None:
    session = api.session(api.load(str(ROBOT)), seed=3)
    session.until_decided()
    timeline = timeline_of(session)
    view = View(Axis.STEPS, 0.0, float(timeline.count), 900.0, top=86.0, bottom=96.0)
    states = [group for group in draw_timeline(timeline, view).groups if group.role == "state"]
    assert states
    assert len({group.hint.split(":")[0] for group in states}) == 2


def test_the_numbers_of_the_axis_cover_the_rows_that_are_scrolled_beneath_them() -> None:
    session = api.session(api.load(str(ROBOT)), seed=3)
    session.until_decided()
    timeline = timeline_of(session)
    groups = draw_timeline(timeline, View(Axis.STEPS, 0.0, float(timeline.count), 900.0, cursor=3)).groups
    assert groups[-1].role == "axis-names"
    assert any(group.role == "event" for group in groups)


def test_positions_lead_back_to_their_steps() -> None:
    session = api.session(api.load(str(ROBOT)), seed=3)
    session.until_decided()
    timeline = timeline_of(session)
    for step in range(timeline.count + 1):
        assert step_at(timeline, Axis.STEPS, position_of(timeline, Axis.STEPS, step)) == step
        later = step_at(timeline, Axis.TIME, position_of(timeline, Axis.TIME, step))
        assert timeline.times[later] == timeline.times[step]
    assert step_at(timeline, Axis.TIME, 1e9) == timeline.count


def test_simulate_writes_a_timeline(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "run.svg"
    assert run(["simulate", str(ROBOT), "--seed", "3", "--svg", str(file), "--theme", "dark"]) == 0
    assert capsys.readouterr().out == ""
    root = ET.fromstring(file.read_text(encoding="utf-8"))
    texts = [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {"Arm", "moving", "RUNNING", "Arm.way", "/arm/command", "0 s"} <= set(texts)


def test_a_coarse_drawing_has_one_area_for_each_color_of_a_row() -> None:
    """It has the same rectangles with the same colors, and the same texts."""
    session = api.session(api.load(str(DELIVERY)), seed=9)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    view = View(Axis.TIME, 0.0, extent(timeline, Axis.TIME), 400.0)
    fine, coarse = (draw_timeline(timeline, replace(view, is_coarse=coarse)) for coarse in (False, True))
    assert [text.text for text in _texts(coarse)] == [text.text for text in _texts(fine)]

    def rectangles(drawing: Drawing) -> list[tuple[str, str, Box]]:
        found = []
        for groups, item in drawing.walk():
            if isinstance(item, Shape):
                found.append((groups[0].tone.value, item.role.replace("span", "coarse"), item.box))
            elif isinstance(item, Area):
                for left, top, right, bottom in zip(*[iter(item.points)] * 4, strict=True):
                    assert (left.x, top.y, right.x, bottom.y) == (top.x, right.y, bottom.x, left.y)
                    box = Box(top.x, top.y, right.x - top.x, left.y - top.y)
                    found.append((groups[0].tone.value, item.role, box))
        return sorted(found)

    assert rectangles(coarse) == rectangles(fine)
    assert len(coarse.groups) < len(fine.groups)
    assert not any(len(group.items) == 1 and isinstance(group.items[0], Shape) for group in coarse.groups)


def test_in_a_view_a_group_of_one_rectangle_is_this_rectangle() -> None:
    group = Group("state", Tone.ROS, (Shape(Box(1, 2, 3, 4), Outline.RECTANGLE, "span"),), hint="A: on", step=7)
    drawing = Drawing(Extent(9, 9), (group,), {})
    rectangle = '<rect class="state tone-ros span" data-step="7" x="1" y="2" width="3" height="4" rx="2">'
    assert f"{rectangle}<title>A: on</title></rect>" in svg_scene(drawing)
    assert '<g class="state tone-ros" data-step="7"><title>A: on</title><rect' in svg_scene(drawing, has_keys=False)


@pytest.mark.parametrize("path", [ROBOT, DELIVERY], ids=lambda path: path.parent.name)
def test_messages_are_at_their_times_and_no_status_is_a_sliver(path: Path) -> None:
    session = api.session(api.load(str(path)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    end = extent(timeline, Axis.TIME)
    drawing = draw_timeline(timeline, View(Axis.TIME, 0.0, end, 960.0))
    times = {timeline.times[message.received] / end * 960.0 for message in timeline.messages}
    marks = [item.box for _, item in drawing.walk() if isinstance(item, Shape) and item.role == "pulse"]
    assert marks
    for mark in marks:
        assert any(abs(mark.x + 1.0 - x) < 0.01 for x in times)
    arrows = [item for _, item in drawing.walk() if isinstance(item, Polyline) and item.role == "message"]
    assert arrows
    for arrow in arrows:
        assert any(abs(arrow.points[-1].x - x) < 16.01 for x in times)
    bars = [item.box for _, item in drawing.walk() if isinstance(item, Shape) and item.role == "busy"]
    assert bars
    assert all(bar.width >= 3.0 and bar.right <= 960.01 for bar in bars)


@pytest.mark.parametrize("end", [1.5, 3.05, 8.0])
def test_arrows_of_messages_at_one_time_are_beside_each_other(end: float) -> None:
    """A request and its response have opposite arrows. At the right border and at the end of the run, they are moved to
    the left."""
    session = api.session(api.load(str(DELIVERY)), seed=3)
    session.until_decided(2_000)
    timeline = timeline_of(session)
    drawing = draw_timeline(timeline, View(Axis.TIME, 0.0, end, 960.0))
    arrows = []
    for group in drawing.groups:
        lines = [item.points for item in group.items if isinstance(item, Polyline) and item.role == "message"]
        if lines and 0.0 <= lines[0][0].x <= 960.0:
            ends = [point.y for line in lines for point in line]
            arrows.append((lines[0][0].x, min(ends), max(ends), {line[0].y < line[1].y for line in lines}))
    assert all(x <= extent(timeline, Axis.TIME) / end * 960.0 + 0.01 for x, *_ in arrows)
    directions = [down for *_, down in arrows]
    assert {True} in directions
    assert {False} in directions
    for (x, top, bottom, _), (other, upper, lower, _) in itertools.combinations(arrows, 2):
        assert abs(x - other) > 7.9 or bottom < upper or lower < top


def test_a_legend_explains_the_colors() -> None:
    session = api.session(api.load(str(DELIVERY)), seed=3)
    session.until_decided(2_000)
    drawing = draw_legend(timeline_of(session), 300.0)
    texts = _texts(drawing)
    assert [text.text for text in texts] == ["states, in order of entry", "IDLE", "RUNNING", "SUCCESS", "FAILURE"]
    assert all(text.box.right <= 300.0 and text.box.bottom <= drawing.size.height for text in texts)
    tones = [group.tone for group in drawing.groups if isinstance(group.items[0], Shape)]
    assert tones == [Tone.ROS, Tone.TREE, Tone.IDLE, Tone.RUNNING, Tone.SUCCESS, Tone.FAILURE]
    # The style sheet of pictures hides elements of the class `legend` that are empty, as rectangles are.
    assert "legend" not in svg_scene(drawing)
    # What has not occurred is not explained.
    start = draw_legend(timeline_of(api.session(api.load(str(DELIVERY)), seed=3)), 300.0)
    assert "FAILURE" not in [text.text for text in _texts(start)]
