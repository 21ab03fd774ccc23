# SPDX-License-Identifier: Apache-2.0
"""Valid trees with unusual features of BehaviorTree.CPP 4.10 and Nav2: nothing is reported, not even an information."""

from __future__ import annotations

from pathlib import Path

import pytest

from checked import check_text
from roaml.diagnostics import Severity

VALID = {
    "names from the port, the root blackboard, and an explicit form": """
<root BTCPP_format="4" main_tree_to_execute="A">
  <BehaviorTree ID="A"><Sequence>
    <Script code="value := 'x'; num_cycles := 2; total := 0; wait := 5"/>
    <SetBlackboard value="{=}" output_key="copy"/>
    <Repeat num_cycles="="><SubTree ID="B" speed="{num_cycles}"/></Repeat>
    <Action ID="Sleep" msec="{@wait}"/>
  </Sequence></BehaviorTree>
  <BehaviorTree ID="B"><Sequence>
    <Repeat num_cycles="{speed}"><AlwaysSuccess _onSuccess="@total += speed"/></Repeat>
    <ScriptCondition code="@total &gt;= 0"/>
  </Sequence></BehaviorTree>
</root>""",
    "scripts with everything": """
<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence>
    <Script code="a := b := 3  c := -2.5e-3; d := 0x1F &amp; ~a | 1 ^ 2; e := a &gt; 1 ? 'yes' : 'no'"/>
    <Script code="e += ' or'; e = e .. a; f := 1 &lt; a &lt;= 5 &amp;&amp; !(a == b) || true; c *= 2; c /= 3; c -= 1"/>
    <ScriptCondition code="f"/>
    <ScriptCondition code="e == 'no' &amp;&amp; d != 0 &amp;&amp; c &lt; 1"/>
    <AlwaysFailure _successIf="a == 3 ? true : false" _onFailure="a = 4" _post="b = a; a"/>
</Sequence></BehaviorTree></root>""",
    "conditions on every kind of node": """
<root BTCPP_format="4"><BehaviorTree ID="A">
  <Sequence _while="n &lt; 3" _onHalted="n = 0">
    <Script code="n := 0"/>
    <Inverter _failureIf="n == 7"><AlwaysFailure _skipIf="n == 2"/></Inverter>
    <SubTree ID="B" _autoremap="1" _successIf="n &gt; 5" _onSuccess="n += 1" _post="n = n"/>
  </Sequence>
</BehaviorTree>
<BehaviorTree ID="B">
  <AlwaysSuccess _skipIf="n == 1" _description="text" _uid="7" _fullpath="a/b" _mine="x"/></BehaviorTree>
</root>""",
    "queues and updates": """
<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence>
    <ForceSuccess>
      <LoopString queue="a;b;c" value="{letter}" if_empty="FAILURE"><Script code="seen := letter"/></LoopString>
    </ForceSuccess>
    <LoopDouble queue="1;2.5;-3e2" value="{x}"><Delay delay_msec="5"><AlwaysSuccess/></Delay></LoopDouble>
    <LoopBool queue="true;0" value="{flag}"><WaitValueUpdate entry="flag"><AlwaysSuccess/></WaitValueUpdate></LoopBool>
    <SkipUnlessUpdated entry="{letter}"><AlwaysSuccess/></SkipUnlessUpdated>
    <WasEntryUpdated entry="seen"/>
    <UnsetBlackboard key="seen"/>
</Sequence></BehaviorTree></root>""",
    "counts of children at their limits": """
<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence>
    <IfThenElse><AlwaysSuccess/><AlwaysSuccess/></IfThenElse>
    <WhileDoElse><AlwaysSuccess/><AlwaysSuccess/><AlwaysFailure/></WhileDoElse>
    <TryCatch catch_on_halt="true"><Sleep msec="5"/><AlwaysSuccess/><AlwaysSuccess/></TryCatch>
    <Switch3 variable="b" case_1="a" case_2="2" case_3="3.5"><Sleep msec="0"/><Sleep msec="1"/><Sleep msec="2"/>
      <AlwaysSuccess/></Switch3>
    <Parallel success_count="-1" failure_count="-2"><AlwaysSuccess/><AlwaysSuccess/></Parallel>
    <ParallelAll max_failures="1"><AlwaysSuccess/></ParallelAll>
    <RetryUntilSuccessful num_attempts="-1"><AlwaysSuccess/></RetryUntilSuccessful>
</Sequence></BehaviorTree></root>""",
    "nodes of the program that no model describes": """
<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence>
    <Say text="hello ${USER} {not closed" mood="{mood}"/>
    <MyDecorator every="3"><Say text="{mood}"/></MyDecorator>
    <MyControl><Say/><Say/><Say/></MyControl>
    <Condition ID="IsWell" mood="{mood}"/>
    <Decorator ID="Twice"><AlwaysSuccess/></Decorator>
</Sequence></BehaviorTree></root>""",
    "models with defaults, types of the program and descriptions": """
<root BTCPP_format="4"><BehaviorTree ID="A"><Sequence>
    <Find what="cup" where="{here}"/><Go to="1;2;3.14"/><Go to="json:{&quot;x&quot;: 1}" speed=".5"/><Go to="{here}"/>
    <Count number="{n}"/><Every><Count number="{n}"/></Every>
</Sequence></BehaviorTree>
<TreeNodesModel>
    <Action ID="Find" editable="true"><input_port name="what" type="std::string"/>
      <output_port name="where" type="Pose2D"/>
    </Action>
    <Action ID="Go"><input_port name="to" type="Pose2D"/>
      <input_port name="speed" type="double" default="0.5f"/></Action>
    <Action ID="Count"><inout_port name="number" type="int"/></Action>
    <Decorator ID="Every"><input_port name="n" type="unsigned int" default="{=}"/>
      <description>Text.</description></Decorator>
</TreeNodesModel></root>""",
    "subtrees: compact, described, with constants and names of instances": """
<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main"><Fallback>
    <SubTree ID="Go" name="first" to="kitchen" speed="3"/><SubTree ID="Go" name="second" to="{room}" speed="2.5"/>
    <Sequence name="same"><Sequence name="same"><Rest/></Sequence></Sequence>
    <Script code="room := 'hall'"/>
  </Fallback></BehaviorTree>
  <BehaviorTree ID="Go"><Drive to="{to}" speed="{speed}"/></BehaviorTree>
  <BehaviorTree ID="Rest"><KeepRunningUntilFailure><AlwaysFailure/></KeepRunningUntilFailure></BehaviorTree>
  <TreeNodesModel><SubTree ID="Go"><input_port name="to"/>
      <input_port name="speed" default="1"/></SubTree></TreeNodesModel>
</root>""",
    "Nav2: lists, entries of the host, persistent positions": """
<root BTCPP_format="4"><BehaviorTree ID="Tour">
  <PersistentSequence current_child_idx="{position}">
    <ClearEntireCostmap service_name="/a/b" plugins="one;two" server_timeout="50"/>
    <GoalUpdater input_goal="{goal}" output_goal="{newest}">
      <ComputePathToPose goal="{newest}" path="{path}"/></GoalUpdater>
    <RecoveryNode><FollowPath path="{path}"/><RoundRobin wrap_around="true">
      <Spin/><Wait wait_duration="1.5"/></RoundRobin>
    </RecoveryNode>
    <SingleTrigger><Wait/></SingleTrigger>
    <Script code="position := 0"/>
  </PersistentSequence>
</BehaviorTree></root>""",
    "an include in a package, text as CDATA, and comments": """
-- package.xml --
<package format="3"><name>robot</name></package>
-- trees/main.xml --
<?xml version="1.0" encoding="UTF-8"?>
<!-- main -->
<root BTCPP_format="4" main_tree_to_execute="Main" project_name="Robot">
  <include path="inner.xml"/>
  <BehaviorTree ID="Main" _description="what it does"><Sequence><!-- a --><SubTree ID="Inner" count="{n}"/>
    <Precondition if="n &gt; 1" else="RUNNING"><RunOnce then_skip="false"><AlwaysSuccess/></RunOnce></Precondition>
  </Sequence></BehaviorTree>
  <TreeNodesModel><Action ID="Count"><output_port name="n" type="int"/></Action></TreeNodesModel>
</root>
-- trees/inner.xml --
<root BTCPP_format="4"><BehaviorTree ID="Inner"><Count n="{count}"/></BehaviorTree></root>""",
}


@pytest.mark.parametrize("text", VALID.values(), ids=VALID.keys())
def test_nothing_is_reported(text: str, tmp_path: Path) -> None:
    diagnostics, _ = check_text(tmp_path, text.lstrip("\n") + "\n")
    assert [(d.code, d.message) for d in diagnostics if d.severity >= Severity.INFORMATION] == []
