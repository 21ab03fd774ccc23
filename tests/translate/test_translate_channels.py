# SPDX-License-Identifier: Apache-2.0
"""Storm computes for channels what follows from their definition by hand."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from storm import exact

from roaml import api

SENDER = """<ascxml name="Sender" version="1.0" initial="send">
    <datamodel><data id="count" type="uint8" expr="0" /></datamodel>
    <ros_topic_publisher name="count" topic="count" type="std_msgs/UInt8" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="send">
        <ros_rate_callback name="second" cond="count &lt; 3" target="send">
            <assign location="count" expr="count + 1" />
            <ros_topic_publish name="count"><field name="data" expr="count" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>"""
RECEIVER = """<ascxml name="Receiver" version="1.0" initial="wait">
    <ros_topic_subscriber name="count" topic="count" type="std_msgs/UInt8" />
    <state id="wait"><ros_topic_callback name="count" target="wait" /></state>
</ascxml>"""
PROPERTIES = """<properties>
    <ports>
        <ros_topic topic_name="count" type="std_msgs/UInt8" event="publish">
            <state_var id="sent" type="uint8" field="data" expr="0" />
        </ros_topic>
        <ros_topic topic_name="count/to_Receiver" type="std_msgs/UInt8" event="publish">
            <state_var id="received" type="uint8" field="data" expr="0" />
        </ros_topic>
    </ports>
    <guarantees>
        <property id="any" pattern="existence"><event>received &gt; 0</event><scope type="globally" /></property>
        <property id="second" pattern="existence"><event>received == 2</event><scope type="globally" /></property>
        <property id="overtaken" pattern="existence">
            <event>sent == 2 &amp;&amp; received == 0</event><scope type="globally" />
        </property>
    </guarantees>
</properties>"""
P, LATE = Fraction(1, 10), Fraction(1, 4)
DELAY = f"categorical(500 ms, {float(1 - LATE)}, 1500 ms, {float(LATE)})"


@pytest.mark.parametrize(
    ("channel", "expected"),
    [
        (f'loss="{float(P)}"', {"any": 1 - P**3, "second": 1 - P}),
        (f'delay="{DELAY}" step="500 ms"', {"any": 1, "second": 1, "overtaken": LATE}),
        (f'loss="{float(P)}" delay="{DELAY}"', {"any": 1 - P**3, "overtaken": P + (1 - P) * LATE}),
        ('delay="1500 ms" depth="1"', {"any": 1, "second": 0, "overtaken": 1}),
    ],
)
def test_storm_agrees(tmp_path: Path, channel: str, expected: dict[str, Fraction]) -> None:
    main = f"""<roaml>
    <channels><channel topic="count" {channel} /></channels>
    <parameters><max_time value="6" unit="s" reaction_time="instant" /></parameters>
    <node_models>
        <input type="node-ascxml" src="sender.ascxml" />
        <input type="node-ascxml" src="receiver.ascxml" />
    </node_models>
    <properties><input type="xml" src="properties.xml" /></properties>
</roaml>"""
    files = {"main.xml": main, "sender.ascxml": SENDER, "receiver.ascxml": RECEIVER, "properties.xml": PROPERTIES}
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    model = api.to_jani(api.load(str(tmp_path / "main.xml")))
    for name, probability in expected.items():
        answer = exact(model, name)
        assert (answer.least, answer.greatest) == pytest.approx((float(probability), float(probability)), abs=1e-5)
