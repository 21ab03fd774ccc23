# SPDX-License-Identifier: Apache-2.0
"""Completion in comments, in files that are read line by line, and of keys and values in expressions."""

from __future__ import annotations

import pytest

from roaml.distributions.laws import LAWS
from roaml.ide.completion import Completions, complete
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace

TREE = """<root BTCPP_format="4"><BehaviorTree ID="Main"><Sequence>
    <ComputePathToPose goal="{g}" path="{p}"/><Grasp/><SubTree ID="Rest"/>
</Sequence></BehaviorTree><BehaviorTree ID="Rest"><Look/></BehaviorTree></root>"""
MACHINE = """<ascxml name="A" version="1.0" initial="a">
    <ros_topic_publisher name="pose" topic="/pose" type="geometry_msgs/Pose" />
    <datamodel>
        <data id="tries" type="int32" expr="0" />
        <data id="mode" type="string" expr="'idle'" />
        <data id="path" type="geometry_msgs/Point[]" expr="[]" />
    </datamodel>
    <state id="a">
        <transition event="e" cond="COND" target="a">
            <assign location="mode" expr="'busy'" />
            <assign location="tries" expr="3" />
            <ros_topic_publish name="pose"><field name="position" expr="KEYS" /></ros_topic_publish>
        </transition>
    </state>
</ascxml>"""


def completions(path: str, text: str, **others: str) -> tuple[Completions | None, str]:
    offset = text.index("|")
    workspace = Workspace((), Settings())
    for name, content in others.items():
        workspace.open(f"/models/{name}.xml", content)
    text = text.replace("|", "", 1)
    workspace.open(path, text)
    return complete(workspace.snapshot(), path, offset), text


def labels(path: str, text: str, **others: str) -> list[str]:
    found, _ = completions(path, text, **others)
    return [item.label for item in found.items] if found is not None else []


@pytest.mark.parametrize(
    ("path", "text", "expected"),
    [
        ("a.ascxml", "<ascxml name='A'><!-- as2fm: ignore[unu|] --></ascxml>", "unused-variable"),
        ("a.ascxml", "<ascxml name='A'><!-- as2fm: ignore[short-time, |] --></ascxml>", "unused-variable"),
        ("as2fm.toml", "tree-l|", "tree-libraries"),
        ("as2fm.toml", 'ignore = ["|"]', "unused-variable"),
        ("as2fm.toml", 'ignore = [\n    "short-time",\n    "|"\n]', "unused-variable"),
        ("as2fm.toml", "[severity]\n|", "unused-variable"),
        ("as2fm.toml", '[severity]\nunused-variable = "|"', "hint"),
        ("as2fm.toml", "tree-semantics = |", "as2fm"),
        ("as2fm.toml", "[verify]\n|", "uniform"),
        ("as2fm.toml", "[verify]\nuniform = |", "fail"),
        ("as2fm.toml", 'verify.uniform = "|"', "accept"),
        ("robot/msg/Place.msg", "uint8 x\nstd_msgs/|", "std_msgs/Header"),
        ("robot/srv/Go.srv", "floa|", "float64"),
    ],
)
def test_completion(path: str, text: str, expected: str) -> None:
    assert expected in labels(f"/models/{path}", text)


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("a.ascxml", "<ascxml name='A'><!-- as2fm: ignore[] | --></ascxml>"),
        ("as2fm.toml", "max-cells = |"),
        ("robot/msg/Place.msg", "uint8 x|"),
        ("tree.mocks", "Grasp: |"),
    ],
)
def test_places_without_completion(path: str, text: str) -> None:
    assert not labels(f"/models/{path}", text)


def test_the_typed_word_is_replaced() -> None:
    found, text = completions("/models/as2fm.toml", 'ignore = ["unused-|var"]')
    assert found is not None
    assert text[found.span.start : found.span.end] == "unused-var"


def test_leaves_of_the_tree_are_offered_in_its_mocks() -> None:
    assert labels("/models/tree.mocks", "# mocks\nGr|", tree=TREE) == ["ComputePathToPose", "Grasp", "Look"]


def test_properties_are_offered_as_names_of_expectations() -> None:
    workspace = Workspace((), Settings(), systems=["/models/main.xml"])
    workspace.open(
        "/models/main.xml",
        """<roaml><parameters><max_time value="9" unit="s" /></parameters><node_models />
        <properties><input type="xml" src="required.xml" /></properties></roaml>""",
    )
    workspace.open(
        "/models/required.xml",
        """<properties><guarantees>
        <property id="arrives" pattern="existence"><event>e</event><scope type="globally" /></property>
        <property id="$(var robot)_stops" pattern="existence"><event>e</event><scope type="globally" /></property>
        </guarantees></properties>""",
    )
    text = "[verify.expect]\narr"
    for folder in ("models", "other"):
        workspace.open(f"/{folder}/as2fm.toml", text)
    found = complete(workspace.snapshot(), "/models/as2fm.toml", len(text))
    assert found is not None
    assert [(item.label, item.snippet) for item in found.items] == [("arrives", 'arrives = "$1"')]
    assert complete(workspace.snapshot(), "/other/as2fm.toml", len(text)) is None


OWN = '<root BTCPP_format="4"><BehaviorTree ID="A"><Own><Grasp/></Own></BehaviorTree></root>'


def test_nodes_with_children_and_what_they_behave_like_are_offered() -> None:
    assert labels("/models/tree.mocks", "|", tree=OWN) == ["Grasp", "Own"]
    found, _ = completions("/models/tree.mocks", "Own: |", tree=OWN)
    assert found is not None
    inserted = {item.label: item.snippet for item in found.items}
    assert inserted["ForceSuccess"] == "as ForceSuccess"
    assert "Sleep" not in inserted
    assert "Inverter" in labels("/models/tree.mocks", "Own: as In|", tree=OWN)
    assert labels("/models/tree.mocks", "Own: as Repeat(|)", tree=OWN) == ["num_cycles"]
    named = OWN.replace("<Own>", "<Own name='mine'>")
    assert labels("/models/tree.mocks", "|", tree=named) == ["Grasp", "Own", "mine"]
    assert "Inverter" in labels("/models/tree.mocks", "mine: |", tree=named)
    assert labels("/models/tree.mocks", "Grasp: |", tree=OWN) == []


def test_distributions_are_offered_as_durations_of_mocks() -> None:
    found, _ = completions("/models/tree.mocks", "Grasp: 0.9 in no|", tree=TREE)
    assert found is not None
    inserted = {item.label: item.snippet for item in found.items}
    assert sorted(inserted) == sorted(LAWS)
    assert inserted["geometric"] == "geometric(${1:p}) * ${2:100 ms}"
    assert inserted["histogram"] == "histogram('${1:times.csv}', ${2:s})"
    assert inserted["normal"] == "normal(${1:mean}, ${2:deviation})"


@pytest.mark.parametrize(
    ("written", "expected", "replaced"),
    [
        ("{|}", ["'x'", "'y'", "'z'"], ""),
        ("{'x': 1, '|'}", ["'y'", "'z'"], "''"),
        ("{'x': {'y': 2}['y'], |}", ["'y'", "'z'"], ""),
        ("{'x': 1, 'y|': 2}", ["'y'", "'z'"], "'y'"),
    ],
)
def test_keys_of_a_struct_literal(written: str, expected: list[str], replaced: str) -> None:
    text = MACHINE.replace("COND", "true").replace("KEYS", written)
    found, without = completions("/models/a.ascxml", text)
    assert found is not None
    assert [item.label for item in found.items][: len(expected)] == expected
    assert without[found.span.start : found.span.end] == replaced


@pytest.mark.parametrize(("cond", "expected"), [("mode == |", ["'busy'", "'idle'"]), ("tries != |", ["0", "3"])])
def test_values_of_a_variable(cond: str, expected: list[str]) -> None:
    assert labels("/models/a.ascxml", MACHINE.replace("COND", cond).replace("KEYS", "{}"))[:2] == expected
