# SPDX-License-Identifier: Apache-2.0
"""The properties of the examples notice mistakes in their trees.

Each mutant of a tree has one node less, two siblings exchanged, a control node of another kind, or another leaf in
place of a leaf. A mutant is noticed if it has an error, or if an expectation is not met. The listed mutants are as good
as the example.
"""

from __future__ import annotations

import copy
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from lxml import etree

from roaml import api

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
CONTROLS = ("Sequence", "Fallback", "ReactiveSequence", "ReactiveFallback")

EXPECTATIONS = {
    "assembly_robot": ["block_placed >= 1", "never_placed_empty >= 1"],
    "case_study": ["recovers_or_succeeds >= 1"],
    "delivery_robot": [
        "all_delivered >= 1",
        "never_empty >= 1",
        "docks_only_when_low >= 1",
        "never_delivers_when_empty >= 1",
    ],
}
AS_GOOD = {
    # The outer sequence: after the last attempt, the block is placed in the same tick.
    "assembly_robot: Sequence 1 becomes ReactiveSequence",
    # The arm arrives with an empty gripper, which is noticed at the goal: the robot is slower, but tries again.
    "assembly_robot: HoldsBlock 6 and the next",
    # The block is picked up before each move, whether it has fallen or not: the robot is slower.
    "case_study: Inverter 3 deleted",
    "case_study: Inverter 3 and the next",
    "case_study: BlockFell 4 becomes RecoverBlock",
    # The recovery ends before the condition can change.
    "case_study: Fallback 2 becomes ReactiveFallback",
}


def _mutants(tree: etree._ElementTree) -> Iterator[tuple[str, etree._ElementTree]]:
    """The mutants of a tree, each with its description: the tag and the number of the changed node, in the order of
    the document."""
    nodes = [node for node in tree.iter(etree.Element) if node.tag not in ("root", "BehaviorTree")]
    leaves = {node.tag: node for node in nodes if len(node) == 0}
    for number, node in enumerate(nodes, 1):
        name = f"{node.tag} {number}"

        def copied(node: etree._Element = node) -> tuple[etree._ElementTree, etree._Element]:
            mutant = copy.deepcopy(tree)
            return mutant, mutant.xpath(tree.getpath(node))[0]  # type: ignore[index, return-value]

        mutant, target = copied()
        parent = target.getparent()
        assert parent is not None
        parent.remove(target)
        yield f"{name} deleted", mutant
        children = list(node.iterchildren(etree.Element))
        if len(children) == 1:
            mutant, target = copied()
            target.getparent().replace(target, next(target.iterchildren(etree.Element)))  # type: ignore[union-attr]
            yield f"{name} replaced by its child", mutant
        if next(node.itersiblings(etree.Element), None) is not None:
            mutant, target = copied()
            next(target.itersiblings(etree.Element)).addnext(target)
            yield f"{name} and the next", mutant
        for control in CONTROLS if node.tag in CONTROLS else ():
            if control != node.tag:
                mutant, target = copied()
                target.tag = control
                yield f"{name} becomes {control}", mutant
        for tag, leaf in leaves.items() if len(node) == 0 else ():
            if tag != node.tag:
                mutant, target = copied()
                target.getparent().replace(target, copy.deepcopy(leaf))  # type: ignore[union-attr]
                yield f"{name} becomes {tag}", mutant


def _is_noticed(main: Path, expectations: list[str]) -> bool:
    try:
        system = api.load(str(main))
    except api.ModelError:
        return True
    return not all(result.is_met for result in api.verify(system, expectations=expectations, only_uniform=True))


@pytest.mark.parametrize("example", EXPECTATIONS)
def test_properties_notice_mistakes_in_the_tree(example: str, tmp_path: Path) -> None:
    folder = tmp_path / example
    shutil.copytree(EXAMPLES / example, folder)
    assert not _is_noticed(folder / "main.xml", EXPECTATIONS[example])
    unnoticed = set()
    for description, mutant in _mutants(etree.parse(folder / "tree.xml")):
        mutant.write(folder / "tree.xml")
        if not _is_noticed(folder / "main.xml", EXPECTATIONS[example]):
            unnoticed.add(f"{example}: {description}")
    assert unnoticed == {description for description in AS_GOOD if description.startswith(f"{example}:")}


def test_every_example_with_a_tree_is_tried() -> None:
    """Except for `scaling`, which is a generated robot for measurements, and trees without a system."""
    assert {path.parent.name for path in EXAMPLES.glob("*/tree.xml")} == EXPECTATIONS.keys()
