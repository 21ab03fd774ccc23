# SPDX-License-Identifier: Apache-2.0
"""Random trees as public repositories contain them: navigation with recoveries, missions with subtrees in other files
and packages, scripts and conditions, own nodes with a `TreeNodesModel`, names with white space, and the format of
version 3."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import NamedTuple

MOCKS = "*: 0.75 in 200 ms\n"


class GrownTree(NamedTuple):
    """Files of a tree: `tree.xml`, its mocks, and what it includes."""

    files: dict[str, str]

    def write(self, folder: Path) -> Path:
        """Write the files; return the tree's."""
        for name, text in self.files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        return folder / "tree.xml"


def grow(seed: int) -> GrownTree:
    """The tree of a seed."""
    random = Random(f"forest {seed}")
    is_old = random.random() < 0.25
    grower = _Grower(random, is_old=is_old)
    main, sub = grower.node(4), grower.node(2)
    form = "" if is_old else ' BTCPP_format="4"'
    head = f'<root{form} main_tree_to_execute="Main">'
    start = "" if is_old else "<Script code=\"tries := 0; place := 'dock'\" />"
    given = '<SetBlackboard output_key="goal" value="1;2;0" />'
    remapped = random.choice(('goal="{goal}" path="{path}"', '_autoremap="true"', 'goal="{goal}" _autoremap="true"'))
    if is_old:
        remapped = random.choice(('goal="goal" path="path"', '__shared_blackboard="true"'))
    tree = f'<BehaviorTree ID="Main"><Sequence>{start}{given}{main}<SubTree ID="Errand" {remapped} /></Sequence>'
    errand = f'<BehaviorTree ID="Errand"><Sequence>{"" if is_old else start}{sub}</Sequence></BehaviorTree>'
    models = '<TreeNodesModel><Action ID="Grasp"><input_port name="object" default="box" />'
    models += '<output_port name="held" /></Action><Condition ID="IsHolding" /></TreeNodesModel>'
    files = {"tree.mocks": MOCKS}
    place = random.choice(("here", "folder", "package"))
    if place == "here":
        files["tree.xml"] = f"{head}{tree}</BehaviorTree>{errand}{models}</root>"
        return GrownTree(files)
    named = 'ros_pkg="errands" path="trees/errand.xml"' if place == "package" else 'path="trees/errand.xml"'
    files["tree.xml"] = f"{head}<include {named} />{tree}</BehaviorTree>{models}</root>"
    where = "errands/trees/errand.xml" if place == "package" else "trees/errand.xml"
    files[where] = f"<root{form}>{errand}{models}</root>"
    if place == "package":
        files["errands/package.xml"] = '<package format="3"><name>errands</name><version>1.0.0</version></package>'
    return GrownTree(files)


class _Grower:
    def __init__(self, random: Random, *, is_old: bool) -> None:
        self.random, self.is_old, self.count = random, is_old, 0

    def node(self, depth: int) -> str:
        """A node with at most `depth` levels of nodes."""
        kind = self.random.random()
        if depth <= 1 or kind < 0.15:
            return self._leaf()
        if kind < 0.4:
            return self._decorator(depth)
        return self._control(depth)

    def _children(self, depth: int, least: int, most: int) -> str:
        return "".join(self.node(depth - 1) for _ in range(self.random.randint(least, most)))

    def _named(self, words: str) -> str:
        self.count += 1
        return f' name="{words} {self.count}"' if self.random.random() < 0.3 else ""

    def _control(self, depth: int) -> str:
        old = {"SequenceWithMemory": "SequenceStar"} if self.is_old else {}
        name = self.random.choice(
            ("Sequence", "Fallback", "ReactiveFallback", "SequenceWithMemory", "PipelineSequence", "RoundRobin",
             "RecoveryNode", "Parallel", "IfThenElse", "WhileDoElse", "Sequence")
        )  # fmt: skip
        shown = old.get(name, name)
        if name == "RecoveryNode":
            return (
                f'<RecoveryNode number_of_retries="2"{self._named("try")}>{self._children(depth, 2, 2)}</RecoveryNode>'
            )
        if name in ("IfThenElse", "WhileDoElse"):
            return f"<{name}>{self._condition()}{self._children(depth, 2, 2)}</{name}>"
        if name == "Parallel":
            ports = ("success_threshold", "failure_threshold") if self.is_old else ("success_count", "failure_count")
            return (
                f'<Parallel {ports[0]}="2" {ports[1]}="1"{self._named("both")}>{self._children(depth, 2, 3)}</Parallel>'
            )
        if name == "ReactiveFallback":
            return f"<{name}>{self._condition()}{self._children(depth, 1, 1)}</{name}>"
        return f"<{shown}{self._named('part')}>{self._children(depth, 1, 3)}</{shown}>"

    def _decorator(self, depth: int) -> str:
        retry = "RetryUntilSuccesful" if self.is_old else "RetryUntilSuccessful"
        head = self.random.choice(
            ('RateController hz="2.0"', f'{retry} num_attempts="2"', 'Repeat num_cycles="2"', "Inverter",
             'Timeout msec="1000"', 'Delay delay_msec="300"', "ForceSuccess", "ForceFailure",
             'DistanceController distance="1.0"', "SingleTrigger")
        )  # fmt: skip
        return f"<{head}>{self.node(depth - 1)}</{head.split()[0]}>"

    def _condition(self) -> str:
        choices = ["<IsHolding />", '<Condition ID="IsHolding" name="is it held?" />', "<GoalUpdated />", "<IsStuck />",
                   '<IsBatteryLow min_battery="0.2" battery_topic="/battery" />', '<TimeExpired seconds="2" />',
                   "<InitialPoseReceived />", "<AlwaysFailure />"]  # fmt: skip
        if not self.is_old:
            choices.append('<ScriptCondition code="tries &lt; 2" />')
        return self.random.choice(choices)

    def _leaf(self) -> str:
        choices = [
            '<ComputePathToPose goal="{goal}" path="{path}" planner_id="GridBased" />',
            '<FollowPath path="{path}" controller_id="FollowPath" />',
            '<Spin spin_dist="1.57" />',
            '<Wait wait_duration="1.0" />',
            '<BackUp backup_dist="0.3" backup_speed="0.05" />',
            '<ClearEntireCostmap name="clear it" service_name="local_costmap/clear_entirely_local_costmap" />',
            '<Grasp object="cup" held="{thing}" />',
            '<Action ID="Grasp" name="grasp again" />',
            "<AlwaysSuccess />",
            self._condition(),
        ]
        if not self.is_old:
            choices += [
                '<Script code="tries := tries + 1" />',
                '<Grasp _skipIf="tries &gt; 1" _onSuccess="tries += 1" />',
                '<Sleep msec="300" _while="tries &lt; 3" />',
                '<Grasp _failureIf="place == \'kitchen\'" _post="tries := 0" />',
            ]
        return self.random.choice(choices)
