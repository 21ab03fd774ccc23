# SPDX-License-Identifier: Apache-2.0
"""The declarations of Nav2's nodes are consistent: types, directions, defaults and limits agree with the texts, with
one another, and with the kind of server that a node calls. `test_libraries_conformance.py` compares them with the model
file of Nav2, if it is present."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from pathlib import Path

import pytest

from checked import check_text, of_rule
from roaml.diagnostics import Severity
from roaml.libraries import library
from roaml.libraries.node import FormerPort, Node, Port
from roaml.roles import Direction, NodeKind

NODES = tuple(library("nav2").nodes.values())
PORTS = [(node, port) for node in NODES for port in node.ports]
IDS = [f"{node.name}.{port.name}" for node, port in PORTS]
REALS = ("double", "float")
NUMBERS = (*REALS, "int", "unsigned int", "uint16", "chrono::milliseconds")
OPPOSITE_BY_NODE = {"path", "pose", "route", "goals", "tracking_feedback"}
"""What some nodes compute and others need."""
CHOICES = ("_id", "_service_name", "_statuses")
"""The ends of the names of ports that choose a part of the server, or that only accompany other ports."""
WITHOUT_NEEDS = {
    *("ComputeRoute", "ComputeAndTrackRoute", "DockRobot"),  # A goal is a pose or an identifier.
    *("ConcatenatePaths", "PathExpiringTimer", "GoalUpdater"),
}
"""The nodes that accept missing ports."""
ADDITIONS = {("ComputePathToPose", "viapoints"), ("AppendGoalPoseToGoals", "input_goals")}
"""Ports without which a node has less to do."""
OWN_DEFAULTS = {"is_recovery", "max_robot_pose_search_dist", "topic_name", "use_start"}
"""The ports whose defaults depend on the node."""


@pytest.mark.parametrize(("node", "port"), PORTS, ids=IDS)
def test_type_is_that_of_the_text(node: Node, port: Port) -> None:
    assert (port.type == "bool") == port.text.startswith("Whether "), port
    if unit := re.search(r", in (ms|s|m|m/s|rad|Hz)\b|in (Hz|m/s)\.", port.text):
        assert port.type == "chrono::milliseconds" if unit[1] == "ms" else port.type in REALS, port


def test_ports_of_one_name_have_one_type() -> None:
    types = defaultdict(set)
    for _, port in PORTS:
        types[port.name].add(port.type)
    assert [name for name, of_name in types.items() if len(of_name) > 1] == []


def test_ports_of_one_name_have_one_direction() -> None:
    directions = defaultdict(set)
    for _, port in PORTS:
        directions[port.name].add(port.direction)
    assert {name for name, of_name in directions.items() if len(of_name) > 1} <= OPPOSITE_BY_NODE


@pytest.mark.parametrize(("node", "port"), PORTS, ids=IDS)
def test_direction_is_that_of_the_name(node: Node, port: Port) -> None:
    if port.name.startswith(("input_", "default_", "start", "goal_")) or port.name.endswith(("r_id", "_service_name")):
        assert port.direction is Direction.IN
    if port.name.startswith(("output_", "selected_", "last_", "next_")) or port.name.endswith(("_time", "_duration")):
        assert port.direction is (
            Direction.IN if port.name.startswith("max_") or "wait" in port.name else Direction.OUT
        )


@pytest.mark.parametrize(("node", "port"), PORTS, ids=IDS)
def test_what_a_node_needs_or_has_a_default_is_read(node: Node, port: Port) -> None:
    if port.direction is Direction.OUT:
        assert (port.required, port.default, port.limits) == (False, None, None)
    if "the default is" in port.text:
        assert (port.direction, port.required, port.default) == (Direction.IN, False, None)


@pytest.mark.parametrize(("node", "port"), PORTS, ids=IDS)
def test_a_node_needs_what_it_uses_without_a_condition(node: Node, port: Port) -> None:
    if port.direction is Direction.OUT or port.default is not None:
        return
    has_condition = re.search(r"default| if |that is used|until|has its own", port.text) is not None
    can_be_missing = port.name.endswith(CHOICES) or node.name in WITHOUT_NEEDS or (node.name, port.name) in ADDITIONS
    assert port.required is not (has_condition or can_be_missing)


@pytest.mark.parametrize(("node", "port"), PORTS, ids=IDS)
def test_default_is_a_value_of_the_type(node: Node, port: Port) -> None:
    if port.default is None:
        return
    if port.type == "bool":
        assert port.default in ("true", "false")
    elif port.type in REALS:
        assert re.fullmatch(r"-?[0-9]+\.[0-9]+|inf", port.default)
    elif port.type in NUMBERS:
        assert re.fullmatch(r"-?[0-9]+", port.default)
    else:
        assert port.type == "string"


def test_ports_of_one_name_have_one_default() -> None:
    defaults = defaultdict(set)
    for _, port in PORTS:
        if port.direction is Direction.IN:
            defaults[port.name].add(port.default)
    assert {name for name, of_name in defaults.items() if len(of_name) > 1} <= OWN_DEFAULTS


def test_a_selector_reads_the_topic_of_its_name() -> None:
    selectors = {node.name: node for node in NODES if node.port("topic_name")}
    topics = {name: re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower() for name in selectors}
    assert {name: node.port_by_name["topic_name"].default for name, node in selectors.items()} == topics
    assert all(name.endswith("Selector") and node.succeeds for name, node in selectors.items())


@pytest.mark.parametrize(("node", "port"), PORTS, ids=IDS)
def test_limits_accept_the_default(node: Node, port: Port) -> None:
    limits = port.limits
    if limits is None or limits.minimum is None:
        return
    assert port.type in NUMBERS
    number = float(port.default) if port.default is not None else math.inf
    assert number > limits.minimum if limits.is_exclusive else number >= limits.minimum or number in limits.special
    if port.type in (*REALS, "chrono::milliseconds"):
        assert limits.minimum == 0  # of times, distances, rates, costs and charges
    elif port.text.startswith("The number of "):
        assert limits.minimum == 1
    elif port.text.startswith("The maximum number of "):
        assert limits.minimum == 0
    named = {float(number) for number in re.findall(r"(-[0-9]+) means", port.text)}
    assert limits.special == {number for number in named if number < limits.minimum}


@pytest.mark.parametrize("node", NODES, ids=lambda node: node.name)
def test_children_are_those_of_the_text(node: Node) -> None:
    least, most = node.children
    words = ("first child", "second child", "third child")
    if node.kind is NodeKind.CONTROL and least == most:
        assert [word in node.text for word in words] == [number < least for number in range(len(words))]
    elif node.kind is NodeKind.CONTROL:
        assert least == 1


@pytest.mark.parametrize("node", NODES, ids=lambda node: node.name)
def test_a_node_that_calls_an_action_is_running(node: Node) -> None:
    """The client of an action waits for the result, so its first tick returns RUNNING. A node without a server computes
    its result in one tick. Whether a service has answered within a tick is not known."""
    ports = set(node.port_by_name)
    if node.kind is not NodeKind.ACTION:
        assert node.running is None
    elif "error_code_id" in ports:
        assert {"server_name", "server_timeout", "error_msg"} <= ports
        assert node.running
    elif "server_timeout" in ports:
        assert ("server_name" in ports) != ("service_name" in ports)
        assert node.running is None
    else:
        assert not node.running
        assert node.running is False or node.name == "CheckStopStatus"


DEFAULTS = {
    "ComputeRoute.use_start": "false",
    "ComputeAndTrackRoute.use_start": "false",
    "SmoothPath.check_for_collisions": "false",
    "ValidatePath.stop_at_first_collision": "true",
    "ValidatePath.max_cost": "254",
    "CheckStopStatus.duration_stopped": "1000",
    "GetPoseFromPath.index": "0",
    "Spin.is_recovery": "true",
    "AssistedTeleop.is_recovery": "false",
    "ToggleCollisionMonitor.enable": "true",
    "DockRobot.use_dock_id": "true",
    "DockRobot.navigate_to_staging_pose": "true",
    "IsBatteryLow.is_voltage": "false",
    "RecoveryNode.number_of_retries": "1",
    "RoundRobin.wrap_around": "false",
}
"""Defaults of Nav2 that follow from nothing else in the declarations, stated a second time."""

INPUTS = {
    *("ComputePathToPose.viapoints", "TruncatePathLocal.pose", "PathExpiringTimer.path", "FollowObject.tracked_frame"),
    *("DockRobot.dock_id", "DockRobot.dock_pose"),
}
"""Ports that a node reads, although no rule above says so."""


def test_defaults_that_only_nav2_knows() -> None:
    defaults = {f"{node.name}.{port.name}": port.default for node, port in PORTS}
    assert {name: defaults[name] for name in DEFAULTS} == DEFAULTS


def test_inputs_that_only_nav2_knows() -> None:
    directions = {f"{node.name}.{port.name}": port.direction for node, port in PORTS}
    assert {name for name in INPUTS if directions[name] is Direction.IN} == INPUTS


def test_results_are_written() -> None:
    """A node writes what it gets from its server. An entry that it changes, it also reads."""
    directions = {(node.name, port.name): port.direction for node, port in PORTS}
    results = {"error_code_id", "error_msg", "num_retries", "rerouted", "current_edge_id"}
    assert {direction for (_, port), direction in directions.items() if port in results} == {Direction.OUT}
    for node in ("ComputeRoute", "ComputeAndTrackRoute"):
        assert {directions[node, port] for port in ("route", "path")} == {Direction.OUT}
    assert directions["PersistentSequence", "current_child_idx"] is Direction.INOUT


FORMER = [(node, port) for node in NODES for port in node.former]


@pytest.mark.parametrize(("node", "port"), FORMER, ids=[f"{node.name}.{port.name}" for node, port in FORMER])
def test_former_ports_are_no_ports_and_warnings_keep_trees_executable(
    node: Node, port: FormerPort, tmp_path: Path
) -> None:
    assert node.port(port.name) is None
    assert port.release in ("Humble", "Iron", "Jazzy", "Kilted")
    assert not port.now or node.port(port.now) is not None
    tag = f'<{node.name} {port.name}="x"/>'
    tree = f'<root><BehaviorTree ID="A"><Sequence><ComputePathToPose/>{tag}</Sequence></BehaviorTree></root>'
    text = f"-- tree.xml --\n{tree}\n"
    found = of_rule(check_text(tmp_path, text)[0], "unknown-port")
    assert [(one.severity, f"ROS 2 {port.release} has it" in one.message) for one in found] == [
        (Severity.WARNING, True)
    ]
