# SPDX-License-Identifier: Apache-2.0
"""Random systems that contain what those of users contain: strings that are compared in long chains of guards, arrays
in guards, several timers in one machine, copies of a machine, and many
machines.

Each system answers by hand: the sign announces each place of its list once, in an order without chance, so that each
guide, which is a copy of the others, has seen all of them at the end (`p_all_seen`), and no guide is ever lost
(`p_never_lost`). The property `p_first` has the probability of the chance that the sign draws at the start.
"""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from typing import Any

WORDS = ("kitchen", "kit", "office", "lab", "hall", "home", "lobby", "archive", "a", "garden")
CHANCES = (0.25, 0.5, 0.125)


class Generated:
    """A system: its files, and the values of its properties that follow from its construction."""

    def __init__(self, files: dict[str, str], values: dict[str, float]) -> None:
        self.files, self.values = files, values

    def write(self, folder: Path) -> Path:
        """Write the files; return the system file."""
        for name, text in self.files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        return folder / "main.xml"


def generate(seed: int, guides: int) -> Generated:
    """A system with a sign, an archive, and `guides` guides."""
    random = Random(seed)
    places = random.sample(WORDS, random.randint(4, min(8, len(WORDS))))
    chance = random.choice(CHANCES)
    files = {"sign.ascxml": _sign(places, chance), "archive.ascxml": _archive(places)}
    for number in range(guides):
        files[f"guide_{number}.ascxml"] = _guide(f"Guide{number}", number, places, random)
    inputs = "".join(f'        <input type="node-ascxml" src="{name}" />\n' for name in files)
    files["main.xml"] = MAIN.format(seconds=len(places) + 2, inputs=inputs)
    last = guides - 1
    seen = _equals(f"topic_seen_{last}_msg__ros_fields__data", len(places))
    lost = f"topic_lost_{last}_msg.valid"
    first = _equals("topic_coin_msg__ros_fields__data", 1)
    properties = {
        "p_all_seen": _eventually(_and(f"topic_seen_{last}_msg.valid", seen)),
        "p_never_lost": {"op": "G", "exp": {"op": "¬", "exp": lost}},
        "p_first": _eventually(_and("topic_coin_msg.valid", first)),
    }
    files["properties.jani"] = json.dumps({"properties": [_property(*item) for item in properties.items()]}, indent=1)
    return Generated(files, {"p_all_seen": 1.0, "p_never_lost": 1.0, "p_first": chance})


MAIN = """<roaml>
    <parameters><max_time value="{seconds}" unit="s" /><max_array_size value="16" /></parameters>
    <node_models>
{inputs}    </node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
"""


def _sign(places: list[str], chance: float) -> str:
    """Announces one place a second, and draws a coin once."""
    states = ""
    for number, place in enumerate(places):
        published = f'<ros_topic_publish name="place"><field name="data" expr="\'{place}\'" /></ros_topic_publish>'
        states += f"""
    <state id="at_{number}">
        <ros_rate_callback name="second" target="at_{number + 1}">{published}</ros_rate_callback>
    </state>"""
    return f"""<ascxml name="Sign" version="1.0" initial="start">
    <ros_topic_publisher name="place" topic="/place" type="std_msgs/String" />
    <ros_topic_publisher name="coin" topic="/coin" type="std_msgs/Int32" />
    <ros_time_rate name="second" rate_hz="1" />
    <state id="start">
        <ros_rate_callback name="second">
            <target id="at_0" prob="{chance}"><ros_topic_publish name="coin"><field name="data" expr="1" />
            </ros_topic_publish></target>
            <target id="at_0"><ros_topic_publish name="coin"><field name="data" expr="2" />
            </ros_topic_publish></target>
        </ros_rate_callback>
    </state>{states}
    <state id="at_{len(places)}" />
</ascxml>
"""


def _archive(places: list[str]) -> str:
    """Listens to the coin, and to all places by one long condition."""
    known = " || ".join(f"_msg.data == '{place}'" for place in places)
    return f"""<ascxml name="Archive" version="1.0" initial="open">
    <datamodel><data id="known" type="int32" expr="0" /><data id="side" type="int32" expr="0" /></datamodel>
    <ros_topic_subscriber name="place" topic="/place" type="std_msgs/String" />
    <ros_topic_subscriber name="coin" topic="/coin" type="std_msgs/Int32" />
    <state id="open">
        <ros_topic_callback name="coin" target="open"><assign location="side" expr="_msg.data" /></ros_topic_callback>
        <ros_topic_callback name="place" cond="{_escaped(known)}" target="open">
            <assign location="known" expr="Math.min(known + 1, 9)" />
        </ros_topic_callback>
        <ros_topic_callback name="place" cond="{_escaped(f"!({known})")}" target="open" />
    </state>
</ascxml>
"""


def _guide(name: str, number: int, places: list[str], random: Random) -> str:
    """Compares the place with all constants in one state, counts in an array, and has two timers."""
    counts = "".join("0, " for _ in places).rstrip(", ")
    handlers = ""
    for at, place in enumerate(random.sample(places, len(places))):
        extra = random.choice(("", f" &amp;&amp; counts[{at}] == 0", " &amp;&amp; total &lt; 20"))
        handlers += f"""
        <ros_topic_callback name="place" cond="_msg.data == '{place}'{extra}" target="here">
            <assign location="counts[{at}]" expr="counts[{at}] + 1" />
            <assign location="seen" expr="_msg.data" />
            <assign location="total" expr="total + 1" />
            <ros_topic_publish name="seen"><field name="data" expr="total" /></ros_topic_publish>
        </ros_topic_callback>"""
    lost = " &amp;&amp; ".join(f"_msg.data != '{place}'" for place in places)
    full = " &amp;&amp; ".join(f"counts[{at}] == 1" for at in range(len(places)))
    return f"""<ascxml name="{name}" version="1.0" initial="here">
    <datamodel>
        <data id="counts" type="int32[{len(places)}]" expr="[{counts}]" />
        <data id="seen" type="string" expr="'none'" />
        <data id="total" type="int32" expr="0" />
        <data id="full" type="bool" expr="false" />
        <data id="beat" type="bool" expr="false" />
    </datamodel>
    <ros_topic_subscriber name="place" topic="/place" type="std_msgs/String" />
    <ros_topic_publisher name="seen" topic="/seen_{number}" type="std_msgs/Int32" />
    <ros_topic_publisher name="lost" topic="/lost_{number}" type="std_msgs/Bool" />
    <ros_time_rate name="check" rate_hz="1" />
    <ros_time_rate name="beat" rate_hz="0.5" />
    <state id="here">
        <ros_rate_callback name="check" cond="{full}" target="here">
            <assign location="full" expr="true" />
        </ros_rate_callback>
        <ros_rate_callback name="beat" target="here">
            <assign location="beat" expr="!beat" />
        </ros_rate_callback>{handlers}
        <ros_topic_callback name="place" cond="{lost}" target="here">
            <ros_topic_publish name="lost"><field name="data" expr="true" /></ros_topic_publish>
        </ros_topic_callback>
    </state>
</ascxml>
"""


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def _equals(name: str, value: int) -> dict[str, Any]:
    return {"op": "=", "left": name, "right": value}


def _and(left: Any, right: Any) -> dict[str, Any]:
    return {"op": "∧", "left": left, "right": right}


def _eventually(condition: Any) -> dict[str, Any]:
    return {"op": "F", "exp": condition}


def _property(name: str, path: Any) -> dict[str, Any]:
    value = {"op": "Pmin", "exp": path}
    return {
        "name": name,
        "expression": {"op": "filter", "fun": "values", "values": value, "states": {"op": "initial"}},
    }
