# SPDX-License-Identifier: Apache-2.0
"""Properties in XML on three systems, each with a property in JANI that was written by hand and asks the same: Storm
computes the same least and greatest probability for both, and so does the search through all states. A fourth system is
in test_translate_observers.py."""

from __future__ import annotations

import json
from collections.abc import Mapping

import pytest
from storm import exact
from test_translate_observers import hand_written, op
from translating import loaded

from roaml import api
from roaml.explicit.space import StateLimits

# ----------------------------------------------------------------- a link that loses messages

LINK = {
    "sender": """<ascxml name="Sender" version="1.0" initial="send">
    <datamodel><data id="count" type="int32" expr="0" /></datamodel>
    <ros_time_rate name="second" rate_hz="1" />
    <ros_topic_publisher name="packet" topic="/packet" type="std_msgs/Int32" />
    <ros_topic_publisher name="lost" topic="/lost" type="std_msgs/Int32" />
    <state id="send">
        <ros_rate_callback name="second">
            <target id="send" prob="0.7">
                <assign location="count" expr="count + 1" />
                <ros_topic_publish name="packet"><field name="data" expr="count" /></ros_topic_publish>
            </target>
            <target id="send">
                <ros_topic_publish name="lost"><field name="data" expr="count + 1" /></ros_topic_publish>
            </target>
        </ros_rate_callback>
    </state>
</ascxml>""",
    "receiver": """<ascxml name="Receiver" version="1.0" initial="wait">
    <ros_topic_subscriber name="packet" topic="/packet" type="std_msgs/Int32" />
    <ros_topic_publisher name="ack" topic="/ack" type="std_msgs/Int32" />
    <state id="wait">
        <ros_topic_callback name="packet">
            <target id="wait" prob="0.8">
                <ros_topic_publish name="ack"><field name="data" expr="_msg.data" /></ros_topic_publish>
            </target>
            <target id="wait" />
        </ros_topic_callback>
    </state>
</ascxml>""",
}
LINK_PORTS = """
<ros_topic topic_name="/packet" type="std_msgs/Int32" event="publish">
    <event_var id="sent" /><state_var id="n" type="int32" field="data" expr="0" /></ros_topic>
<ros_topic topic_name="/lost" type="std_msgs/Int32" event="publish">
    <event_var id="lost" /><state_var id="missing" type="int32" field="data" expr="0" /></ros_topic>
<ros_topic topic_name="/ack" type="std_msgs/Int32" event="publish">
    <event_var id="ack" /><state_var id="m" type="int32" field="data" expr="0" /></ros_topic>"""
SENT, LOST, ACK = (f"topic_{name}_msg.valid" for name in ("packet", "lost", "ack"))
N, MISSING, M = (f"topic_{name}_msg__ros_fields__data" for name in ("packet", "lost", "ack"))

# --------------------------------------------------- two machines that race, and a random start

RACE = {
    "hare": """<ascxml name="Hare" version="1.0" initial="run">
    <datamodel><data id="way" type="int32" expr="0" /></datamodel>
    <ros_time_rate name="second" rate_hz="1" />
    <ros_topic_publisher name="hare" topic="/hare" type="std_msgs/Int32" />
    <state id="run">
        <ros_rate_callback name="second" cond="way &lt; 4">
            <target id="run" prob="0.5">
                <assign location="way" expr="way + 2" />
                <ros_topic_publish name="hare"><field name="data" expr="way" /></ros_topic_publish>
            </target>
            <target id="run" />
        </ros_rate_callback>
    </state>
</ascxml>""",
    "tortoise": """<ascxml name="Tortoise" version="1.0" initial="walk">
    <datamodel><data id="way" type="int32" expr="0" /></datamodel>
    <ros_time_rate name="second" rate_hz="1" />
    <ros_topic_publisher name="tortoise" topic="/tortoise" type="std_msgs/Int32" />
    <state id="walk">
        <ros_rate_callback name="second" cond="way &lt; 4" target="walk">
            <assign location="way" expr="way + 1" />
            <ros_topic_publish name="tortoise"><field name="data" expr="way" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>""",
}
RACE_PORTS = """
<ros_topic topic_name="/hare" type="std_msgs/Int32" event="publish">
    <event_var id="hops" /><state_var id="hare" type="int32" field="data" expr="0" /></ros_topic>
<ros_topic topic_name="/tortoise" type="std_msgs/Int32" event="publish">
    <event_var id="steps" /><state_var id="tortoise" type="int32" field="data" expr="0" /></ros_topic>"""
HARE, TORTOISE = "topic_hare_msg__ros_fields__data", "topic_tortoise_msg__ros_fields__data"

# ------------------------------------------------------------------- a tree and a service

WARD = {
    "desk": """<ascxml name="Desk" version="1.0" initial="open">
    <ros_service_server name="ask" service_name="/ask" type="std_srvs/SetBool" />
    <state id="open">
        <ros_service_handle_request name="ask">
            <target id="open" prob="0.6">
                <ros_service_send_response name="ask"><field name="success" expr="true" />
                    <field name="message" expr="'yes'" /></ros_service_send_response>
            </target>
            <target id="open">
                <ros_service_send_response name="ask"><field name="success" expr="false" />
                    <field name="message" expr="'no'" /></ros_service_send_response>
            </target>
        </ros_service_handle_request>
    </state>
</ascxml>""",
}
ASK = """<ascxml name="Ask" version="1.0" initial="ready">
    <ros_service_client name="ask" service_name="/ask" type="std_srvs/SetBool" />
    <state id="ready">
        <bt_tick target="asked"><ros_service_send_request name="ask"><field name="data" expr="true" />
            </ros_service_send_request></bt_tick>
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
    <state id="asked">
        <ros_service_handle_response name="ask" cond="_res.success">
            <target id="ready" prob="0.5"><bt_return_status status="SUCCESS" /></target>
            <target id="ready"><bt_return_status status="RUNNING" /></target>
        </ros_service_handle_response>
        <ros_service_handle_response name="ask" cond="!_res.success" target="ready">
            <bt_return_status status="FAILURE" />
        </ros_service_handle_response>
    </state>
</ascxml>"""
TREE = """<root BTCPP_format="4"><BehaviorTree ID="Main">
    <RetryUntilSuccessful num_attempts="2"><Ask name="ask" /></RetryUntilSuccessful>
</BehaviorTree></root>"""
WARD_PORTS = """
<ros_service service_name="/ask" type="std_srvs/SetBool" event="request"><event_var id="asked" /></ros_service>
<ros_service service_name="/ask" type="std_srvs/SetBool" event="response">
    <event_var id="answered" /><state_var id="agreed" type="bool" field="success" expr="false" /></ros_service>
<bt_node node="ask" event="response">
    <event_var id="returned" /><state_var id="status" type="int32" field="status" expr="0" /></bt_node>"""
AGREED = "srv_ask_response_client_BT_plugin_1001_ask__ros_fields__success"
ANSWERED = "srv_ask_response_client_BT_plugin_1001_ask.valid"
STATUS = "bt_1001_response__status"


def files(system: str, guarantees: str, written_formulas: list[object]) -> dict[str, str]:
    machines = {"link": LINK, "race": RACE, "ward": WARD}[system]
    ports = {"link": LINK_PORTS, "race": RACE_PORTS, "ward": WARD_PORTS}[system]
    nodes = "".join(f'<input type="node-ascxml" src="{name}.ascxml" />' for name in machines)
    tree = '<behavior_tree><input type="bt.cpp-xml" src="tree.xml" />'
    tree += '<input type="bt-plugin-ascxml" src="ask.ascxml" /></behavior_tree>'
    main = f"""<roaml>
    <parameters><max_time value="{3 if system == "ward" else 5}" unit="s" /></parameters>
    {tree if system == "ward" else ""}<node_models>{nodes}</node_models>
    <properties><input type="xml" src="properties.xml" /><input type="jani" src="twins.jani" /></properties>
</roaml>"""
    return {
        "main.xml": main,
        "tree.xml": TREE,
        "ask.ascxml": ASK,
        **{f"{name}.ascxml": text for name, text in machines.items()},
        "properties.xml": f"<properties><ports>{ports}</ports><guarantees>{guarantees}</guarantees></properties>",
        "twins.jani": json.dumps({"properties": written_formulas}),
    }


def pattern(name: str, *events: str, scope: str = 'type="globally"', time: str = "") -> str:
    written = "".join(f"<event>{event}</event>" for event in events)
    written = f"<events>{written}</events>" if len(events) > 1 else written
    interval = f"<time_interval {time} />" if time else ""
    return f'<property id="p" pattern="{name}">{written}<scope {scope} />{interval}</property>'


def weak_until(left: object, right: object) -> dict[str, object]:
    """Storm does not read W."""
    return op("∨", op("G", left), op("U", left, right))


def equal(variable: str, value: object) -> dict[str, object]:
    return op("=", variable, value)


SECOND = "topic_clock_msg__ros_fields__sec"
EQUIVALENTS: Mapping[tuple[str, str], tuple[str, object]] = {
    ("link", "existence"): (pattern("existence", "ack &amp;&amp; m == 3"), op("F", equal(M, 3))),
    ("link", "absence"): (pattern("absence", "lost"), op("G", op("¬", LOST))),
    ("link", "universality"): (pattern("universality", "missing &lt; 3"), op("G", op("<", MISSING, 3))),
    ("link", "precedence"): (pattern("precedence", "ack", "lost"), weak_until(op("¬", LOST), ACK)),
    ("link", "absence until"): (
        pattern("absence", "lost", scope='type="until" event="n == 3"'),
        weak_until(op("¬", LOST), equal(N, 3)),
    ),
    ("link", "absence before"): (
        pattern("absence", "lost", scope='type="before" event="n == 3"'),
        op("⇒", op("F", equal(N, 3)), op("U", op("¬", LOST), equal(N, 3))),
    ),
    ("link", "existence until"): (
        pattern("existence", "ack", scope='type="until" event="lost"'),
        op("U", op("¬", LOST), ACK),
    ),
    ("link", "response of numbers"): (
        pattern("response", "n == 2", "m == 2 || m == 3"),
        op("G", op("⇒", equal(N, 2), op("F", op("∨", equal(M, 2), equal(M, 3))))),
    ),
    ("link", "universality after"): (
        pattern("universality", "missing &lt; 3", scope='type="after" event="m == 1"'),
        op("G", op("⇒", equal(M, 1), op("G", op("<", MISSING, 3)))),
    ),
    ("link", "existence in time"): (
        pattern("existence", "n == 2", time='time="3" time_unit="s"'),
        op("F", op("∧", equal(N, 2), op("≤", SECOND, 3))),
    ),
    ("link", "absence in time"): (
        pattern("absence", "lost", time='time="2500" time_unit="ms"'),
        op("U", op("∧", op("¬", LOST), op("≤", SECOND, 2)), op("≥", SECOND, 3)),
    ),
    ("link", "formula"): (
        '<property id="p" logic="pmtl" expr="{ n == 3 } -&gt; O { ack }" />',
        weak_until(op("≠", N, 3), ACK),
    ),
    ("race", "who is first"): (
        pattern("precedence", "steps", "hops"),
        weak_until(equal(HARE, 0), op(">", TORTOISE, 0)),
    ),
    ("race", "who wins"): (
        pattern("absence", "hare == 4", scope='type="until" event="tortoise == 4"'),
        weak_until(op("<", HARE, 4), equal(TORTOISE, 4)),
    ),
    ("race", "never behind"): (
        pattern("universality", "hare &gt;= tortoise - 1"),
        op("G", op("≥", HARE, op("-", TORTOISE, 1))),
    ),
    ("race", "ahead"): (pattern("existence", "hare == tortoise + 1"), op("F", equal(HARE, op("+", TORTOISE, 1)))),
    ("race", "ahead before the end"): (
        pattern("existence", "hare &gt; tortoise", scope='type="before" event="tortoise == 4"'),
        op(
            "⇒",
            op("F", equal(TORTOISE, 4)),
            op("U", op("≠", TORTOISE, 4), op("∧", op("≠", TORTOISE, 4), op(">", HARE, TORTOISE))),
        ),
    ),
    ("race", "caught up"): (
        pattern("response", "hare &gt; tortoise", "hare &lt;= tortoise"),
        op("G", op("⇒", op(">", HARE, TORTOISE), op("F", op("≤", HARE, TORTOISE)))),
    ),
    ("race", "after the first hop"): (
        pattern("absence", "hare == tortoise", scope='type="after" event="hare == 2"'),
        op("G", op("⇒", equal(HARE, 2), op("G", op("≠", HARE, TORTOISE)))),
    ),
    ("race", "both in time"): (
        pattern("existence", "hare == 4", time='time="3" time_unit="s"'),
        op("F", op("∧", equal(HARE, 4), op("≤", SECOND, 3))),
    ),
    ("ward", "agreed"): (pattern("existence", "agreed"), op("F", AGREED)),
    ("ward", "disagreed"): (
        pattern("absence", "answered &amp;&amp; !agreed"),
        op("G", op("∨", op("¬", ANSWERED), AGREED)),
    ),
    ("ward", "success"): (pattern("existence", "returned &amp;&amp; status == 1"), op("F", equal(STATUS, 1))),
    ("ward", "no failure"): (pattern("universality", "status != 2"), op("G", op("≠", STATUS, 2))),
    ("ward", "running first"): (
        pattern("precedence", "status == 3", "status == 1"),
        weak_until(op("≠", STATUS, 1), equal(STATUS, 3)),
    ),
    ("ward", "success after failure"): (
        pattern("response", "status == 2", "status == 1"),
        op("G", op("⇒", equal(STATUS, 2), op("F", equal(STATUS, 1)))),
    ),
    ("ward", "agreed until running"): (
        pattern("universality", "status != 2", scope='type="until" event="status == 3"'),
        weak_until(op("≠", STATUS, 2), equal(STATUS, 3)),
    ),
    ("ward", "running only once agreed"): (
        pattern("precedence", "agreed", "status == 1"),
        weak_until(op("≠", STATUS, 1), AGREED),
    ),
}
CERTAIN = {("race", "caught up"), ("ward", "running only once agreed")}
"""All others have values between 0 and 1."""


@pytest.mark.parametrize("key", EQUIVALENTS, ids=" ".join)
def test_storm_and_the_search_give_the_values_of_the_twin(key: tuple[str, str]) -> None:
    in_xml, in_jani = EQUIVALENTS[key]
    source = loaded(files(key[0], in_xml, [hand_written("twin", in_jani)]))
    model = api.to_jani(source)
    by_hand, observed = exact(model, "twin"), exact(model, "p")
    assert observed.least == pytest.approx(by_hand.least, abs=1e-6)
    assert observed.greatest == pytest.approx(by_hand.greatest, abs=1e-6)
    verifier = api.verifier(source, ["p"])
    values = verifier.exhaustive(verifier.checker.compiled_properties[0], StateLimits()).exact
    assert values is not None
    assert values.minimum.lower == pytest.approx(by_hand.least, abs=1e-5)
    assert values.maximum.upper == pytest.approx(by_hand.greatest, abs=1e-5)
    assert (0 < by_hand.least < 1 or 0 < by_hand.greatest < 1) == (key not in CERTAIN)
