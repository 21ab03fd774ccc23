# SPDX-License-Identifier: Apache-2.0
"""`as2fm-lsp migrate`: trees of version 3 of BehaviorTree.CPP become trees of version 4."""

from __future__ import annotations

from pathlib import Path

from command import Command

OLD = """\
<root main_tree_to_execute="Main">
    <!-- keep me -->
    <BehaviorTree ID="Main">
        <SequenceStar name="all">
            <RetryUntilSuccesful num_attempts="3"><Action ID="Dock" /></RetryUntilSuccesful>
            <SubTree ID="Rest" goal="pose" __shared_blackboard="true" />
        </SequenceStar>
    </BehaviorTree>
    <BehaviorTree ID="Rest"><Action ID="Wait" goal="{goal}" /></BehaviorTree>
</root>
"""
NEW = """\
<root BTCPP_format="4" main_tree_to_execute="Main">
    <!-- keep me -->
    <BehaviorTree ID="Main">
        <SequenceWithMemory name="all">
            <RetryUntilSuccessful num_attempts="3"><Action ID="Dock" /></RetryUntilSuccessful>
            <SubTree ID="Rest" goal="{pose}" _autoremap="true" />
        </SequenceWithMemory>
    </BehaviorTree>
    <BehaviorTree ID="Rest"><Action ID="Wait" goal="{goal}" /></BehaviorTree>
</root>
"""


def test_a_tree_is_migrated(command: Command, tmp_path: Path) -> None:
    tree = tmp_path / "tree.xml"
    tree.write_text(OLD, encoding="utf-8")
    checked = command("migrate", "tree.xml", "--check")
    assert (checked.status, checked.out, tree.read_text(encoding="utf-8")) == (1, "would migrate tree.xml\n", OLD)
    difference = command("migrate", "tree.xml", "--diff")
    assert difference.status == 1
    assert '+<root BTCPP_format="4" main_tree_to_execute="Main">' in difference.out
    done = command("migrate", "tree.xml")
    assert (done.status, done.out, tree.read_text(encoding="utf-8")) == (0, "migrated tree.xml\n", NEW)
    assert command("migrate", "tree.xml", "--check").status == 0


def test_the_trees_in_a_folder_are_migrated(command: Command, tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "tree.xml").write_text(OLD, encoding="utf-8")
    assert command("migrate", "a").out == "migrated a/tree.xml\n"
    assert (tmp_path / "a" / "tree.xml").read_text(encoding="utf-8") == NEW
    assert (tmp_path / "b" / "tree.xml").read_text(encoding="utf-8") == OLD


def test_other_files_are_refused(command: Command, tmp_path: Path) -> None:
    (tmp_path / "model.ascxml").write_text('<ascxml name="M" version="1.0" />', encoding="utf-8")
    done = command("migrate", "model.ascxml")
    assert (done.status, "neither a system file nor a tree" in done.err) == (2, True)
