# SPDX-License-Identifier: Apache-2.0
"""The clock while the tree is being ticked (docs/spec/semantics.md#time): it stops when the next tick is due, so an
answer that needs time may arrive before, or never."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api
from roaml.explicit.space import StateLimits
from roaml.verification.exhaustive import exact_values

PLUGIN = """<ascxml name="Wait" version="1.0" initial="ready">
    <ros_time_rate name="fast" rate_hz="{rate}" />
    <state id="ready">
        <bt_tick target="waiting" />
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
    <state id="waiting">
        <ros_rate_callback name="fast" target="ready"><bt_return_status status="SUCCESS" /></ros_rate_callback>
    </state>
</ascxml>"""
TREE = '<root BTCPP_format="4"><BehaviorTree ID="Main"><Wait /></BehaviorTree></root>'
MAIN = """<roaml>
    <parameters><max_time value="5" unit="s" /><bt_tick_rate value="1" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="wait.ascxml" />
    </behavior_tree>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>"""
PROPERTIES = """{"properties": [{"name": "succeeds", "expression": {"op": "filter", "fun": "values", "values": {"op":
    "Pmin", "exp": {"op": "F", "exp": {"op": "=", "left": "bt_1000_response__status", "right": 1}}}, "states": {"op":
    "initial"}}}]}"""


@pytest.mark.parametrize(("rate", "maximum"), [(2, 1.0), (1, 1.0), (0.5, 0.0)])
def test_a_tick_ends_before_the_next_one_or_never(tmp_path: Path, rate: float, maximum: float) -> None:
    """Timers of a plugin tick after the tree if both are due. So a timer that is not slower than the tree may tick
    while the plugin waits; the tick of a slower one is due after the next tick of the tree, which waits for it."""
    files = {
        "main.xml": MAIN,
        "tree.xml": TREE,
        "wait.ascxml": PLUGIN.format(rate=rate),
        "properties.jani": PROPERTIES,
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    system = api.load(str(tmp_path / "main.xml"))
    (rule,) = {finding.code for finding in api.check([str(tmp_path)]).diagnostics}
    assert rule == "answer-needs-time"
    checker = api.checker(api.as_target(system).model, ["succeeds", "stuck"])
    succeeds, stuck = (exact_values(checker, asked, StateLimits()) for asked in checker.compiled_properties)
    assert (succeeds.minimum.lower, succeeds.maximum.upper) == (0.0, maximum)
    assert (stuck.minimum.upper, stuck.maximum.lower) == (1.0 - maximum, 1.0)
