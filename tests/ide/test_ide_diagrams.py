# SPDX-License-Identifier: Apache-2.0
"""Pictures of machines, trees and systems, with the places of their parts in the text."""

from __future__ import annotations

import itertools
import random
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from drawing_check import problems
from ide_models import CORNERS, ROBOT, load, system_file

from fixture import split_files
from roaml.figures.drawing import TextItem
from roaml.figures.geometry import Box, Point
from roaml.figures.layout import LayoutDirection, Route
from roaml.ide.diagrams import (
    Detail,
    DetailKind,
    DiagramEdge,
    DiagramKind,
    DiagramNode,
    DiagramNodeKind,
    EdgeKind,
    Picture,
    around,
    collapsed,
    draw,
    machine_picture,
    matching,
    ros_picture,
    system_picture,
    tree_picture,
    with_provided_interfaces,
)
from roaml.ide.diagrams.drawings.line_names import LineNames
from roaml.ide.picture_edits import PictureAction
from roaml.mocks.mock import read_mock
from roaml.project.analysis import Analysis
from roaml.text import Location

CONTRACT = Path(__file__).parents[2] / "vscode-extension/src/pictures/contract.ts"

MACHINE = """\
<ascxml name="Robot" version="1.0" initial="idle">
  <ros_topic_subscriber name="go" topic="/go" type="std_msgs/Bool"/>
  <ros_action_server name="walk" action_name="/walk" type="example_interfaces/Fibonacci"/>
  <state id="idle">
    <ros_topic_callback name="go" cond="_msg.data
        &amp;&amp; true" target="busy"/>
    <transition event="stop" target="idle"/>
    <transition event="log"/>
    <transition event="gone" target="nowhere"/>
  </state>
  <state id="busy">
    <transition><target id="idle" prob="0.25"/><target id="busy"/></transition>
    <bt_tick target="idle"/>
  </state>
  <state id="idle"><transition event="twice" target="busy"/></state>
  <state><transition event="x" target="busy"/></state>
  <ros_action_thread name="walk" n_threads="3">
    <state id="idle"><transition target="idle"/></state>
  </ros_action_thread>
</ascxml>
"""


def test_transitions_with_the_same_trigger_have_their_order(tmp_path: Path) -> None:
    """`[else]` is the last of several transitions, if only it has no condition; two need no numbers then."""
    for transitions, orders in (
        ('<transition event="a" cond="x"/><transition event="b"/>', ["", ""]),
        ('<transition event="a" cond="x"/><transition event="a"/>', ["", "[else]"]),
        ('<transition cond="x"/><transition event="a"/><transition/>', ["", "", "[else]"]),
        ('<transition event="a" cond="x"/><transition event="a" cond="!x"/>', ["1.", "2."]),
        ('<transition cond="x"/><transition cond="!x"/><transition/>', ["1.", "2.", "3. [else]"]),
    ):
        text = f'<ascxml name="M" version="1.0" initial="s"><state id="s">{transitions}</state></ascxml>'
        picture = machine_picture(load(tmp_path, {"m.ascxml": text}), str(tmp_path / "m.ascxml"))
        assert picture is not None
        assert [edge.order for edge in picture.edges] == orders
        drawing = draw(DiagramKind.MACHINE, picture, LayoutDirection.DOWN)
        texts = {item.text for _, item in drawing.walk() if isinstance(item, TextItem)}
        assert {order for order in orders if "else" in order} <= texts


def shown(picture: Picture | None) -> list[str]:
    return [] if picture is None else [*_nodes(picture), *_edges(picture)]


def texts_of(node: DiagramNode) -> list[str]:
    return [detail.text for detail in node.details]


def _nodes(picture: Picture) -> Iterator[str]:
    for node in picture.nodes:
        parts = (node.kind.value, node.label, *texts_of(node), f"in {node.parent}" if node.parent else "")
        yield " | ".join(filter(None, (*parts, "initial" if node.initial else "")))


def _edges(picture: Picture) -> Iterator[str]:
    labels = {node.id: f"{node.parent}/{node.label}" if node.parent else node.label for node in picture.nodes}
    labels |= {node.id: "?" for node in picture.nodes if node.kind is DiagramNodeKind.CHOICE}
    for edge in picture.edges:
        way = f"{labels[edge.source]} -> {labels[edge.target]}"
        marks = [word for word, is_so in (("by chance", edge.probabilistic), ("internal", edge.internal)) if is_so]
        yield " | ".join((way, edge.kind.value, *edge.labels, *(f"/ {action}" for action in edge.actions), *marks))


def text_at(analysis: Analysis, place: Location | None) -> str:
    source = analysis.source(place.path) if place else None
    return "" if source is None or place is None else source.text[place.span.start : place.span.end]


def test_machine(tmp_path: Path) -> None:
    analysis = load(tmp_path, {"robot.ascxml": MACHINE})
    picture = machine_picture(analysis, str(tmp_path / "robot.ascxml"))
    assert picture is not None
    assert picture.title == "Robot"
    thread = picture.nodes[3].id
    assert shown(picture) == [
        "state | idle | initial",
        "state | busy",
        "choice",
        "thread | walk | 3 threads",
        f"state | idle | in {thread}",
        "idle -> busy | ros | /go | [_msg.data && true]",
        "idle -> idle | event | stop",
        "idle -> idle | event | log | internal",
        "busy -> ? | eventless",
        "? -> idle | eventless | 0.25 | by chance",
        "? -> busy | eventless | otherwise | by chance",
        "busy -> idle | bt | tick",
        f"{thread}/idle -> {thread}/idle | eventless",
    ]
    places = [text_at(analysis, part.place) for part in (*picture.nodes, *picture.edges)]
    starts = ["<state", "<state", "<transition><target", "<ros_action_thread", "<state"]
    assert [place.split()[0] for place in places[:5]] == starts
    assert places[5].startswith('<ros_topic_callback name="go"')
    assert places[9] == '<target id="idle" prob="0.25"/>'


def test_tree(tmp_path: Path) -> None:
    analysis = load(tmp_path, split_files(ROBOT))
    for file in ("main.xml", "tree.xml", "plugin.ascxml"):
        picture = tree_picture(analysis, str(tmp_path / file))
        assert picture is not None
        assert picture.title == "tree.xml"
        assert shown(picture) == [
            "control | Sequence | initial",
            "action | Walk | goal = {g} | out = {g} | topic =  /a/b ",
            "subtree | Sub | t = /c | g = {g} | _autoremap",
            "action | w : Walk | goal = {g} | out = {Sub__own} | topic = /c",
            "variable | g",
            "variable | Sub__own",
            "Sequence -> Walk | child",
            "Sequence -> Sub | child",
            "Sub -> w : Walk | child",
            "g -> Walk | reads | goal",
            "Walk -> g | writes | out",
            "g -> w : Walk | reads | goal",
            "w : Walk -> Sub__own | writes | out",
        ]
        assert text_at(analysis, picture.nodes[1].place).startswith('<Walk goal="{g}"')
        assert text_at(analysis, picture.nodes[2].place).startswith('<BehaviorTree ID="Sub"')
        assert text_at(analysis, picture.nodes[3].place).startswith('<Action ID="Walk"')
        assert text_at(analysis, picture.nodes[4].place) == 'goal="{g}"'


def test_tree_alone(tmp_path: Path) -> None:
    """A tree that no system lists is drawn as far as it is known."""
    tree = """\
<root BTCPP_format="4"><BehaviorTree ID="T"><Inverter><Fallback>
  <Condition ID="Full" level="{level}"/><Fill to="{level}"/><Loop><Wait/></Loop>
</Fallback></Inverter></BehaviorTree><TreeNodesModel><Condition ID="Wait"/></TreeNodesModel></root>
"""
    analysis = load(tmp_path, {"tree.xml": tree})
    assert shown(tree_picture(analysis, str(tmp_path / "tree.xml"))) == [
        "decorator | Inverter | initial",
        "control | Fallback",
        "condition | Full | level = {level}",
        "action | Fill | to = {level}",
        "decorator | Loop",
        "condition | Wait",
        "variable | level",
        "Inverter -> Fallback | child",
        "Fallback -> Full | child",
        "Fallback -> Fill | child",
        "Fallback -> Loop | child",
        "Loop -> Wait | child",
        "level -> Full | reads | level",
        "level -> Fill | reads | to",
    ]


def test_of_several_trees_without_a_main_one_the_first_is_drawn(tmp_path: Path) -> None:
    trees = "".join(f'<BehaviorTree ID="{name}"><{name}Node/></BehaviorTree>' for name in ("Pick", "Place"))
    analysis = load(tmp_path, {"library.xml": f'<root BTCPP_format="4">{trees}</root>'})
    assert shown(tree_picture(analysis, str(tmp_path / "library.xml"))) == ["action | PickNode | initial"]


def test_conditions_and_what_subtrees_are_given(tmp_path: Path) -> None:
    tree = """<root BTCPP_format="4" main_tree_to_execute="M"><BehaviorTree ID="M"><Sequence _post="n += 1">
        <SubTree ID="S" name="one" box="{=}" at="{place}" force="3" _skipIf="n &gt; 1"/><SubTree ID="S"/>
        </Sequence></BehaviorTree><BehaviorTree ID="S"><Grasp _while="true" at="{at}"/></BehaviorTree></root>"""
    picture = tree_picture(load(tmp_path, {"tree.xml": tree}), str(tmp_path / "tree.xml"))
    assert picture is not None
    assert [" | ".join((node.label, *texts_of(node))) for node in picture.nodes if node.id[0] != "{"] == [
        "Sequence | _post = n += 1",
        "one : S | box = {box} | at = {place} | force = 3 | _skipIf = n > 1",
        "Grasp | _while = true | at = {place}",
        "S",
        "Grasp | _while = true | at = {S__at}",
    ]


MOCKED = """<root BTCPP_format="4" main_tree_to_execute="M"><BehaviorTree ID="M"><Sequence>
    <DistanceController distance="1.0"><PlannerSelector selected_planner="{p}" default_planner="G" topic_name="t"/>
    </DistanceController><RateController hz="1.0"><Sleep msec="10"/></RateController>
    <FollowPath path="{path}"/><IsStuck/><SubTree ID="S"/></Sequence></BehaviorTree>
    <BehaviorTree ID="S"><Fallback><Own name="mine"/><Condition ID="Seen"/></Fallback></BehaviorTree></root>"""
MOCKS = """
*: 0.95 in 1500 ms  # all others
mine: 0.5 in 250 ms
Distance*: 0.25
"""


def mocks_shown(picture: Picture | None) -> dict[str, str]:
    assert picture is not None
    details = ((node.label, detail) for node in picture.nodes for detail in node.details)
    return {label: detail.text for label, detail in details if detail.kind is DetailKind.MOCK}


def test_mocks_of_leaves(tmp_path: Path) -> None:
    """Nodes of BehaviorTree.CPP need none; a selector of Nav2 succeeds; `*` does not apply to events of the world."""
    analysis = load(tmp_path, {"tree.xml": MOCKED, "tree.mocks": MOCKS})
    path = str(tmp_path / "tree.xml")
    assert mocks_shown(tree_picture(analysis, path)) == {
        "DistanceController": "mock: event 0.25",
        "PlannerSelector": "mock: 1",
        "FollowPath": "mock: 0.95 in 1.5 s",
        "IsStuck": "mock: 0.95",
        "mine : Own": "mock: 0.5 in 250 ms",
        "Seen": "mock: 0.95",
    }
    assert mocks_shown(tree_picture(analysis, path, ())) == {}
    assert mocks_shown(tree_picture(analysis, path, (read_mock("mine: 1"),))) == {
        "mine : Own": "mock: 1",
        "PlannerSelector": "mock: 1",
    }


def test_mocks_of_nodes_with_children(tmp_path: Path) -> None:
    """They are shown for nodes that no library describes."""
    tree = """<root BTCPP_format="4"><BehaviorTree ID="M"><Lock name="a"><Sequence>
        <Again><Pick/></Again><Pick/></Sequence></Lock></BehaviorTree></root>"""
    mocks = "*: 0.5\nLock: as Inverter\n*: as Sequence\nAgain: as Repeat(num_cycles=3)\nPick: as Fallback\n"
    analysis = load(tmp_path, {"tree.xml": tree, "tree.mocks": mocks})
    picture = tree_picture(analysis, str(tmp_path / "tree.xml"))
    assert mocks_shown(picture) == {
        "a : Lock": "mock: as Inverter",
        "Again": "mock: as Repeat(num_cycles=3)",
        "Pick": "mock: 0.5",
    }


def test_a_file_of_mocks_that_is_not_valid_is_not_shown(tmp_path: Path) -> None:
    analysis = load(tmp_path, {"tree.xml": MOCKED, "tree.mocks": "FollowPath 0.5"})
    assert mocks_shown(tree_picture(analysis, str(tmp_path / "tree.xml"))) == {}


def test_mocks_of_leaves_of_a_system(tmp_path: Path) -> None:
    """Leaves with a plugin have no mock."""
    files = split_files(ROBOT)
    files["tree.xml"] = files["tree.xml"].replace("</Sequence>", '<Look name="twice"/></Sequence>', 1)
    analysis = load(tmp_path, files)
    mocks = (read_mock("*: 0.9 in 1 s"),)
    main = str(tmp_path / "main.xml")
    assert mocks_shown(tree_picture(analysis, main)) == {}
    assert mocks_shown(tree_picture(analysis, main, mocks)) == {"twice : Look": "mock: 0.9 in 1 s"}


def test_collapsed_nodes(tmp_path: Path) -> None:
    """The nodes below, and entries that only these use, are left out."""
    tree = """<root BTCPP_format="4" main_tree_to_execute="M"><BehaviorTree ID="M"><Sequence>
        <Fallback><Inverter><Look at="{own}"/></Inverter><Go to="{place}"/></Fallback>
        <SubTree ID="S"/><Stay at="{place}"/></Sequence></BehaviorTree>
        <BehaviorTree ID="S"><Grasp/></BehaviorTree></root>"""
    picture = tree_picture(load(tmp_path, {"tree.xml": tree}), str(tmp_path / "tree.xml"))
    assert picture is not None
    ids = {node.label: node.id for node in picture.nodes}

    def lines(*labels: str) -> list[str]:
        return list(shown(collapsed(picture, [ids.get(label, label) for label in labels])))

    assert lines() == lines("Stay", "unknown") == shown(picture)
    assert lines("Fallback", "Inverter", "S") == [
        "control | Sequence | initial",
        "control | Fallback | … 3 nodes",
        "subtree | S | … 1 node",
        "action | Stay | at = {place}",
        "variable | place",
        "Sequence -> Fallback | child",
        "Sequence -> S | child",
        "Sequence -> Stay | child",
        "place -> Stay | reads | at",
    ]


def test_kinds_of_nodes_in_a_tree_alone(tmp_path: Path) -> None:
    """Libraries and models declare them; an unknown node with one child is a decorator."""
    tree = """<root BTCPP_format="4"><BehaviorTree ID="M"><Sequence>
        <RateController hz="1.0"><ComputePathToPose goal="{goal}" path="{path}"/></RateController>
        <RecoveryNode number_of_retries="2"><IsStuck/><Wait wait_duration="1"/></RecoveryNode>
        <Inverter><Seen/></Inverter><Mine><Yours/></Mine><Both><Yours/><Yours/></Both>
        </Sequence></BehaviorTree><TreeNodesModel><Condition ID="Seen"/></TreeNodesModel></root>"""
    picture = tree_picture(load(tmp_path, {"tree.xml": tree}), str(tmp_path / "tree.xml"))
    assert picture is not None
    kinds = {node.label: node.kind.value for node in picture.nodes}
    assert kinds == kinds | {
        "RateController": "decorator",
        "RecoveryNode": "control",
        "IsStuck": "condition",
        "Inverter": "decorator",
        "Seen": "condition",
        "Mine": "decorator",
        "Both": "control",
        "Yours": "action",
    }


def robot_with(machine: str) -> dict[str, str]:
    """The robot with a second machine."""
    files = split_files(ROBOT) | {"b.ascxml": machine}
    files["main.xml"] = system_file(
        "behavior_tree bt.cpp-xml tree.xml",
        "behavior_tree bt-plugin-ascxml plugin.ascxml",
        "node_models node-ascxml a.ascxml",
        "node_models node-ascxml b.ascxml",
        "data_declarations xml types.xml",
    )
    return files


def test_ros(tmp_path: Path) -> None:
    files = robot_with("""\
<ascxml name="B" version="1.0" initial="s">
  <ros_service_client name="ask" service_name="/ask" type="std_srvs/Trigger"/>
  <ros_action_server name="act" action_name="/act" type="example_interfaces/Fibonacci"/>
  <state id="s"><transition event="go" target="s"/></state>
</ascxml>
""")
    analysis = load(tmp_path, files)
    picture = ros_picture(analysis, str(tmp_path / "main.xml"))
    assert shown(picture) == [
        "node | A",
        "node | B",
        "plugin | Walk",
        "topic | /a/b | std_msgs/Int32",
        "topic | /c | std_msgs/Int32",
        "service | /ask | std_srvs/Trigger",
        "action-interface | /act | example_interfaces/Fibonacci",
        "Walk -> /a/b | publishes",
        "/a/b -> A | subscribes",
        "Walk -> /c | publishes",
        "B -> /ask | calls",
        "/act -> B | serves",
        "A -> B | sends | go",
    ]
    assert picture is not None
    assert text_at(analysis, picture.nodes[3].place).startswith('<ros_topic_publisher name="pub"')
    assert ros_picture(analysis, str(tmp_path / "a.ascxml")) is None


def test_copies_of_a_machine_are_one_frame_with_their_number(tmp_path: Path) -> None:
    def frames(copies: int) -> list[str]:
        files = robot_with('<ascxml name="B" initial="s"><state id="s"/></ascxml>')
        listed = "".join(f'<input type="node-ascxml" src="b.ascxml" name="b{n}"/>' for n in range(copies))
        files["main.xml"] = re.sub(r'<input type="node-ascxml" src="b.ascxml" ?/>', listed, files["main.xml"])
        folder = tmp_path / str(copies)
        picture = system_picture(load(folder, files), str(folder / "main.xml"))
        return [shown for shown in _nodes(picture) if shown.startswith("machine")] if picture else []

    assert frames(1)[:2] == ["machine | A", "machine | B"]
    assert frames(2)[1] == "machine | B | 2 nodes: b0, b1"
    assert frames(7)[1] == "machine | B | 7 nodes: b0, b1, b2, b3, b4, and 2 more"


def test_a_part_of_a_ros_graph(tmp_path: Path) -> None:
    files = robot_with("""\
<ascxml name="B" version="1.0" initial="s">
  <ros_service_client name="ask" service_name="/ask" type="std_srvs/Trigger"/>
  <ros_topic_subscriber name="c" topic="/c" type="std_msgs/Int32"/>
  <state id="s"/>
</ascxml>
""")
    picture = ros_picture(load(tmp_path, files), str(tmp_path / "main.xml"))
    assert picture is not None
    ids = {node.label: node.id for node in picture.nodes}
    # A node is shown with those with which it communicates, an interface with its nodes.
    assert list(_nodes(around(picture, ids["B"]))) == [
        "node | B",
        "plugin | Walk",
        "topic | /c | std_msgs/Int32",
        "service | /ask | std_srvs/Trigger",
    ]
    assert shown(around(picture, ids["/a/b"])) == [
        "node | A",
        "plugin | Walk",
        "topic | /a/b | std_msgs/Int32",
        "Walk -> /a/b | publishes",
        "/a/b -> A | subscribes",
    ]
    assert around(picture, "gone") == picture
    # The words are searched in kind, name with namespace, and type.
    assert shown(matching(picture, "TOPIC /a/")) == shown(around(picture, ids["/a/b"]))
    assert list(_nodes(matching(picture, "trigger"))) == ["node | B", "service | /ask | std_srvs/Trigger"]
    assert matching(picture, " ") == picture
    assert matching(picture, "nothing").nodes == ()


NAMESPACES = {
    "drive.ascxml": """\
<ascxml name="Drive" version="1.0" initial="s">
  <ros_topic_publisher name="at" topic="at" type="std_msgs/Int32"/>
  <ros_topic_subscriber name="stop" topic="/fleet/stop" type="std_msgs/Bool"/>
  <ros_topic_subscriber name="go" topic="/go" type="std_msgs/Bool"/>
  <state id="s"/>
</ascxml>
""",
    "chief.ascxml": """\
<ascxml name="Chief" version="1.0" initial="s">
  <ros_topic_publisher name="go" topic="/go" type="std_msgs/Bool"/>
  <ros_topic_subscriber name="at" topic="/fleet/a/at" type="std_msgs/Int32"/>
  <state id="s"/>
</ascxml>
""",
    "main.xml": """\
<roaml>
  <parameters><max_time value="5" unit="s"/></parameters>
  <node_models>
    <input type="node-ascxml" src="drive.ascxml" name="a" namespace="fleet/a"/>
    <input type="node-ascxml" src="drive.ascxml" name="b" namespace="/fleet/b"/>
    <input type="node-ascxml" src="drive.ascxml" name="c"/>
    <input type="node-ascxml" src="chief.ascxml"/>
  </node_models>
</roaml>
""",
}


def namespace_graph(folder: Path) -> Picture:
    picture = ros_picture(load(folder, NAMESPACES), str(folder / "main.xml"))
    assert picture is not None
    return picture


def within(picture: Picture) -> dict[str, str]:
    """The label of each node that is in a namespace -> the label of the namespace."""
    labels = {node.id: node.label for node in picture.nodes}
    return {node.label: labels[node.parent] for node in picture.nodes if node.parent}


def test_namespaces(tmp_path: Path) -> None:
    """Those of nodes, and those that they have in common; topics are in those that their names contain."""
    picture = namespace_graph(tmp_path)
    spaces = [node.label for node in picture.nodes if node.kind is DiagramNodeKind.NAMESPACE]
    assert spaces == ["/fleet", "/fleet/a", "/fleet/b"]
    assert within(picture) == {
        "/fleet/a": "/fleet",
        "/fleet/b": "/fleet",
        "a": "/fleet/a",
        "b": "/fleet/b",
        "/fleet/a/at": "/fleet/a",
        "/fleet/b/at": "/fleet/b",
        "/fleet/stop": "/fleet",
    }


def test_a_graph_without_namespaces_has_none(tmp_path: Path) -> None:
    """Also if names of topics have several parts."""
    files = robot_with('<ascxml name="B" initial="s"><state id="s"/></ascxml>')
    picture = ros_picture(load(tmp_path, files), str(tmp_path / "main.xml"))
    assert picture is not None
    assert "/a/b" in [node.label for node in picture.nodes]
    assert {node.parent for node in picture.nodes} == {""}


def test_closed_namespaces(tmp_path: Path) -> None:
    picture = namespace_graph(tmp_path)
    assert collapsed(picture, ["unknown", "topic go"]) == picture
    inner = collapsed(picture, ["namespace /fleet/a"])
    assert within(inner) == {name: box for name, box in within(picture).items() if box != "/fleet/a"}
    labels = {node.id: node.label for node in picture.nodes}
    hidden = {node.label: [labels[name] for name in node.hides] for node in inner.nodes if node.hides}
    assert hidden == {"/fleet/a": ["a", "/fleet/a/at"]}
    assert shown(collapsed(picture, ["namespace /fleet/a", "namespace /fleet"])) == [
        "namespace | /fleet | … 5 parts",
        "node | c",
        "node | Chief",
        "topic | /go | std_msgs/Bool",
        "topic | at | std_msgs/Int32",
        "/fleet -> Chief | subscribes",
        "/fleet -> c | subscribes",
        "Chief -> /go | publishes",
        "/go -> /fleet | subscribes",
        "/go -> c | subscribes",
        "c -> at | publishes",
    ]


GROUPS = """\
<ascxml name="Robot" version="1.0" initial="search">
  <!-- #region Waiting -->
  <!-- #endregion -->
  <!-- #region Docking -->
  <state id="search">
    <transition event="go" target="approach"/>
    <transition event="again" target="search"/>
  </state>
  <!-- #region Near -->
  <state id="approach">
    <transition><target id="docked" prob="0.9"/><target id="search"/></transition>
  </state>
  <!-- #endregion -->
  <!-- #endregion -->
  <!-- #region Docking -->
  <state id="docked">
    <transition event="go" target="search"/>
    <transition event="stop" target="approach"/>
    <transition event="stay"><assign location="x" expr="1"/></transition>
  </state>
  <!-- #endregion -->
  <ros_action_thread name="walk" n_threads="3">
    <!-- #region Walking -->
    <state id="walk"/>
    <!-- #endregion -->
  </ros_action_thread>
</ascxml>
"""


def test_groups_of_states(tmp_path: Path) -> None:
    """Regions are groups; those without states are not shown. A collapsed group has the transitions of its states."""
    analysis = load(tmp_path, {"robot.ascxml": GROUPS})
    picture = machine_picture(analysis, str(tmp_path / "robot.ascxml"))
    assert picture is not None
    groups = {node.id: node.parent for node in picture.nodes if node.kind is DiagramNodeKind.GROUP}
    thread = next(node.id for node in picture.nodes if node.kind is DiagramNodeKind.THREAD)
    walking = next(name for name in groups if name.endswith("/Walking"))
    assert groups == {
        "group /Docking": "",
        "group /Docking/Near": "group /Docking",
        "group /Docking 2": "",
        walking: thread,
    }
    assert {
        node.label or "choice": node.parent
        for node in picture.nodes
        if node.kind not in (DiagramNodeKind.GROUP, DiagramNodeKind.THREAD)
    } == {
        "search": "group /Docking",
        "approach": "group /Docking/Near",
        "choice": "group /Docking/Near",
        "docked": "group /Docking 2",
        "walk": walking,
    }
    assert text_at(analysis, picture.nodes[0].place) == "<!-- #region Docking -->"
    closed = collapsed(picture, ["group /Docking", "group /Docking/Near", walking])
    assert shown(closed) == [
        "group | Docking | … 2 states | initial",
        "group | Docking",
        "state | docked | in group /Docking 2",
        "thread | walk | 3 threads",
        f"group | Walking | … 1 state | in {thread}",
        "Docking -> group /Docking 2/docked | eventless | 0.9 | by chance",
        "group /Docking 2/docked -> Docking | event | go",
        "group /Docking 2/docked -> Docking | event | stop",
        "group /Docking 2/docked -> group /Docking 2/docked | event | stay | / x := 1 | internal",
    ]
    for each in (picture, closed):
        for direction in LayoutDirection:
            assert problems(each, draw(DiagramKind.MACHINE, each, direction)) == []


def large_graph(folder: Path, count: int) -> Picture:
    """A client of the services of several nodes, which subscribe to its topic; two nodes publish another topic."""
    clients = "".join(f'<ros_service_client service_name="/N{n}/{name}" type="std_srvs/Trigger"/>' for n in range(count)
                      for name in ("go", "halt"))  # fmt: skip
    publisher = '<ros_topic_publisher topic="/both" type="std_msgs/Bool"/>'
    files = {
        f"n{n}.ascxml": f'<ascxml name="N{n}" version="1.0" initial="s">'
        f'<ros_service_server service_name="/N{n}/go" type="std_srvs/Trigger"/>'
        f'<ros_service_server service_name="/N{n}/halt" type="std_srvs/Trigger"/>'
        f'<ros_topic_subscriber topic="/clock" type="std_msgs/Bool"/>{publisher if n == 1 else ""}'
        '<state id="s"/></ascxml>'
        for n in range(count)
    }
    files["client.ascxml"] = (
        f'<ascxml name="Client" version="1.0" initial="s">{clients}{publisher}'
        '<ros_topic_publisher topic="/clock" type="std_msgs/Bool"/><state id="s"/></ascxml>'
    )
    inputs = "".join(f'<input type="node-ascxml" src="{file}"/>' for file in files)
    parameters = '<parameters><max_time value="5" unit="s"/></parameters>'
    files["main.xml"] = f"<roaml>{parameters}<node_models>{inputs}</node_models></roaml>"
    picture = ros_picture(load(folder, files), str(folder / "main.xml"))
    assert picture is not None
    return picture


def test_a_large_graph_has_fewer_cards(tmp_path: Path) -> None:
    """A service is in the card of its server, a topic in that of its publisher, if it has only one. Nodes with the same
    neighbours are one card."""
    small = large_graph(tmp_path, 3)
    assert with_provided_interfaces(small) == small
    large = large_graph(tmp_path, 30)
    picture = with_provided_interfaces(large)
    alike = [f"N{n}" for n in range(30) if n != 1]
    assert shown(picture)[:2] == [f"node | 29 nodes | {' | '.join(alike)}", "node | N1 | /N1/go | /N1/halt"]
    assert [node.label for node in picture.nodes] == ["29 nodes", "N1", "Client", "/both"]
    labels = {node.id: node.label for node in large.nodes}
    visible = [labels[name] for node in picture.nodes for name in (node.id, *node.hides)]
    assert sorted(visible) == sorted(labels.values())
    through = {(labels[e.source], labels[e.target], e.interface): e.labels for e in picture.edges}
    services = tuple(f"/{name}/{service}" for name in alike for service in ("go", "halt"))
    assert set(through["Client", "N0", DiagramNodeKind.SERVICE]) == set(services)
    assert through["Client", "N1", DiagramNodeKind.SERVICE] == ("/N1/go", "/N1/halt")
    assert through["Client", "N0", DiagramNodeKind.TOPIC] == ("/clock",)
    assert through["Client", "/both", None] == through["N1", "/both", None] == ()
    assert len(through) == len(picture.edges) == 6
    for direction in LayoutDirection:
        assert problems(picture, draw(DiagramKind.ROS, picture, direction)) == []


def test_interfaces_are_named_beside_lines_that_do_not_end_at_their_row() -> None:
    kind, service = DiagramNodeKind.ROS_NODE, DiagramNodeKind.SERVICE
    rows = [Detail(DetailKind.INTERFACE, f"/Server/{name}", service.value) for name in ("go", "halt", "reset")]
    nodes = [DiagramNode(name, kind, name, (Detail(DetailKind.COUNT, "node"),)) for name in ("Client", "Middle")]
    server = DiagramNode("Server", kind, "Server", (Detail(DetailKind.COUNT, "node"), *rows))
    go, all_three = ("/Server/go",), ("/Server/go", "/Server/halt", "/Server/reset")
    edges = [
        DiagramEdge(source, target, EdgeKind.CALLS, labels, interface=service)
        for source, target, labels in (
            ("Client", "Middle", ("/other",)),
            ("Middle", "Server", go),
            ("Client", "Server", all_three),
        )
    ]
    picture = Picture("main.xml", (*nodes, server), tuple(edges))
    drawing = draw(DiagramKind.ROS, picture, LayoutDirection.RIGHT)
    assert problems(picture, drawing) == []
    texts = {item.text for groups, item in drawing.walk() if isinstance(item, TextItem) and groups[-1].edges == (2,)}
    assert texts == {"go, halt +1"}
    assert not any(group.role == "line-name" and group.edges == (1,) for group in drawing.groups)


def test_names_beside_lines_cover_nothing() -> None:
    """A name is above its line, below it if a card is there, and left out if there is no space."""
    route = Route(((Point(0, 50), Point(200, 50)),))
    above, below = Box(0, 20, 200, 25), Box(0, 55, 200, 25)
    for solid, is_named in (([], True), ([above], True), ([below], True), ([above, below], False)):
        text = LineNames(solid, [route], 200, 100).place("/scan", route)
        assert (text is not None) == is_named
        if text is not None:
            assert (text.box.bottom < 50) == (above not in solid)
            assert not any(box.overlaps(text.box) for box in solid)
    names = LineNames([], [route], 200, 100)
    places = [names.place("/scan", route) for _ in range(9)]
    boxes = [text.box for text in places if text is not None]
    assert 2 < len(boxes) < 9
    assert not any(a.overlaps(b) for a, b in itertools.combinations(boxes, 2))
    assert LineNames([], [route], 200, 100).place("n" * 60, route) is None


def test_a_part_of_a_ros_graph_with_namespaces(tmp_path: Path) -> None:
    """Of a namespace, everything in it is shown; a part is shown in its namespaces."""
    picture = namespace_graph(tmp_path)
    matches = {node.label for node in matching(picture, "namespace /fleet/a").nodes}
    assert matches == {"/fleet", "/fleet/a", "a", "/fleet/a/at", "/fleet/stop", "/go", "Chief"}
    near = {node.label for node in around(picture, "namespace /fleet/a").nodes}
    assert near == matches | {"/fleet/b", "b", "c"}
    assert within(matching(picture, "topic /fleet/b/at")) == {
        "/fleet/b": "/fleet",
        "/fleet/b/at": "/fleet/b",
        "b": "/fleet/b",
    }


def test_half_typed(tmp_path: Path) -> None:
    """Any prefix of the files causes no exception, and all parts of a drawing are connected."""
    files = split_files(CORNERS)
    chance = random.Random(5)
    for name, text in files.items():
        for end in sorted(chance.sample(range(len(text)), 6)):
            analysis = load(tmp_path, {**files, name: text[:end]})
            for file in files:
                for make in (machine_picture, tree_picture, ros_picture):
                    picture = make(analysis, str(tmp_path / file))
                    assert picture is None or _is_sound(analysis, picture)


def _is_sound(analysis: Analysis, picture: Picture) -> bool:
    ids = [node.id for node in picture.nodes]
    ends = {end for edge in picture.edges for end in (edge.source, edge.target)}
    places = [part.place for part in (*picture.nodes, *picture.edges) if part.place]
    texts = all(text_at(analysis, place) for place in places)
    return len(set(ids)) == len(ids) and {*ends, *(n.parent for n in picture.nodes if n.parent)} <= set(ids) and texts


@pytest.mark.parametrize(
    ("name", "kinds"),
    [("NODE_KINDS", DiagramNodeKind), ("EDGE_KINDS", EdgeKind), ("PICTURE_ACTIONS", PictureAction)],
)
def test_contract(name: str, kinds: type[DiagramNodeKind] | type[EdgeKind] | type[PictureAction]) -> None:
    """The extension and the library use the same words."""
    match = re.search(rf"{name} = \[([^\]]*)\]", CONTRACT.read_text(encoding="utf-8"))
    assert match is not None
    assert re.findall(r'"([^"]+)"', match[1]) == [kind.value for kind in kinds]
