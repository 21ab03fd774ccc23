# SPDX-License-Identifier: Apache-2.0
"""What an open file is depends on its content, so the editor reports what the command line reports for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml.diagnostics import Severity
from roaml.project.settings import Settings
from roaml.project.workspace import Workspace

SYSTEM = """<roaml>
    <parameter_declarations><parameter name="late" type="uint16" value="300" /></parameter_declarations>
    <parameters><max_time value="2 * late" unit="ms" /></parameters>
    <node_models><input type="node-ascxml" src="robot.ascxml" /></node_models>
    <properties><input type="jani" src="p.jani" /></properties>
</roaml>
"""
ROBOT = """<ascxml name="Robot" version="1.0" initial="a">
    <ros_time_rate name="t" rate_hz="1000 / late" />
    <state id="a"><ros_rate_callback name="t" target="a"><send event="e" /></ros_rate_callback></state>
</ascxml>
"""


@pytest.mark.parametrize("name", ["main.xml", "lock.roaml", "system"])
def test_an_open_system_has_any_name(name: str, tmp_path: Path) -> None:
    for file, text in ((name, SYSTEM), ("robot.ascxml", ROBOT), ("p.jani", '{ "properties": [] }')):
        (tmp_path / file).write_text(text)
    workspace = Workspace((str(tmp_path),), Settings())
    workspace.open(str(tmp_path / name), SYSTEM)
    snapshot = workspace.snapshot()
    assert [
        d.message for d in snapshot.checker.diagnostics(str(tmp_path / name)) if d.severity >= Severity.WARNING
    ] == []
    assert snapshot.analysis.systems_of(str(tmp_path / "robot.ascxml")) == (str(tmp_path / name),)
