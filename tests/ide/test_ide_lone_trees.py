# SPDX-License-Identifier: Apache-2.0
"""Completion, hover, definition and rename in trees, with libraries and models, mostly without a system."""

from __future__ import annotations

import pytest
from ide_case import FOLDER, path_of

from roaml.ide import navigation
from roaml.ide.completion import complete, document
from roaml.ide.hover import hover
from roaml.ide.names.lookup import symbol_group_at
from roaml.ide.rename import RenameRefusal, Renaming, rename
from roaml.project.settings import Settings
from roaml.project.workspace import Snapshot, Workspace
from roaml.text import apply_edits

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


SYSTEM = '<roaml><behavior_tree><input type="bt.cpp-xml" src="tree.xml"/></behavior_tree></roaml>'


def offered(text: str, mark: str = "‸", **others: str) -> dict[str, str]:
    """The labels of the completions at a mark, with their details."""
    before, _, after = text.partition(mark)
    snapshot = snapshot_of(tree=before + after, **others)
    completions = complete(snapshot, path_of("tree.xml"), len(before))
    return {item.label: item.detail for item in completions.items} if completions else {}


def hover_text(text: str, piece: str) -> str:
    """The hover text at a caret `|` in a piece of a text."""
    before, _, after = piece.partition("|")
    clean = text.replace("‸", "").replace('"|"', '""')
    actual_hover = hover(
        snapshot_of(tree=clean).analysis, path_of("tree.xml"), clean.index(before + after) + len(before)
    )
    return actual_hover.text if actual_hover else ""


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


def test_a_tree_is_not_offered_as_its_own_subtree() -> None:
    trees = '<BehaviorTree ID="A"><SubTree ID="‸"/></BehaviorTree><BehaviorTree ID="B"><Sleep msec="1"/></BehaviorTree>'
    assert offered(f'<root BTCPP_format="4">{trees}</root>').keys() == {"B"}


def test_documentation_of_an_item() -> None:
    text = MODELS.replace("|", "")
    before, _, after = text.partition("‸")
    snapshot = snapshot_of(tree=before + after)
    completions = complete(snapshot, path_of("tree.xml"), len(before))
    assert completions is not None
    item = next(item for item in completions.items if item.label == "force")
    assert item.about is not None
    assert "How hard, in N." in document(snapshot.analysis, item.about)


def test_hover_shows_ports_and_defaults() -> None:
    assert "How hard, in N." in hover_text(MODELS, 'for|ce="3"')
    assert "`5` if not set" in hover_text(MODELS, 'for|ce="3"')
    empty = NAV2.replace("<Sub‸", "").replace("<ComputePathToPose", '<ComputePathToPose planner_id="Grid"')
    assert "empty if not set" in hover_text(empty, 'planner|_id="')
    assert "in force : int = 5" in hover_text(MODELS, '<Gra|sp force="3"')
    assert "Plans a path to a pose." in hover_text(NAV2, "<Compute|PathToPose")
    assert "*Nav2*" in hover_text(NAV2, "<Compute|PathToPose")
    assert "must be set" in hover_text(NAV2, 'go|al="{goal}"')
    assert "10.0" in hover_text(NAV2, 'h|z="1.0"')
    assert "translated" not in hover_text(MODELS, "<Pre|condition")


MAIN = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <include path="inner.xml"/>
  <BehaviorTree ID="Main">
    <Sequence>
      <Script code="count := 1; @total := count"/>
      <SetBlackboard value="3" output_key="count"/>
      <SubTree ID="Inner" number="{count}" _autoremap="true"/>
      <Grasp force="{count}" _skipIf="count &lt; 2 &amp;&amp; total == 1"/>
    </Sequence>
  </BehaviorTree>
  <TreeNodesModel><Action ID="Grasp"><input_port name="force" type="int"/></Action></TreeNodesModel>
</root>
"""
INNER = """<root BTCPP_format="4">
  <BehaviorTree ID="Inner">
    <Sequence><Repeat num_cycles="{number}"><AlwaysSuccess/></Repeat><Script code="total += number"/></Sequence>
  </BehaviorTree>
</root>
"""
OTHER = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <include path="inner.xml"/>
  <BehaviorTree ID="Main"><SubTree ID="Inner" number="4"/></BehaviorTree>
</root>
"""
FILES = {"main": MAIN, "inner": INNER, "other": OTHER}


def renamed(name: str, piece: str, new: str) -> dict[str, str]:
    """The texts after a rename at the caret `|` in a piece of a file."""
    before, _, after = piece.partition("|")
    analysis = snapshot_of(**FILES).analysis
    at = FILES[name].index(before + after) + len(before)
    result = rename(analysis, path_of(f"{name}.xml"), at, new)
    assert isinstance(result, Renaming), result
    return {file: apply_edits(text, result.edits.get(path_of(f"{file}.xml"), ())) for file, text in FILES.items()}


def test_a_subtree_is_renamed_in_all_files() -> None:
    texts = renamed("inner", 'ID="In|ner"', "Core")
    assert texts == {name: text.replace('ID="Inner"', 'ID="Core"') for name, text in FILES.items()}
    assert renamed("main", 'SubTree ID="In|ner"', "Core") == texts


def test_trees_of_one_name_in_separate_files_are_two() -> None:
    texts = renamed("other", 'BehaviorTree ID="Ma|in"', "Other")
    assert texts["main"] == MAIN
    assert texts["other"] == OTHER.replace('"Main"', '"Other"')


def test_an_entry_is_renamed_in_scripts_and_ports() -> None:
    texts = renamed("main", '<Grasp force="{cou|nt}"', "tries")
    assert texts["main"] == MAIN.replace("count", "tries")
    assert texts["inner"] == INNER
    assert renamed("main", 'code="cou|nt :=', "tries") == texts


def test_an_entry_that_is_remapped_is_renamed_inside() -> None:
    texts = renamed("inner", "total += num|ber", "amount")
    assert texts["inner"] == INNER.replace("number", "amount")
    assert texts["main"] == MAIN.replace("number=", "amount=")
    assert texts["other"] == OTHER.replace("number=", "amount=")


def test_an_automatically_remapped_entry_is_one() -> None:
    texts = renamed("inner", "to|tal +=", "sum")
    assert texts["inner"] == INNER.replace("total", "sum")
    assert texts["main"] == MAIN.replace("total", "sum")


def test_the_definition_of_a_node_is_its_model() -> None:
    analysis = snapshot_of(**FILES).analysis
    group = symbol_group_at(analysis, path_of("main.xml"), MAIN.index("<Grasp") + 2)
    assert group is not None
    assert [(place.path, MAIN[place.span.start - 4 : place.span.end]) for place in group.definitions] == [
        (path_of("main.xml"), 'ID="Grasp')
    ]


def test_the_definition_of_a_subtree_is_in_its_file() -> None:
    analysis = snapshot_of(**FILES).analysis
    group = symbol_group_at(analysis, path_of("main.xml"), MAIN.index('"Inner"') + 2)
    assert group is not None
    assert [place.path for place in group.definitions] == [path_of("inner.xml")]


ENTRIES = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <include path="parts.xml"/>
  <BehaviorTree ID="Main"><Sequence>
    <Script code="target := 1; speed := 2"/>
    <SubTree ID="Drive" goal="{target}" limit="{speed}" count="0" speed="{=}" unused="1" message="{text}"/>
    <SubTree ID="Drive" goal="4" count="0"/>
  </Sequence></BehaviorTree>
</root>
"""
PARTS = """<root BTCPP_format="4">
  <BehaviorTree ID="Drive"><Sequence>
    <SubTree ID="Move" to="{goal}" limit="{limit}"/>
    <Report count="{count}"/><Script code="count += speed"/>
    <Repeat num_cycles="{goal}"><AlwaysSuccess/></Repeat>
  </Sequence></BehaviorTree>
  <BehaviorTree ID="Move"><Go to="{to}" limit="{limit}"/></BehaviorTree>
  <TreeNodesModel><SubTree ID="Drive"><input_port name="message"/></SubTree></TreeNodesModel>
</root>
"""


@pytest.mark.parametrize(
    ("file", "piece", "target"),
    [
        ("main", 'go|al="{target}"', 'to="{|goal}'),
        ("main", 'go|al="4"', 'to="{|goal}'),
        ("main", 'lim|it="{speed}"', 'limit="{|limit}"/>\n    <Report'),
        ("main", 'cou|nt="0" speed', 'code="|count +='),
        ("main", 'spe|ed="{=}"', "count += |speed"),
        ("parts", 't|o="{goal}"', 'Go to="{|to}'),
        ("main", 'unu|sed="1"', None),
    ],
)
def test_an_attribute_of_a_subtree_leads_to_the_entry_inside(file: str, piece: str, target: str | None) -> None:
    texts = {"main": ENTRIES, "parts": PARTS}
    before, _, after = piece.partition("|")
    at = texts[file].index(before + after) + len(before)
    places = navigation.definition(snapshot_of(**texts).analysis, path_of(f"{file}.xml"), at)
    if target is None:
        assert places == ()
        return
    before, _, after = target.partition("|")
    assert [(place.path, place.span.start) for place in places] == [
        (path_of("parts.xml"), PARTS.index(before + after) + len(before))
    ]


def test_the_value_of_an_attribute_of_a_subtree_leads_to_the_entry_outside() -> None:
    analysis = snapshot_of(main=ENTRIES, parts=PARTS).analysis
    places = navigation.definition(analysis, path_of("main.xml"), ENTRIES.index("{target}") + 2)
    assert [(place.path, place.span.start) for place in places] == [(path_of("main.xml"), ENTRIES.index("target :="))]


def test_a_subtree_without_a_name_is_no_tree_without_a_name() -> None:
    text = """<root main_tree_to_execute="A"><BehaviorTree ID="A"><Sequence><SubTree/><Grasp force="{x}"/></Sequence>
        </BehaviorTree><BehaviorTree><AlwaysSuccess/></BehaviorTree></root>"""
    group = symbol_group_at(snapshot_of(tree=text).analysis, path_of("tree.xml"), text.index("{x}") + 1)
    assert group is not None
    assert len(group.uses) == 1


def test_entries_are_offered_in_scripts() -> None:
    tree = """<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence>
        <Script code="count := 1"/><Grasp force="{strength}"/><AlwaysSuccess _skipIf="co‸"/>
        <Script code="total := str‸"/><Grasp text="co^"/>
    </Sequence></BehaviorTree></root>"""
    assert offered(tree.replace("str‸", "str").replace("^", "")).keys() >= {"count"}
    assert "strength" in offered(tree.replace("co‸", "co").replace("^", ""))
    assert "count" not in offered(tree.replace("‸", ""), "^")


def test_a_system_knows_the_same_nodes_and_entries() -> None:
    tree = """<root BTCPP_format="4"><BehaviorTree ID="A"><PipelineSequence>
        <Repeat num_cycles="1"><SetBlackboard output_key="{count}" value="1"/></Repeat>
        <AlwaysSuccess _skipIf="co‸"/><^/></PipelineSequence></BehaviorTree></root>"""
    assert "count" in offered(tree.replace("<^/>", ""), system=SYSTEM)
    labels = offered(tree.replace("‸", ""), "^", system=SYSTEM)
    assert labels["RateController"] == "decorator, Nav2"
    assert "ManualSelector" not in labels
    text = tree.replace("‸", "").replace("<^/>", "")
    described = [
        hover(snapshot.analysis, path_of("tree.xml"), text.index("num_cycles"))
        for snapshot in (snapshot_of(tree=text, system=SYSTEM), snapshot_of(tree=text))
    ]
    assert described[0] is not None
    assert described[0] == described[1]


def test_entries_of_scripts_in_a_system() -> None:
    """Entries that occur only in scripts are offered and renamed, also where a subtree takes them over."""
    tree = """<root BTCPP_format="4" main_tree_to_execute="A">
  <BehaviorTree ID="A"><Sequence>
    <Script code="count := 1"/><SubTree ID="B" _autoremap="true"/><AlwaysSuccess _skipIf="count == 1"/>
  </Sequence></BehaviorTree>
  <BehaviorTree ID="B"><Script code="count += 1; own := 2"/></BehaviorTree>
</root>
"""
    assert "count" in offered(tree.replace("count == 1", "co‸"), system=SYSTEM)
    analysis = snapshot_of(tree=tree, system=SYSTEM).analysis
    for piece in ("count :=", "count == 1", "count +="):
        result = rename(analysis, path_of("tree.xml"), tree.index(piece) + 1, "tries")
        assert isinstance(result, Renaming), result
        assert apply_edits(tree, result.edits[path_of("tree.xml")]) == tree.replace("count", "tries")
    taken = rename(analysis, path_of("tree.xml"), tree.index("count +="), "own")
    assert taken == RenameRefusal("a blackboard variable `own` already exists")
