# SPDX-License-Identifier: Apache-2.0
"""Diagrams of two versions: without the removed parts they are the new diagram, without the added parts the old one."""

from __future__ import annotations

from collections import Counter
from itertools import permutations
from pathlib import Path

import pytest
from drawing_check import problems

from roaml import api
from roaml.figures.layout import LayoutDirection
from roaml.ide.diagrams import DiagramKind, Picture, draw, picture_of, tree_picture
from roaml.ide.diagrams.changes import PartChange, changes_of, compared
from roaml.ide.diagrams.diagram import Change, DiagramNode, DiagramNodeKind, EdgeKind
from roaml.project.settings import Settings

EXAMPLES = Path(__file__).parents[2] / "examples"


def tree_of(tmp_path: Path, name: str, content: str) -> Picture:
    path = tmp_path / name / "tree.xml"
    path.parent.mkdir()
    path.write_text(f'<root BTCPP_format="4"><BehaviorTree ID="Main">{content}</BehaviorTree></root>', encoding="utf-8")
    picture = tree_picture(api.check([str(path)]).snapshot.analysis, str(path))
    assert picture is not None
    return picture


def texts(changes: tuple[PartChange, ...]) -> list[str]:
    signs = {Change.ADDED: "+", Change.REMOVED: "-", Change.CHANGED: "~"}
    return [f"{signs[change.change]} {change.text}" for change in changes]


TREES = {
    "wrapped": (
        "<Sequence><A/><B/></Sequence>",
        "<Sequence><Inverter><A/></Inverter><B/></Sequence>",
        ["+ node `Inverter`"],
    ),
    "unwrapped": (
        "<Sequence><Inverter><Fallback><A/><B/></Fallback></Inverter><C/></Sequence>",
        "<Sequence><Fallback><A/><B/></Fallback><C/></Sequence>",
        ["- node `Inverter`"],
    ),
    "inserted among equal nodes": (
        "<Sequence><A/><A/><A/></Sequence>",
        "<Sequence><A/><B/><A/><A/></Sequence>",
        ["+ node `B`"],
    ),
    "exchanged": (
        "<Sequence><A/><B/><C/></Sequence>",
        "<Sequence><C/><A/><B/></Sequence>",
        ["~ node `C`: + moved from Sequence"],
    ),
    "moved elsewhere": (
        "<Sequence><Fallback><A/><B/></Fallback><C/></Sequence>",
        "<Sequence><Fallback><A/></Fallback><C/><B/></Sequence>",
        ["~ node `B`: + moved from Fallback"],
    ),
    "renamed, and a port changed": (
        '<Sequence><A name="one" goal="1"/><B/></Sequence>',
        '<Sequence><A name="two" goal="2"/><B/></Sequence>',
        ["~ node `two : A`: − name one : A; − goal = 1; + goal = 2"],
    ),
    "wrapped and changed inside": (
        '<Fallback><Sequence name="s"><A/><B/></Sequence><C/></Fallback>',
        '<Fallback><Inverter><Sequence name="s"><A/><D/><B/></Sequence></Inverter><C/></Fallback>',
        ["+ node `Inverter`", "+ node `D`"],
    ),
    "another type": ("<Sequence><A/><B/></Sequence>", "<Fallback><A/><B/></Fallback>", None),
    "the same": ("<Sequence><A/><B/></Sequence>", "<Sequence><A/><B/></Sequence>", []),
}


@pytest.mark.parametrize("case", TREES)
def test_trees(case: str, tmp_path: Path) -> None:
    before, after, expected = TREES[case]
    old, new = tree_of(tmp_path, "old", before), tree_of(tmp_path, "new", after)
    merged = compared(DiagramKind.TREE, old, new)
    if expected is not None:
        assert texts(changes_of(merged)) == expected
    check(DiagramKind.TREE, old, new, merged)


def check(kind: DiagramKind, old: Picture, new: Picture, merged: Picture) -> None:
    """The merged diagram contains both versions, and its drawing has no mistakes."""
    for version, other in ((old, Change.ADDED), (new, Change.REMOVED)):
        assert Counter(node.label for node in merged.nodes if node.change is not other) >= Counter(
            () if kind is DiagramKind.TREE and version is old else (node.label for node in version.nodes)
        )
        assert sum(node.change is not other for node in merged.nodes) == len(version.nodes)
        if kind is not DiagramKind.TREE or version is new:
            assert edges_of(merged, other) == edges_of(version, None)
    for direction in LayoutDirection:
        assert problems(merged, draw(kind, merged, direction)) == []


def edges_of(picture: Picture, without: Change | None) -> Counter[tuple[object, ...]]:
    """The edges as texts, except those with a change."""
    nodes = {node.id: node for node in picture.nodes}
    return Counter(
        (shown(nodes[edge.source]), shown(nodes[edge.target]), edge.kind, edge.labels, edge.actions)
        for edge in picture.edges
        if without is None or edge.change is not without
    )


def shown(node: DiagramNode) -> tuple[DiagramNodeKind, str]:
    return node.kind, node.label


def test_children_keep_the_order_of_the_new_tree(tmp_path: Path) -> None:
    old = tree_of(tmp_path, "old", "<Sequence><X/><A/><Y/><B/></Sequence>")
    new = tree_of(tmp_path, "new", "<Sequence><A/><Z/><B/></Sequence>")
    merged = compared(DiagramKind.TREE, old, new)
    labels = {node.id: node.label for node in merged.nodes}
    children = [labels[edge.target] for edge in merged.edges if edge.kind is EdgeKind.CHILD]
    assert children == ["X", "A", "Y", "Z", "B"]


@pytest.mark.parametrize("kind", DiagramKind)
def test_all_pairs_of_examples(kind: DiagramKind) -> None:
    """Any two diagrams are versions of each other; also a diagram and nothing."""
    pictures = []
    for folder in ("assembly_robot", "delivery_robot"):
        analysis = api.check([str(EXAMPLES / folder)], settings=Settings()).snapshot.analysis
        paths = sorted((EXAMPLES / folder).rglob("*xml"))
        drawn = (picture_of(kind, analysis, str(path)) for path in paths if kind is not DiagramKind.SYSTEM)
        pictures += [picture for picture in drawn if picture is not None and picture.nodes][:4]
    for old, new in permutations(pictures, 2):
        check(kind, old, new, compared(kind, old, new))
    for picture in pictures:
        same = compared(kind, picture, picture)
        assert {node.change for node in same.nodes} | {edge.change for edge in same.edges} == {Change.SAME}
        assert {node.change for node in compared(kind, None, picture).nodes} == {Change.ADDED}
        assert {node.change for node in compared(kind, picture, None).nodes} == {Change.REMOVED}
