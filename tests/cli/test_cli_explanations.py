# SPDX-License-Identifier: Apache-2.0
"""What `verify` says about the trace that shows why a property fails or holds, for two equal machines, of which each
property observes one."""

from __future__ import annotations

from pathlib import Path

import pytest

from as2fm_lsp.cli.main import run

BEEPER = """\
<ascxml name="M" version="1.0" initial="waiting">
    <ros_topic_publisher name="beep" topic="beep" type="std_msgs/Empty" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="waiting"><ros_rate_callback name="second" target="beeping" /></state>
    <state id="beeping">
        <transition target="done"><ros_topic_publish name="beep" /></transition>
    </state>
    <state id="done" />
</ascxml>
"""


def verified(folder: Path, expectations: str, capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """The output for one property for each of the machines `anna` and `bert`: it beeps within 1 s."""
    (folder / "m.ascxml").write_text(BEEPER)
    inputs = properties = ""
    for name in ("anna", "bert"):
        inputs += f'<input type="node-ascxml" src="m.ascxml" name="{name}" namespace="{name}" />'
        properties += f'<input type="xml" src="{name}.xml" />'
        (folder / f"{name}.xml").write_text(f"""\
<properties>
    <ports>
        <ros_topic topic_name="/{name}/beep" type="std_msgs/Empty" event="publish"><event_var id="beep" /></ros_topic>
    </ports>
    <guarantees>
        <property id="{name}_beeps" pattern="existence" {expectations}>
            <event>beep</event>
            <scope type="globally" />
            <time_interval within="1" time_unit="s" />
        </property>
    </guarantees>
</properties>
""")
    (folder / "main.xml").write_text(
        '<roaml><parameters><max_time value="4" unit="s" /></parameters>'
        f"<node_models>{inputs}</node_models><properties>{properties}</properties></roaml>"
    )
    run(["verify", str(folder / "main.xml"), "--explain", *arguments])
    return capsys.readouterr().out


def test_the_delayed_machine_is_one_that_matters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """In the shortest trace, both machines are delayed for the same time. One of the delays changes nothing."""
    text = verified(tmp_path, "", capsys)
    for name in ("anna", "bert"):
        block = text[text.index(f"{name}_beeps: minimum 0") :]
        assert "the property does not hold, for example, if `" in block
        assert block.split("the property does not hold, for example, if `")[1].startswith(
            f"{name}` is delayed from 1 s"
        )


@pytest.mark.parametrize("expectation", ["== 1", ">= 0.9", "== 0.9"])
def test_a_value_below_the_expected_one_is_explained_by_a_trace_that_fails(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], expectation: str
) -> None:
    """The minimum is 0."""
    text = verified(tmp_path, f'expect="{expectation}"', capsys)
    assert text.count("NOT MET") == 2
    for name in ("anna", "bert"):
        assert f"  {name}_beeps failed in the shortest trace" in text


@pytest.mark.parametrize("expectation", ["== 0", "== 0.9", "&lt;= 0.9"])
def test_a_value_above_the_expected_one_is_explained_by_a_trace_that_passes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], expectation: str
) -> None:
    """The value is 1 if machines react at once. The property is decided when the event occurs, not when time ends."""
    text = verified(tmp_path, f'expect="{expectation}"', capsys, "--reaction-time", "instant")
    assert text.count("NOT MET") == 2
    for name in ("anna", "bert"):
        assert f"  {name}_beeps passed in the shortest trace" in text
        assert f"{name}_beeps holds at 4.000 s, because the event that it requires occurred at 1.000 s" in text


def test_an_estimate_below_an_equation_is_explained_by_a_trace_that_fails(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With uniform choices, the probabilities are 0.9375 and 0.6875."""
    text = verified(tmp_path, 'expect="== 0.99"', capsys, "--method", "fixed", "--max-traces", "2000")
    assert text.count("NOT MET") == 2
    for name in ("anna", "bert"):
        assert f"  {name}_beeps failed in " in text
