# SPDX-License-Identifier: Apache-2.0
"""Typing in a behavior tree of 300 nodes that belongs to no system, with the models of Nav2's nodes in another file."""

from __future__ import annotations

import tempfile
from pathlib import Path
from xml.sax.saxutils import quoteattr

from bench.keystrokes import word_keys
from bench.report import Benchmark, Row, median, percentile, seconds
from bench.server import started
from roaml.libraries import library
from roaml.roles import Direction

NODES = 300
SESSIONS = 3
TREE = "tree.xml"
WORDS = (
    "<ComputePathToPose",
    'planner_id="{selected_planner',
    '<SubTree ID="Recover_3',
    'number_of_retries="6',
    'code="tries += 1',
    '_skipIf="tries &gt; 3',
    "<Fallback",
    '<FollowPath path="{path',
    "</RecoveryNode",
    'tries="{tries',
)
"""The words that lose their last character. Each key changes the findings: a server does not publish the diagnostics of
a file again if they are the same."""

_LOOP = """    <RecoveryNode number_of_retries="6" name="navigate_{0}">
      <PipelineSequence>
        <PlannerSelector selected_planner="{{selected_planner}}" default_planner="Grid" topic_name="planner"/>
        <RateController hz="1.0">
          <Fallback>
            <ComputePathToPose goal="{{goal}}" path="{{path}}" planner_id="{{selected_planner}}"/>
            <ClearEntireCostmap service_name="global_costmap/clear" _skipIf="tries &gt; 3"/>
          </Fallback>
        </RateController>
        <FollowPath path="{{path}}" error_msg="{{message}}"/>
        <Script code="tries += 1; last := tries * 2"/>
      </PipelineSequence>
      <SubTree ID="Recover_{0}" tries="{{tries}}" goal="{{goal}}"/>
    </RecoveryNode>
"""
_TAGS = {Direction.IN: "input_port", Direction.OUT: "output_port", Direction.INOUT: "inout_port"}
_NODES_OF_LOOP = 15
_RECOVERY = """  <BehaviorTree ID="Recover_{0}">
    <ReactiveFallback><GoalUpdated goal="{{goal}}"/><Sequence><Wait wait_duration="5.0"/>
      <ScriptCondition code="tries &lt; 5"/></Sequence></ReactiveFallback>
  </BehaviorTree>
"""


def tree_text(nodes: int = NODES) -> str:
    """A tree with about a given number of nodes, including those of its subtrees."""
    count = nodes // _NODES_OF_LOOP
    loops = "".join(_LOOP.format(number) for number in range(count))
    recoveries = "".join(_RECOVERY.format(number) for number in range(count))
    main = (
        f'  <BehaviorTree ID="Main"><Sequence>\n    <Script code="tries := 0"/>\n{loops}  </Sequence></BehaviorTree>\n'
    )
    return f'<root BTCPP_format="4" main_tree_to_execute="Main">\n{main}{recoveries}</root>\n'


def models_text() -> str:
    """The models of Nav2's nodes."""
    models = []
    for node in library("nav2").nodes.values():
        ports = "".join(
            f"<{_TAGS[port.direction]} name={quoteattr(port.name)} type={quoteattr(port.type)}/>" for port in node.ports
        )
        tag = node.kind.value.capitalize()
        models.append(f"    <{tag} ID={quoteattr(node.name)}>{ports}</{tag}>\n")
    return f'<root BTCPP_format="4"><TreeNodesModel>\n{"".join(models)}</TreeNodesModel></root>\n'


def write_tree(folder: Path, nodes: int = NODES) -> Path:
    (folder / "models.xml").write_text(models_text(), encoding="utf-8")
    (folder / "as2fm.toml").write_text('tree-models = ["models.xml"]\n', encoding="utf-8")
    path = folder / TREE
    path.write_text(tree_text(nodes), encoding="utf-8")
    return path


def typing() -> list[Row]:
    took = []
    for _ in range(SESSIONS):
        with tempfile.TemporaryDirectory() as name:
            took.append(session(write_tree(Path(name).resolve())))
    how = (
        f"{len(took[0])} keys in a tree of {NODES} nodes with Nav2's models, each from `didChange` to the file's "
        f"diagnostics, over stdio; median of {SESSIONS} sessions"
    )
    slow = median(percentile(times, 95) for times in took)
    return [
        Row("keystroke in a tree, median", seconds(median(map(median, took))), "", how),
        Row("keystroke in a tree, 95th percentile", seconds(slow), "< 60 ms", "the same keys"),
    ]


def session(path: Path) -> list[float]:
    """The time in s that a server takes for each key, if the next key is pressed after the answer."""
    text = path.read_text(encoding="utf-8")
    times = []
    with started() as server:
        server.initialize(path.parent)
        server.open(path, text.replace("<Fallback>", "<Fallbak>", 1))
        server.diagnostics(path, 1)
        server.change(path, 2, {"text": text})
        server.diagnostics(path, 2)
        for version, key in enumerate(word_keys(text, words=WORDS), 3):
            sent = server.change(path, version, key.change())
            arrived, _ = server.diagnostics(path, version)
            times.append(arrived - sent)
    return times


BENCHMARKS: dict[str, Benchmark] = {"tree": typing}
