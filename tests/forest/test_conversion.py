# SPDX-License-Identifier: Apache-2.0
"""Files of version 3 are converted completely, and the result has no findings (docs/spec/lone-trees.md#format)."""

from __future__ import annotations

from pathlib import Path

from roaml import api
from roaml.diagnostics import Severity
from roaml.text import apply_edits

VERSION_3 = """<root main_tree_to_execute="Main">
    <BehaviorTree ID="Main">
        <SequenceStar name="s">
            <RetryUntilSuccesful num_attempts="2"><AlwaysSuccess/></RetryUntilSuccesful>
            <SetBlackboard value="1" output_key="place"/>
            <SubTree ID="Inner" target="place" speed="3.5"/>
            <SubTreePlus ID="Inner" target="{place}" speed="2" __autoremap="1"/>
            <SubTree ID="Inner" target="place" speed="4" __shared_blackboard="false"/>
            <Parallel success_threshold="1" failure_threshold="2"><AlwaysSuccess/><AlwaysSuccess/></Parallel>
            <Parallel threshold="1"><AlwaysSuccess/><AlwaysSuccess/></Parallel>
            <SetBlackboard value="a &amp; b" output_key="text"/>
            <BlackboardCheckInt value_A="{place}" value_B="-2" return_on_mismatch="RUNNING"><Go/></BlackboardCheckInt>
            <Decorator ID="BlackboardCheckString" return_on_mismatch="SUCCESS"
                value_A="a &amp; b"
                value_B="{text}"><Go/></Decorator>
        </SequenceStar>
    </BehaviorTree>
    <BehaviorTree ID="Inner"><Go target="{target}" speed="{speed}"/></BehaviorTree>
</root>
"""
VERSION_4 = """<root BTCPP_format="4" main_tree_to_execute="Main">
    <BehaviorTree ID="Main">
        <SequenceWithMemory name="s">
            <RetryUntilSuccessful num_attempts="2"><AlwaysSuccess/></RetryUntilSuccessful>
            <SetBlackboard value="1" output_key="place"/>
            <SubTree ID="Inner" target="{place}" speed="3.5"/>
            <SubTree ID="Inner" target="{place}" speed="2" _autoremap="1"/>
            <SubTree ID="Inner" target="{place}" speed="4"/>
            <Parallel success_count="1" failure_count="2"><AlwaysSuccess/><AlwaysSuccess/></Parallel>
            <Parallel success_count="1"><AlwaysSuccess/><AlwaysSuccess/></Parallel>
            <SetBlackboard value="a &amp; b" output_key="text"/>
            <Precondition if="place == -2" else="RUNNING"><Go/></Precondition>
            <Decorator ID="Precondition" else="SUCCESS"
                if="'a &amp; b' == text"><Go/></Decorator>
        </SequenceWithMemory>
    </BehaviorTree>
    <BehaviorTree ID="Inner"><Go target="{target}" speed="{speed}"/></BehaviorTree>
</root>
"""


def test_a_file_of_version_3_is_converted(tmp_path: Path) -> None:
    path = tmp_path / "tree.xml"
    path.write_text(VERSION_3)
    reported = [d for d in api.check([str(path)]).diagnostics if d.severity >= Severity.INFORMATION]
    assert [d.code for d in reported] == ["tree-format"]
    (fix,) = reported[0].fixes
    assert apply_edits(VERSION_3, fix.edits) == VERSION_4
    path.write_text(VERSION_4)
    assert not [d for d in api.check([str(path)]).diagnostics if d.severity >= Severity.INFORMATION]
