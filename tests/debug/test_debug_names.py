# SPDX-License-Identifier: Apache-2.0
"""Names of the debugger for what the translation has added: goals that are executed, and observers of properties."""

from __future__ import annotations

from pathlib import Path

import drive_robot
from roaml import api
from roaml.debugging.debugger import Debugger
from roaml.debugging.evaluate import evaluate, parsed
from roaml.debugging.scopes import ScopeEntry
from roaml.debugging.sources import Sources
from roaml.debugging.start import Start, start


def _scope(debugger: Debugger, thread: str, name: str) -> dict[str, ScopeEntry]:
    number = next(known.number for known in debugger.threads if known.name == thread)
    scopes = debugger.values.scopes(debugger.stack(number)[0])
    return {entry.name: entry for scope in scopes if scope.name == name for entry in scope.entries}


def test_goals_and_observers(tmp_path: Path) -> None:
    system = api.load(str(drive_robot.written(tmp_path)))
    debugger = start(Sources(api.as_target(system), system.analysis), Start("no_result"), lambda *_: None)
    assert [thread.name for thread in debugger.threads] == ["Operator 1", "Robot"]
    variables = _scope(debugger, "Robot", "Variables")
    assert set(variables) >= {"goal", "executes_second_0", "executes goal 0 of /arm/drive"}
    goal = variables["executes goal 0 of /arm/drive"]
    assert evaluate(parsed(goal.expression), debugger.values.names(debugger.stack(3)[0])) is False
    assert debugger.values.entry(f"Robot.{goal.expression}", None) is not None
    properties = _scope(debugger, "Robot", "Properties")
    assert properties["no_result"].value == "undecided"
    assert properties["no_result: violated"].value is False
    assert _scope(debugger, "Robot", "Global variables") == {}
    debugger.session.until_decided()
    debugger.go_to(debugger.session.position)
    assert _scope(debugger, "Robot", "Properties")["no_result: violated"].value is True
    assert not [text for choice in debugger.session.choices() if "observer" in (text := choice.text)]
