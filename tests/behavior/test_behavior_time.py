# SPDX-License-Identifier: Apache-2.0
"""A plugin that waits for time stops the clock, and the fix of answer-needs-time starts it again: tested with
traces."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fixture import split_files
from mending import applied, found, workspace_of
from roaml import api
from roaml.ide.code_actions import quick_fixes
from roaml.rules import document
from roaml.smc.run import Options

CODE = "answer-needs-time"


def write(folder: Path) -> None:
    """The bad example of the rule, with a property: the tree succeeds."""
    example = document(CODE).split("## Bad\n")[1].split("```xml\n")[1].split("```")[0]
    succeeds = {"op": "=", "left": "bt_1000_response__status", "right": 1}
    asked = {"op": "filter", "fun": "values", "values": {"op": "Pmin", "exp": {"op": "F", "exp": succeeds}}}
    asked["states"] = {"op": "initial"}
    for name, text in split_files(example).items():
        (folder / name).write_text(text, encoding="utf-8")
    properties = {"properties": [{"name": "succeeds", "expression": asked}]}
    (folder / "properties.jani").write_text(json.dumps(properties), encoding="utf-8")


def probability(folder: Path) -> float:
    model = api.to_jani(api.load(str(folder / "main.xml")))
    [result] = api.verify(model, options=Options(epsilon=0.1, seed=1))
    assert result.answer is not None
    return result.answer.value


def test_the_fix_starts_the_clock(tmp_path: Path) -> None:
    """Before the fix, the result depends on chance: the timer of the oven may or may not tick at the time of the
    tick."""
    write(tmp_path)
    assert 0 < probability(tmp_path) < 0.9
    snapshot = workspace_of(tmp_path).snapshot()
    [diagnostic] = [d for d in found(snapshot) if d.code == CODE]
    [action] = quick_fixes(snapshot, diagnostic.path, diagnostic)
    for path, text in applied(snapshot, action.make()).items():
        Path(path).write_text(text, encoding="utf-8")
    assert not [d for d in found(workspace_of(tmp_path).snapshot()) if d.code == CODE]
    assert probability(tmp_path) == 1


@pytest.mark.parametrize("rate", ["1", "10"])
def test_the_server_is_looked_at_again_when_it_changes(rate: str, tmp_path: Path) -> None:
    """The finding depends on another file: it disappears when the server answers at once, and stays when only its timer
    changes."""
    write(tmp_path)
    snapshot = workspace_of(tmp_path).snapshot()
    assert [d.code for d in found(snapshot)] == [CODE]
    path = str(tmp_path / "oven.ascxml")
    source = snapshot.analysis.source(path)
    assert source is not None
    other = snapshot.with_texts({path: source.text.replace('rate_hz="1"', f'rate_hz="{rate}"')})
    assert [d.code for d in found(other)] == [CODE]
    request = '<ros_service_handle_request name="heat" target="heating" />'
    assert request in source.text
    answered = '<ros_service_send_response name="heat" /></ros_service_handle_request>'
    at_once = source.text.replace(request, f'<ros_service_handle_request name="heat" target="cold">{answered}')
    assert CODE not in [d.code for d in found(snapshot.with_texts({path: at_once}))]
