# SPDX-License-Identifier: Apache-2.0
"""Projects of Groot2 (`.btproj`) beside a file of trees: the subtrees and node models that they list are known."""

from __future__ import annotations

from pathlib import Path

from checked import check_text
from roaml import api

SYSTEM = """
-- main.xml --
<roaml>
    <parameters><max_time value="10" unit="s" /></parameters>
    <behavior_tree tree-semantics="behaviortree-cpp"><input type="bt.cpp-xml" src="trees/tree.xml" /></behavior_tree>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- properties.jani --
{"properties": []}
-- trees/tree.xml --
<root BTCPP_format="4"><BehaviorTree ID="Main"><SubTree ID="Other" /></BehaviorTree></root>
-- trees/sub/other.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Other"><SubTree ID="Third" /></BehaviorTree>
    <BehaviorTree ID="Main"><AlwaysFailure /></BehaviorTree>
</root>
-- trees/third.xml --
<root BTCPP_format="4"><BehaviorTree ID="Third"><Repeat><AlwaysSuccess /></Repeat></BehaviorTree></root>
-- trees/unrelated.xml --
<root BTCPP_format="4"><BehaviorTree ID="Unrelated"><AlwaysSuccess /></BehaviorTree></root>
"""
PROJECT = """-- trees/robot.btproj --
<root BTCPP_format="4" project_name="Robot">
    <include path="tree.xml" />
    <include path="sub/other.xml" />
    <include path="third.xml" />
    <include path="unrelated.xml" />
    <TreeNodesModel>
        <Decorator ID="Repeat"><input_port name="num_cycles" default="3" /></Decorator>
    </TreeNodesModel>
</root>
"""


def check(folder: Path, text: str) -> tuple[list[str], api.CheckResult]:
    check_text(folder, text)
    result = api.check([str(folder / "main.xml")])
    return [d.code for d in result.diagnostics], result


def test_without_a_project_the_subtree_is_unknown(tmp_path: Path) -> None:
    codes, _ = check(tmp_path, SYSTEM)
    assert codes == ["tree-structure"]


def test_subtrees_and_models_of_the_project_are_known(tmp_path: Path) -> None:
    codes, result = check(tmp_path, SYSTEM + PROJECT)
    assert codes == []
    system = result.snapshot.analysis.system(str(tmp_path / "main.xml"))
    assert system is not None
    assert [instance.plugin for instance in system.instances] == ["Repeat", "AlwaysSuccess"]
    names = [Path(path).name for path in system.tree_paths]
    assert names == ["tree.xml", "robot.btproj", "other.xml", "third.xml"]


def test_a_project_that_does_not_list_the_tree_is_another_one(tmp_path: Path) -> None:
    codes, _ = check(tmp_path, SYSTEM + PROJECT.replace('<include path="tree.xml" />', ""))
    assert codes == ["tree-structure"]


def test_a_broken_project_and_a_missing_file_do_no_harm(tmp_path: Path) -> None:
    broken = PROJECT.replace('<include path="unrelated.xml" />', '<include path="nowhere.xml" /><include')
    codes, _ = check(tmp_path, SYSTEM + broken)
    assert "internal-error" not in codes
    assert "missing-include" in codes


def test_a_system_may_list_a_project(tmp_path: Path) -> None:
    listed = (SYSTEM + PROJECT).replace('src="trees/tree.xml"', 'src="trees/robot.btproj"')
    listed = listed.replace('<include path="unrelated.xml" />', "").replace(
        '<BehaviorTree ID="Main"><AlwaysFailure /></BehaviorTree>', ""
    )
    codes, _ = check(tmp_path, listed)
    assert codes == []
