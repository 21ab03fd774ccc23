# SPDX-License-Identifier: Apache-2.0
"""Trees that belong to no system: completion, hover, definition and rename, with libraries and models."""

from __future__ import annotations

from ide_case import FOLDER, path_of

from roaml.ide.completion import complete, document
from roaml.ide.hover import hover
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace

NAV2 = """<root BTCPP_format="4">
  <BehaviorTree ID="A">
    <PipelineSequence>
      <RateController hz="1.0"><ComputePathToPose goal="{goal}" path="{path}"/></RateController>
      <Sub‸
    </PipelineSequence>
  </BehaviorTree>
</root>
"""

MODELS = """<root BTCPP_format="4">
  <BehaviorTree ID="A">
    <Sequence>
      <Grasp force="3"/><Repeat num_cycles="2"><Grasp ‸/></Repeat>
      <Precondition if="true" else="|"><AlwaysSuccess/></Precondition>
    </Sequence>
  </BehaviorTree>
  <TreeNodesModel>
    <Action ID="Grasp"><input_port name="force" type="int" default="5">How hard, in N.</input_port>
    <output_port name="width" type="double"/></Action>
  </TreeNodesModel>
</root>
"""


def snapshot_of(**texts: str) -> Snapshot:
    workspace = Workspace((FOLDER,), Settings())
    for name, text in texts.items():
        workspace.open(path_of(f"{name}.xml"), text)
    return workspace.snapshot()


def offered(text: str, mark: str = "‸") -> dict[str, str]:
    """The labels that are offered at a mark, with their details."""
    before, _, after = text.partition(mark)
    snapshot = snapshot_of(tree=before + after)
    completions = complete(snapshot, path_of("tree.xml"), len(before))
    return {item.label: item.detail for item in completions.items} if completions else {}


def told(text: str, piece: str) -> str:
    """What is told at a caret `|` in a piece of a text."""
    before, _, after = piece.partition("|")
    clean = text.replace("‸", "").replace('"|"', '""')
    found = hover(snapshot_of(tree=clean).analysis, path_of("tree.xml"), clean.index(before + after) + len(before))
    return found.text if found else ""


def test_nodes_of_libraries_are_offered() -> None:
    items = offered(NAV2.replace("<Sub‸", "<‸"))
    assert items["ComputePathToPose"] == "action, Nav2"
    assert items["TryCatch"] == "control, BehaviorTree.CPP"
    assert "SequenceStar" not in items
    assert "TestNode" not in items
    without = offered('<root BTCPP_format="4"><BehaviorTree ID="A"><‸</BehaviorTree></root>')
    assert "ComputePathToPose" not in without
    assert "Sleep" in without


def test_nodes_and_ports_of_models_are_offered() -> None:
    items = offered(MODELS)
    assert items["force"] == "in int = 5"
    assert items["width"] == "out double"
    assert offered(MODELS.replace("‸", ""), "|").keys() >= {"SUCCESS", "FAILURE", "RUNNING", "SKIPPED"}
    inside = MODELS.replace("‸", "").replace("|", "").replace("<Sequence>", "<Sequence><‸")
    assert offered(inside)["Grasp"] == "action"


def test_documentation_of_an_item() -> None:
    text = MODELS.replace("|", "")
    before, _, after = text.partition("‸")
    snapshot = snapshot_of(tree=before + after)
    completions = complete(snapshot, path_of("tree.xml"), len(before))
    assert completions is not None
    item = next(item for item in completions.items if item.label == "force")
    assert item.about is not None
    assert "How hard, in N." in document(snapshot.analysis, item.about)


def test_hover_tells_ports_and_defaults() -> None:
    assert "How hard, in N." in told(MODELS, 'for|ce="3"')
    assert "`5` if not set" in told(MODELS, 'for|ce="3"')
    assert "in force : int = 5" in told(MODELS, '<Gra|sp force="3"')
    assert "Plans a path to a pose." in told(NAV2, "<Compute|PathToPose")
    assert "*Nav2*" in told(NAV2, "<Compute|PathToPose")
    assert "must be set" in told(NAV2, 'go|al="{goal}"')
    assert "10.0" in told(NAV2, 'h|z="1.0"')
    assert "translated" not in told(MODELS, "<Pre|condition")
