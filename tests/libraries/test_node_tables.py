# SPDX-License-Identifier: Apache-2.0
"""The tables about nodes that are written by hand agree with the declarations and programs of the nodes."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from roaml.forest.forest import Forest
from roaml.forest.settings import NEWEST
from roaml.language import BEHAVIOR_TREE
from roaml.libraries import BEHAVIORTREE_CPP, library, library_node, version
from roaml.libraries.programs.assembly import programs
from roaml.libraries.programs.effects import Situation, effects
from roaml.libraries.programs.statuses import FAILURE, RUNNING, SUCCESS
from roaml.libraries.scripts import AFTERWARDS, CONDITIONS
from roaml.model.system import ANY_TYPE, builtin_plugins
from roaml.model.tree import build_tree_file
from roaml.roles import Direction, ValueRole
from roaml.rules.support.node_calls import WITHOUT_RESETS
from roaml.rules.trees import tree_semantics
from roaml.xml_syntax import parse

SWITCHES = [f"Switch{cases}" for cases in range(2, 7)]
MACHINES = Path(__file__).parents[2] / "server" / "roaml" / "lower" / "nodes"
ENDED = frozenset((SUCCESS, FAILURE))
RUNNING_FOR_OTHER_REASONS = {
    "Parallel",
    *(f"BlackboardCheck{type_}" for type_ in ("Int", "Bool", "Double", "String")),
}
"""Whether `Parallel` returns RUNNING depends on counts that are not known, and a mismatch may be RUNNING."""


def is_running_although_children_end(name: str) -> bool:
    node = library_node(name)
    assert node is not None
    children = (ENDED,) * min(max(node.children[0], 2), node.children[1])
    return RUNNING in effects(programs()[node.name], Situation(children, children)).answers


def test_nodes_that_continue_at_the_next_tick() -> None:
    running = {name for name in builtin_plugins() if is_running_although_children_end(name)}
    assert running - RUNNING_FOR_OTHER_REASONS == set(tree_semantics.CONTINUING)


def test_ports_with_times() -> None:
    timed = {(name, port) for name in programs() for port in programs()[name].timed_ports}
    assert timed == {("Delay", "delay_msec"), ("Timeout", "msec"), ("Sleep", "msec")}


def test_nodes_that_do_not_reset_their_child() -> None:
    """Their machines with the meaning of AS2FM halt a child only when they are halted."""
    machines = {path.stem: path.read_text("utf-8") for path in MACHINES.glob("*.ascxml")}
    with_children = {name: text for name, text in machines.items() if "<bt_tick_child" in text}
    own = {name: re.sub(r"<bt_halt .*?</bt_halt>", "", text, flags=re.DOTALL) for name, text in with_children.items()}
    assert {name for name, text in own.items() if "<bt_halt_child" not in text} == WITHOUT_RESETS


NAV2 = library("nav2")
COMMON = (
    *("Wait", "Spin", "BackUp", "IsStuck", "IsBatteryLow", "IsBatteryCharging", "GoalReached", "TimeExpired"),
    *("FollowPath", "FollowObject", "DockRobot", "UndockRobot", "GetCurrentPose", "NavigateToPose", "RoundRobin"),
    *("GoalUpdated", "InitialPoseReceived"),
)
"""The nodes of Nav2 with names that other programs use, too."""


@pytest.mark.parametrize("name", sorted(NAV2.nodes))
def test_one_leaf_shows_that_nav2_is_used_unless_its_name_is_common(name: str) -> None:
    tree = f'<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence><{name}/></Sequence></BehaviorTree></root>'
    file = build_tree_file(parse(tree))
    assert file is not None
    used = [known.name for known in Forest("tree.xml", (("tree.xml", file),), NEWEST).libraries]
    assert used == ([] if name in COMMON else [NAV2.name])


SPECIFICATION = Path(__file__).parents[2] / "docs" / "spec" / "lone-trees.md"


@pytest.mark.parametrize(
    ("since", "change"),
    [
        (version.TAGS_LOOKED_UP_SINCE, "A `ReactiveSequence` cannot have two children"),
        (version.ASYNC_SEQUENCES_REFUSED_SINCE, "A `ReactiveSequence` cannot have two children"),
        (version.NAMES_CHECKED_SINCE, "[Names](#names) are checked"),
        (version.SCRIPTS_CHANGED_SINCE, "Scripts have the grammar"),
        (version.CONSTANTS_TYPED_SINCE, "A number that a `<SubTree>` gives to an entry is a number"),
        (version.CASES_WHOLE_SINCE, "A case of a `Switch` is a number only if all of its text is one"),
    ],
)
def test_changes_of_versions_are_those_of_the_specification(since: version.Version, change: str) -> None:
    rows = [line for line in SPECIFICATION.read_text("utf-8").splitlines() if f"| {change}" in line]
    assert len(rows) == 1
    numbers = [int(number) for number in rows[0].split("|")[1].split(".")]
    assert tuple(since) == (*numbers, 0)[:3]


def test_attributes_with_scripts_are_those_of_the_schema() -> None:
    attributes = BEHAVIOR_TREE.elements["AlwaysSuccess"].attributes.values()
    assert {each.name for each in attributes if each.value is ValueRole.SCRIPT} == {*CONDITIONS, *AFTERWARDS}


def test_nodes_of_as2fm_have_machines() -> None:
    nodes = library(BEHAVIORTREE_CPP).nodes.values()
    assert {node.name for node in nodes if not node.program_only} == {path.stem for path in MACHINES.glob("*.ascxml")}


def test_ports_are_those_of_the_machines() -> None:
    """The machines that execute nodes with the meaning of AS2FM declare the types and directions in systems."""
    for name in (path.stem for path in MACHINES.glob("*.ascxml")):
        root = ElementTree.parse(MACHINES / f"{name}.ascxml").getroot()
        declared = {
            each.get("key"): (each.tag.rpartition("_")[2], each.get("type"))
            for each in root
            if each.tag.startswith("bt_declare_port_") and each.get("key") != "CHILDREN_COUNT"
        }
        ports = builtin_plugins()[name].ports
        own = {port.key: (port.direction.value, port.type) for port in ports if not port.key.endswith("_threshold")}
        assert own == declared, name


def test_the_checks_of_entries_compare_values_of_the_type_in_their_names() -> None:
    integers = library_node("BlackboardCheckInt")
    assert integers is not None
    for type_ in ("Int", "Bool", "Double", "String"):
        node = library_node(f"BlackboardCheck{type_}")
        assert node is not None
        compared = [port for port in node.ports if port.type == type_.lower()]
        assert [port.name for port in compared] == ["value_A", "value_B"]
        assert [port for port in node.ports if port not in compared] == [integers.port("return_on_mismatch")]
        assert {port.direction for port in node.ports} == {Direction.IN}


@pytest.mark.parametrize("name", ["IfThenElse", "WhileDoElse"])
def test_a_choice_may_lack_the_child_of_the_other_case(name: str) -> None:
    node = library_node(name)
    assert node is not None
    assert node.children == (2, 3)


def test_another_name_of_a_port_is_a_port_like_it() -> None:
    renamed = [
        (port, node.port(port.alias_of))
        for node in library(BEHAVIORTREE_CPP).nodes.values()
        for port in node.ports
        if port.alias_of
    ]
    assert renamed
    for port, meant in renamed:
        assert meant is not None
        assert (port.direction, port.type) == (meant.direction, meant.type)


def test_switches_compare_values_of_any_type() -> None:
    """In the trees of systems, entries have the types of the state machines."""
    ports = [port for name in SWITCHES for port in BEHAVIOR_TREE.elements[name].ports]
    assert {port.port.type for port in ports if port.port} == {ANY_TYPE}
