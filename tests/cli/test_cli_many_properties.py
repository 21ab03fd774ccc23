# SPDX-License-Identifier: Apache-2.0
"""A system with many properties, each of which depends on a small part of it."""

from __future__ import annotations

from pathlib import Path

from command import Command

MACHINE = """<ascxml name="Dice" version="1.0" initial="wait">
    <ros_topic_publisher name="rolled" topic="/rolled" type="std_msgs/Int32" />
    <ros_time_rate name="roll" rate_hz="1" />
    <datamodel><data id="total" type="int32" expr="0" /></datamodel>
    <state id="wait">
        <ros_rate_callback name="roll" cond="total &lt; 4">
            <target id="wait" prob="0.5"><assign location="total" expr="total + 1" />
                <ros_topic_publish name="rolled"><field name="data" expr="total" /></ros_topic_publish></target>
            <target id="wait" />
        </ros_rate_callback>
    </state>
</ascxml>"""
COUNT = 60


def test_each_of_many_properties_is_answered_exactly(command: Command, tmp_path: Path) -> None:
    """The preparation of a search counts as much as the part of the model that it needs, not as all observers."""
    guarantees = "".join(
        f'<property id="p{number}" pattern="response"><events><event>rolled &amp;&amp; total == {number % 3}</event>'
        f"<event>rolled &amp;&amp; total == {number % 3 + 1}</event></events>"
        f'<scope type="between" event="total == {number % 2}" until="total == {number % 3 + 2}" /></property>'
        for number in range(COUNT)
    )
    files = {
        "main.xml": '<roaml><parameters><max_time value="5" unit="s" reaction_time="instant" /></parameters>'
        '<node_models><input type="node-ascxml" src="dice.ascxml" /></node_models>'
        '<properties><input type="xml" src="p.xml" /></properties></roaml>',
        "dice.ascxml": MACHINE,
        "p.xml": '<properties><ports><ros_topic topic_name="/rolled" type="std_msgs/Int32" event="publish">'
        '<event_var id="rolled" /><state_var id="total" type="int32" field="data" expr="0" /></ros_topic></ports>'
        f"<guarantees>{guarantees}</guarantees></properties>",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    done = command("verify", "main.xml")
    text = done.out
    assert not done.err
    assert "minimum undecided" not in text
    assert text.count(", exact, ") == COUNT
