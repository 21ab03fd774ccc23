# SPDX-License-Identifier: Apache-2.0
"""Errors planted in a correct tree, its subtree in another file, and its models: each is reported at its place, without
consequential findings. The errors were chosen by their kinds, before it was known which of them are found."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from roaml import api
from roaml.diagnostics import Diagnostic, Severity

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

PLANTED = tomllib.loads(Path(__file__).with_name("planted_own_trees.toml").read_text(encoding="utf-8"))["planted"]
MAIN = """\
<?xml version="1.0"?>
<root BTCPP_format="4" main_tree_to_execute="Deliver">
  <include path="parts/grasp.xml"/>
  <BehaviorTree ID="Deliver">
    <Sequence name="top">
      <Script code="tries := 0; state := 'idle'; limit := 2.5"/>
      <RetryUntilSuccessful num_attempts="3">
        <Sequence>
          <LocateObject label="cup" pose="{object}"/>
          <SubTree ID="Grasp" target="{object}" force="4.5" result="{width}"/>
        </Sequence>
      </RetryUntilSuccessful>
      <Fallback>
        <Timeout msec="8000"><MoveTo goal="{object}" speed="0.4"/></Timeout>
        <ForceFailure><Report text="could not move" level="{width}"/></ForceFailure>
      </Fallback>
      <BatteryOk min="20" _skipIf="tries &gt; 3"/>
      <Parallel success_count="2" failure_count="1">
        <Delay delay_msec="200"><AlwaysSuccess/></Delay>
        <Report text="{state}" _onSuccess="tries += 1"/>
      </Parallel>
      <Switch2 variable="{state}" case_1="idle" case_2="busy">
        <AlwaysSuccess/>
        <AlwaysFailure/>
        <Sleep msec="100"/>
      </Switch2>
    </Sequence>
  </BehaviorTree>
  <TreeNodesModel>
    <Action ID="LocateObject">
      <input_port name="label" type="std::string"/>
      <output_port name="pose" type="Pose"/>
    </Action>
    <Action ID="MoveTo">
      <input_port name="goal" type="Pose"/>
      <input_port name="speed" type="double" default="0.5">m/s</input_port>
    </Action>
    <Action ID="Report">
      <input_port name="text" type="std::string"/>
      <input_port name="level" type="double" default="0"/>
    </Action>
    <Action ID="CloseGripper">
      <input_port name="target" type="Pose"/>
      <input_port name="force" type="double"/>
      <output_port name="width" type="double"/>
    </Action>
    <Condition ID="BatteryOk"><input_port name="min" type="int"/></Condition>
    <Decorator ID="EveryN"><input_port name="n" type="unsigned"/></Decorator>
    <SubTree ID="Grasp"><input_port name="target"/>
      <input_port name="force" default="3.0"/>
      <output_port name="result"/>
    </SubTree>
  </TreeNodesModel>
</root>
"""
GRASP = """\
<root BTCPP_format="4">
  <BehaviorTree ID="Grasp">
    <Sequence>
      <CloseGripper target="{target}" force="{force}" width="{result}"/>
      <ScriptCondition code="result &gt; 0.01"/>
    </Sequence>
  </BehaviorTree>
</root>
"""
FILES = {"main.xml": MAIN, "parts/grasp.xml": GRASP}


def findings(folder: Path, files: dict[str, str]) -> list[Diagnostic]:
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return [d for d in api.check([str(folder)]).diagnostics if d.severity >= Severity.INFORMATION]


def test_sound_trees_have_no_finding(tmp_path: Path) -> None:
    assert findings(tmp_path, FILES) == []


@pytest.mark.parametrize("mistake", PLANTED, ids=lambda mistake: f"{mistake['code']}: {mistake['new'][:30]}")
def test_planted_mistake(mistake: dict[str, str], tmp_path: Path) -> None:
    name = mistake["file"]
    assert mistake["old"] in FILES[name]
    text = FILES[name].replace(mistake["old"], mistake["new"], 1)
    planted = findings(tmp_path, {**FILES, name: text})
    shown = [(d.path, d.code, text[d.span.start : d.span.end], d.message) for d in planted]
    places = [(Path(d.path), d.code, text[d.span.start : d.span.end]) for d in planted]
    assert places == [(tmp_path / name, mistake["code"], mistake["place"])], shown
