# SPDX-License-Identifier: Apache-2.0
"""Drawings of our examples: geometry without errors, and golden pictures.

`AS2FM_GOLDEN=write` writes the golden pictures again; look at each of them before you commit it.
"""

from __future__ import annotations

import os
import random
from functools import cache
from pathlib import Path

import pytest
from drawing_check import problems
from ide_models import load

from roaml import api
from roaml.figures.drawing import Drawing, Group, Outline, Polyline, Shape, TextItem
from roaml.figures.geometry import Box, Point
from roaml.figures.layout import LayoutDirection
from roaml.figures.svg import svg_file
from roaml.ide.diagrams import OUTLINE_WIDTHS, DiagramKind, Picture, draw, draw_for, draw_outline, picture_of
from roaml.ide.diagrams.drawings.start import start_beside
from roaml.project.analysis import Analysis
from roaml.project.settings import Settings
from roaml.record import replace

EXAMPLES = Path(__file__).parents[2] / "examples"
GOLDEN = Path(__file__).parents[2] / "docs/pictures"
FOLDERS = ("assembly_robot", "case_study", "delivery_robot", "fetch_tree", "fleet", "grid_world", "warehouse")
PAGE = (1200, 900)


@cache
def analysis_of(folder: str) -> Analysis:
    return api.check([str(EXAMPLES / folder)], settings=Settings()).snapshot.analysis


@pytest.mark.parametrize("folder", FOLDERS)
def test_examples(folder: str) -> None:
    analysis = analysis_of(folder)
    shown = 0
    for path in sorted((EXAMPLES / folder).rglob("*xml")):
        for kind in DiagramKind:
            picture = picture_of(kind, analysis, str(path))
            for direction in LayoutDirection if picture else ():
                assert picture is not None
                assert problems(picture, draw(kind, picture, direction)) == [], (path, kind, direction)
                shown += 1
            if picture is not None and kind is DiagramKind.TREE:
                for width in OUTLINE_WIDTHS:
                    assert problems(picture, draw_outline(picture, width)) == [], path
    assert shown > 0


GOLDEN_PICTURES = {
    "arm": (DiagramKind.MACHINE, "assembly_robot/arm.ascxml"),
    "move_to_goal": (DiagramKind.MACHINE, "assembly_robot/plugins/move_to_goal.ascxml"),
    "assembly_tree": (DiagramKind.TREE, "assembly_robot/tree.xml"),
    "assembly_graph": (DiagramKind.ROS, "assembly_robot/main.xml"),
    "mover": (DiagramKind.MACHINE, "case_study/nodes/mover.ascxml"),
    "recover_block": (DiagramKind.MACHINE, "case_study/plugins/recover_block.ascxml"),
    "case_study_graph": (DiagramKind.ROS, "case_study/main.xml"),
    "battery": (DiagramKind.MACHINE, "delivery_robot/nodes/battery.ascxml"),
    "fetch_tree": (DiagramKind.TREE, "fetch_tree/fetch.xml"),
    "fleet_graph": (DiagramKind.ROS, "fleet/main.xml"),
    "warehouse_graph": (DiagramKind.ROS, "warehouse/main.xml"),
    "grid_robot": (DiagramKind.MACHINE, "grid_world/robot.ascxml"),
}


@pytest.mark.parametrize("name", GOLDEN_PICTURES)
def test_golden_pictures(name: str) -> None:
    kind, file = GOLDEN_PICTURES[name]
    picture = picture_of(kind, analysis_of(file.partition("/")[0]), str(EXAMPLES / file))
    assert picture is not None
    compare_golden(name, svg_file(draw_for(kind, picture, *PAGE), picture.title))


def test_golden_outline() -> None:
    picture = picture_of(DiagramKind.TREE, analysis_of("fetch_tree"), str(EXAMPLES / "fetch_tree/fetch.xml"))
    assert picture is not None
    drawing = draw_outline(picture)
    assert drawing.size.width < 400
    wide = draw_outline(picture, OUTLINE_WIDTHS[1])
    assert problems(picture, wide) == []
    assert wide.size.width < 900
    assert wide.size.height < 0.8 * drawing.size.height
    compare_golden("fetch_outline", svg_file(drawing, picture.title))


def compare_golden(name: str, svg: str) -> None:
    golden = GOLDEN / f"{name}.svg"
    if os.environ.get("AS2FM_GOLDEN") == "write":
        golden.write_text(svg, encoding="utf-8")
    assert svg == golden.read_text(encoding="utf-8")


MACHINE = """\
<ascxml name="Robot" version="1.0" initial="idle">
  <ros_topic_subscriber name="go" topic="/go" type="std_msgs/Bool"/>
  <ros_action_server name="walk" action_name="/walk" type="example_interfaces/Fibonacci"/>
  <state id="idle">
    <onentry><assign location="x" expr="1"/></onentry>
    <ros_topic_callback name="go" cond="_msg.data" target="busy"/>
    <transition event="stop" target="idle"/>
    <transition event="log"/>
    <transition event="roll">
      <target id="idle" prob="0.25"><send event="again"/></target><target id="idle"/>
    </transition>
  </state>
  <state id="busy">
    <transition event="toss"><target id="idle" prob="0.25"/><target id="busy"/><target id="done"/></transition>
    <transition event="back" target="idle"><assign location="x" expr="2"/></transition>
    <transition event="undo" cond="x &gt; 1" target="idle"/>
    <transition target="done"/>
  </state>
  <state id="done"/>
  <ros_action_thread name="walk" n_threads="3">
    <state id="idle"><transition event="a" target="idle"/><transition event="b" target="idle"/></state>
  </ros_action_thread>
</ascxml>
"""


def machine(tmp_path: Path, text: str = MACHINE) -> tuple[Picture, Drawing]:
    analysis = load(tmp_path, {"robot.ascxml": text})
    picture = picture_of(DiagramKind.MACHINE, analysis, str(tmp_path / "robot.ascxml"))
    assert picture is not None
    return picture, draw(DiagramKind.MACHINE, picture, LayoutDirection.DOWN)


def texts(group: Group) -> list[str]:
    inner = [
        texts(item) if isinstance(item, Group) else [item.text]
        for item in group.items
        if isinstance(item, (Group, TextItem))
    ]
    return [text for part in inner for text in part]


def test_a_state_is_a_card_with_its_reactions(tmp_path: Path) -> None:
    picture, drawing = machine(tmp_path)
    assert problems(picture, drawing) == []
    cards = {group.node: texts(group) for group in drawing.groups if group.node is not None}
    idle = ["idle", "entry / x := 1", "↻ stop", "log", "roll", "0.25", "/ send again", "otherwise"]
    assert cards[0] == idle
    busy = next(index for index, node in enumerate(picture.nodes) if node.label == "busy")
    assert cards[busy] == ["busy"]
    thread = next(index for index, node in enumerate(picture.nodes) if node.kind.value == "thread")
    assert cards[thread] == ["walk (3 threads)"]


def test_transitions_between_two_states_share_a_line_and_a_label(tmp_path: Path) -> None:
    _, drawing = machine(tmp_path)
    labels = [texts(group) for group in drawing.groups if group.role == "label"]
    assert ["back", "/ x := 2", "undo", "[x > 1]"] in labels
    assert ["/go", "[_msg.data]"] in labels
    together = [group.edges for group in drawing.groups if group.role == "link" and len(group.edges) == 2]
    assert len(together) == 1


def test_a_choice_is_a_junction_with_probabilities(tmp_path: Path) -> None:
    picture, drawing = machine(tmp_path)
    choices = [index for index, node in enumerate(picture.nodes) if node.kind.value == "choice"]
    assert [index in drawing.nodes for index in choices] == [False, True]
    drawn = next(group for group in drawing.groups if group.node == choices[1])
    assert [type(item).__name__ for item in drawn.items] == ["Shape", "Glyph"]
    labels = [texts(group) for group in drawing.groups if group.role == "label"]
    assert sorted(label[0] for label in labels if label[0] in ("0.25", "otherwise")) == [
        "0.25",
        "otherwise",
        "otherwise",
    ]


def test_long_lines_of_a_large_machine_end_at_labels_that_name_their_targets(tmp_path: Path) -> None:
    chance = random.Random(1)
    states = []
    for number in range(60):
        following = [n for n in range(number + 1, min(60, number + 4)) if chance.random() < 0.7 or n == number + 1]
        targets = [*following, chance.randrange(60)]
        rows = [f'<transition event="e{n}" target="s{target}"/>' for n, target in enumerate(targets)]
        states.append(f'<state id="s{number}">{"".join(rows)}</state>')
    picture, drawing = machine(tmp_path, f'<ascxml name="Robot" version="1.0" initial="s0">{"".join(states)}</ascxml>')
    assert problems(picture, drawing) == []
    cards = {picture.nodes[group.node].label: texts(group) for group in drawing.groups if group.node is not None}
    named = [group for group in drawing.groups if group.role == "label" and texts(group)[-1].startswith("→ ")]
    assert len(named) > 10
    for group in named:
        (edge,) = {index for item in group.items if isinstance(item, Group) for index in item.edges}
        source, target = (end.removeprefix("/") for end in (picture.edges[edge].source, picture.edges[edge].target))
        assert texts(group) == [*picture.edges[edge].labels, f"→ {target}"]
        assert source in " ".join(cards[target][1:]).removeprefix("from ").split(", ")


def test_typing_keeps_the_arrangement(tmp_path: Path) -> None:
    """A longer condition moves states by less than its additional length, and does not rearrange them."""
    before = machine(tmp_path)[1].nodes
    after = machine(tmp_path, MACHINE.replace("x &gt; 1", "x &gt; 1 &amp;&amp; y &lt; 2"))[1].nodes
    for a, b in [(a, b) for a in before for b in before]:
        assert (before[a].y < before[b].y) == (after[a].y < after[b].y)


def test_flaws_are_found(tmp_path: Path) -> None:
    """The check of geometry finds a label on a node, a line through a label, equal rows, and small text."""
    picture, drawing = machine(tmp_path)
    label = next(group for group in drawing.groups if group.role == "label")
    row = next(item for item in label.items if isinstance(item, Group))
    text = next(item for item in row.items if isinstance(item, TextItem))
    line = Group("link", label.tone, (Polyline((Point(0, text.y), Point(drawing.size.width, text.y))),))
    twice = replace(label, items=(*label.items, row))
    small = replace(label, items=(replace(text, size=8.0),))
    for group, word in (
        (line, "a line crosses"),
        (twice, "two texts overlap"),
        (small, "small text"),
        (label, "two shapes"),
    ):
        flawed = replace(drawing, groups=(*drawing.groups, group))
        assert any(problem.startswith(word) for problem in problems(picture, flawed)), word
    lines = [group for group in drawing.groups if group.role != "link"]
    missing = [problem for problem in problems(picture, replace(drawing, groups=tuple(lines))) if "no line" in problem]
    assert len(missing) == sum(edge.source != edge.target for edge in picture.edges) - 3  # a choice is in its state


def test_a_card_of_a_large_tree_shows_few_constants(tmp_path: Path) -> None:
    """The hover shows the others; a small tree shows all."""
    ports = 'a="1" b="2" c="3" d="{e}"'
    for count, expected in ((3, ["a = 1", "b = 2", "c = 3", "d = {e}"]), (60, ["a = 1", "d = {e}", "… 2 more"])):
        leaves = f'<Action ID="Go" {ports}/>' * count
        text = f'<root BTCPP_format="4"><BehaviorTree ID="T"><Sequence>{leaves}</Sequence></BehaviorTree></root>'
        (tmp_path / f"tree{count}.xml").write_text(text)
        analysis = api.check([str(tmp_path)], settings=Settings()).snapshot.analysis
        picture = picture_of(DiagramKind.TREE, analysis, str(tmp_path / f"tree{count}.xml"))
        assert picture is not None
        drawing = draw(DiagramKind.TREE, picture, LayoutDirection.DOWN)
        assert problems(picture, drawing) == []
        items = [
            (groups, item) for groups, item in drawing.walk() if groups[0].node == 1 and isinstance(item, TextItem)
        ]
        assert [item.text for _, item in items][2:] == expected
        hints = {group.hint for groups, _ in items for group in groups}
        assert ("b = 2\nc = 3" in hints) == (count == 60)


def test_constants_that_few_nodes_have_are_shown_first(tmp_path: Path) -> None:
    leaves = "".join(f'<Action ID="Go" a="same" b="also the same" goal="goal {n}"/>' for n in range(60))
    text = f'<root BTCPP_format="4"><BehaviorTree ID="T"><Sequence>{leaves}</Sequence></BehaviorTree></root>'
    (tmp_path / "tree.xml").write_text(text)
    analysis = api.check([str(tmp_path)], settings=Settings()).snapshot.analysis
    picture = picture_of(DiagramKind.TREE, analysis, str(tmp_path / "tree.xml"))
    assert picture is not None
    for drawing in (draw(DiagramKind.TREE, picture, LayoutDirection.DOWN), draw_outline(picture)):
        assert problems(picture, drawing) == []
        shown = next(texts(group) for group in drawing.groups if group.node == 5)
        assert next(text for text in shown if " = " in text) == "goal = goal 4"


def test_states_that_no_transition_leaves_have_a_double_border(tmp_path: Path) -> None:
    text = '<ascxml name="Robot" version="1.0" initial="a"><state id="a"><transition event="e" target="b"/></state>'
    picture, drawing = machine(tmp_path, f'{text}<state id="b"/></ascxml>')
    outlines = {
        picture.nodes[group.node].label: item.outline
        for group in drawing.groups
        for item in group.items
        if group.node is not None and isinstance(item, Shape) and item.role == "card"
    }
    assert outlines == {"a": Outline.ROUNDED, "b": Outline.DOUBLE}


STAR = """\
<ascxml name="Robot" version="1.0" initial="hub">
    <state id="hub">
{transitions}
    </state>
{states}
</ascxml>
"""


@pytest.mark.parametrize("direction", LayoutDirection)
def test_the_dot_is_beside_the_initial_state(tmp_path: Path, direction: LayoutDirection) -> None:
    names = [f"state{number}" for number in range(20)]
    text = STAR.format(
        transitions="\n".join(f'<transition event="{name}" target="{name}"/>' for name in names),
        states="\n".join(f'<state id="{name}"/>' for name in names),
    )
    picture, _ = machine(tmp_path, text)
    drawing = draw(DiagramKind.MACHINE, picture, direction)
    start = next(group for group in drawing.groups if group.role == "start")
    line, dot = start.items
    assert isinstance(line, Polyline)
    assert isinstance(dot, Shape)
    (begin, end), hub = line.points, drawing.nodes[0]
    assert abs(begin.x - end.x) + abs(begin.y - end.y) < 40
    assert hub.grown(1).contains(Box(end.x, end.y, 0, 0))
    labels = [
        item.box for group in drawing.groups for item in group.items if isinstance(item, Shape) and item is not dot
    ]
    assert not any(box.overlaps(dot.box.grown(10)) for box in labels)


def test_no_dot_covers_anything() -> None:
    state = Box(100, 100, 60, 30)
    found = start_beside(state, [Box(110, 40, 40, 30)], LayoutDirection.DOWN)
    assert found is not None
    dot, route = found
    assert dot.right < state.x  # above the state is no space
    assert route.parts[0][-1] == Point(100, 115)
    assert start_beside(state, [Box(0, 0, 300, 300)], LayoutDirection.DOWN) is None
