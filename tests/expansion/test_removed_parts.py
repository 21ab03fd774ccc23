# SPDX-License-Identifier: Apache-2.0
"""The parts that the expansion removes are checked as others: each misspelling is one finding."""

from __future__ import annotations

from pathlib import Path

import pytest

from roaml import api
from roaml.text import apply_edits

SYSTEM = """<roaml>
    <parameter_declarations>
        <parameter name="rate" type="int32" value="2" />
        <parameter name="loss" type="float64" value="0.1" />
    </parameter_declarations>
    <channels>
        <channel topic="count" loss="loss" />
    </channels>
    <parameters><max_time value="5" unit="s" /></parameters>
    <node_models>
        <input type="node-ascxml" src="sender.ascxml" name="left" namespace="left">
            <param name="start" value="rate" />
            <remap from="count" to="/count" />
        </input>
        <input type="node-ascxml" src="receiver.ascxml" />
    </node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>
"""
LAST = "</parameter_declarations>"
SENDER = """<ascxml name="Sender" version="1.0" initial="run">
    <parameter name="start" type="int16" value="0" />
    <ros_topic_publisher name="count" topic="count" type="std_msgs/Int16" />
    <ros_time_rate name="timer" rate_hz="1" />
    <state id="run">
        <ros_rate_callback name="timer" target="run">
            <ros_topic_publish name="count"><field name="data" expr="start" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
"""
RECEIVER = """<ascxml name="Receiver" version="1.0" initial="run">
    <ros_topic_subscriber name="count" topic="count" type="std_msgs/Int16" />
    <state id="run">
        <ros_topic_callback name="count" cond="_msg.data &gt; 1" target="done" />
    </state>
    <state id="done">
        <ros_topic_callback name="count" target="run" />
    </state>
</ascxml>
"""
PROPERTIES = """<properties>
    <ports>
        <ros_topic topic_name="count/to_Receiver" type="std_msgs/Int16" event="publish">
            <state_var id="count" type="int16" field="data" expr="0" />
        </ros_topic>
    </ports>
    <guarantees>
        <property id="arrives" pattern="existence"><event>count == 2</event><scope type="globally" /></property>
    </guarantees>
</properties>
"""


def findings(folder: Path, old: str, new: str) -> list[api.Diagnostic]:
    texts = {
        "main.xml": SYSTEM,
        "sender.ascxml": SENDER,
        "receiver.ascxml": RECEIVER,
        "properties.xml": PROPERTIES,
    }
    assert any(old in text for text in texts.values())
    for name, text in texts.items():
        (folder / name).write_text(text.replace(old, new), encoding="utf-8")
    found = api.check([str(folder / "main.xml")]).diagnostics
    return [finding for finding in found if finding.code != "not-in-reference"]


def test_the_system_is_correct(tmp_path: Path) -> None:
    assert findings(tmp_path, "", "") == []


@pytest.mark.parametrize(
    ("old", "new", "code", "meant"),
    [
        ('topic="count" loss="loss"', 'topic="count" loss="loss" dept="3"', "unknown-attribute", "`depth`"),
        ('<channel topic="count"', '<channel topik="count"', "unknown-attribute", "`topic`"),
        ("<channel topic", '<chanel topic="x" /><channel topic', "unknown-element", "`<channel>`"),
        ('value="2"', 'value="2" mim="1"', "unknown-attribute", "`min`"),
        (LAST, f'<parameter name="x" type="int8" valeu="2" />{LAST}', "unknown-attribute", "`value`"),
        (LAST, f'<parameter name="x" typ="int8" value="2" />{LAST}', "unknown-attribute", "`type`"),
        (LAST, f'<parameter naem="x" type="int8" value="2" />{LAST}', "unknown-attribute", "`name`"),
        (LAST, f'<parameter name="x" type="int88" value="2" />{LAST}', "parameter-declaration", "`int8`"),
        (LAST, f"<parametr />{LAST}", "unknown-element", "`<parameter>`"),
        ('value="0"', 'value="0" mx="9"', "unknown-attribute", "`max`"),
        ('value="rate"', 'value="rate" nam="x"', "unknown-attribute", ""),
        ('to="/count"', 'to="/count" form="x"', "unknown-attribute", ""),
        ("</channels>", "wrong</channels>", "stray-text", "has no effect"),
        ("</channels>", "</channels><channels />", "repeated-element", "only one"),
        ('loss="loss"', "loss=loss", "xml-syntax", "quotes"),
        ('loss="loss"', 'loss="$(var loss)" foo="1"', "unknown-attribute", "no attribute `foo`"),
        ('loss="loss"', 'loss="0.1 + loss" depth="rates"', "invalid-channel", "`rate`"),
    ],
)
def test_a_misspelling_is_one_finding(tmp_path: Path, old: str, new: str, code: str, meant: str) -> None:
    found = [f for f in findings(tmp_path, old, new) if f.code not in ("unused-parameter", "unknown-property-port")]
    assert len({(finding.code, finding.span) for finding in found}) == len(found)
    assert {finding.code for finding in found} == {code}, found
    assert all(meant in finding.message for finding in found)


def test_a_misspelling_is_corrected(tmp_path: Path) -> None:
    (finding,) = findings(tmp_path, 'topic="count" loss', 'topic="count" los="0" loss')
    assert finding.code == "unknown-attribute"
    (finding,) = (f for f in findings(tmp_path, "loss=", "los=") if f.code == "unknown-attribute")
    fix = finding.fixes[0]
    text = (tmp_path / "main.xml").read_text(encoding="utf-8")
    assert apply_edits(text, fix.edits) == SYSTEM


def test_an_invalid_channel_is_the_only_finding(tmp_path: Path) -> None:
    """A property names what the receiver gets, which exists as soon as the channel is correct."""
    (finding,) = findings(tmp_path, 'topic="count" loss="loss"', 'topic="count" loss="loss + 1"')
    assert finding.code == "invalid-channel"
