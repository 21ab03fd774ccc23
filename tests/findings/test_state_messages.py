# SPDX-License-Identifier: Apache-2.0
"""Messages of the rules about states: no advice leads to another finding."""

from __future__ import annotations

from pathlib import Path

from checked import check_text

GATE = """<ascxml name="Gate" version="1.0" initial="closed">
    <datamodel><data id="tries" type="int8" expr="0" /></datamodel>
    <ros_time_rate name="second" rate_hz="1" />
    <state id="closed">
        <ros_rate_callback name="second" target="deciding">
            <assign location="tries" expr="tries + 1" />
        </ros_rate_callback>
    </state>
    <state id="deciding">
        <transition COND target="open"><assign location="tries" expr="0" /></transition>
        <ros_rate_callback name="second" target="closed" />
    </state>
    <state id="open"><ros_rate_callback name="second" target="closed" /></state>
</ascxml>
"""


def messages(folder: Path, cond: str) -> dict[str, str]:
    return {d.code: d.message for d in check_text(folder, GATE.replace("COND", cond))[0]}


def test_a_condition_that_always_holds_beside_an_event_is_not_called_superfluous(tmp_path: Path) -> None:
    """Without this condition, the state would be an error."""
    with_condition = messages(tmp_path, 'cond="tries &gt; 0"')
    assert with_condition.keys() == {"constant-condition"}
    assert "the state never waits for `second`" in with_condition["constant-condition"]
    assert "no effect" not in with_condition["constant-condition"]
    without = messages(tmp_path, "")
    assert "the state never waits for `second`" in without["event-beside-eventless"]


def test_a_condition_that_may_fail_beside_an_event_is_right(tmp_path: Path) -> None:
    assert messages(tmp_path, 'cond="tries &gt; 1"') == {}
