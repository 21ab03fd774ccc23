# SPDX-License-Identifier: Apache-2.0
"""Systems whose traces end in different ways."""

from __future__ import annotations

from fixture import split_files

PROPERTY = """\
{"properties": [{"name": "delivered", "expression": {"op": "filter", "fun": "values",
  "values": {"op": "Pmin", "exp": {"op": "F", "exp": "topic_delivered_msg.valid"}}, "states": {"op": "initial"}}}]}
"""


def _switch(name: str, timer: str, rate: float, states: tuple[str, str]) -> str:
    """The file of a machine that a timer moves between two states."""
    one, other = states
    return f"""\
-- {name.lower()}.ascxml --
<ascxml name="{name}" version="1.0" initial="{one}">
    <ros_time_rate name="{timer}" rate_hz="{rate}" />
    <state id="{one}">
        <ros_rate_callback name="{timer}" target="{other}" />
    </state>
    <state id="{other}">
        <ros_rate_callback name="{timer}" target="{one}" />
    </state>
</ascxml>
"""


HOSPITAL = (
    """\
-- main.xml --
<roaml>
    <parameters>
        <max_time value="20" unit="s" />
        <bt_tick_rate value="1.0" />
    </parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="battery_ok.ascxml" />
        <input type="bt-plugin-ascxml" src="fetch.ascxml" />
        <input type="bt-plugin-ascxml" src="deliver.ascxml" />
    </behavior_tree>
    <node_models>
        <input type="node-ascxml" src="battery.ascxml" />
        <input type="node-ascxml" src="pharmacy.ascxml" />
        <input type="node-ascxml" src="door.ascxml" />
        <input type="node-ascxml" src="lift.ascxml" />
        <input type="node-ascxml" src="nurse.ascxml" />
    </node_models>
    <properties>
        <input type="jani" src="properties.jani" />
    </properties>
</roaml>
-- tree.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Ward">
        <Sequence>
            <BatteryOk />
            <Fetch />
            <Deliver />
        </Sequence>
    </BehaviorTree>
</root>
-- battery_ok.ascxml --
<ascxml name="BatteryOk" version="1.0" initial="watch">
    <datamodel>
        <data id="level" type="int32" expr="100" />
    </datamodel>
    <ros_topic_subscriber name="level" topic="/level" type="std_msgs/Int32" />
    <state id="watch">
        <ros_topic_callback name="level" target="watch">
            <assign location="level" expr="_msg.data" />
        </ros_topic_callback>
        <bt_tick target="watch" cond="level &gt; 20">
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_tick target="watch">
            <bt_return_status status="FAILURE" />
        </bt_tick>
        <bt_halt target="watch">
            <bt_return_halted />
        </bt_halt>
    </state>
</ascxml>
-- fetch.ascxml --
<ascxml name="Fetch" version="1.0" initial="ready">
    <ros_service_client name="prepare" service_name="/ward/prepare" type="std_srvs/Trigger" />
    <state id="ready">
        <bt_tick target="asked">
            <ros_service_send_request name="prepare" />
        </bt_tick>
        <bt_halt target="ready">
            <bt_return_halted />
        </bt_halt>
    </state>
    <state id="asked">
        <ros_service_handle_response name="prepare" target="ready">
            <bt_return_status status="SUCCESS" />
        </ros_service_handle_response>
    </state>
</ascxml>
-- deliver.ascxml --
<ascxml name="Deliver" version="1.0" initial="ready">
    <ros_topic_publisher name="delivered" topic="/delivered" type="std_msgs/Bool" />
    <state id="ready">
        <bt_tick target="ready">
            <ros_topic_publish name="delivered"><field name="data" expr="true" /></ros_topic_publish>
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="ready">
            <bt_return_halted />
        </bt_halt>
    </state>
</ascxml>
-- battery.ascxml --
<ascxml name="Battery" version="1.0" initial="use">
    <datamodel>
        <data id="level" type="int32" expr="100" />
    </datamodel>
    <ros_topic_publisher name="level" topic="/level" type="std_msgs/Int32" />
    <ros_time_rate name="drain" rate_hz="1" />
    <state id="use">
        <ros_rate_callback name="drain" target="use">
            <assign location="level" expr="Math.max(level - 1, 0)" />
            <ros_topic_publish name="level"><field name="data" expr="level" /></ros_topic_publish>
        </ros_rate_callback>
    </state>
</ascxml>
-- pharmacy.ascxml --
<ascxml name="Pharmacy" version="1.0" initial="free">
    <ros_service_server name="prepare" service_name="/ward/prepare" type="std_srvs/Trigger" />
    <ros_time_rate name="dispense" rate_hz="0.5" />
    <state id="free">
        <ros_service_handle_request name="prepare" target="busy" />
    </state>
    <state id="busy">
        <ros_rate_callback name="dispense" target="free">
            <ros_service_send_response name="prepare">
                <field name="success" expr="true" />
                <field name="message" expr="'ready'" />
            </ros_service_send_response>
        </ros_rate_callback>
    </state>
</ascxml>
"""
    + _switch("Door", "draught", 0.2, ("open", "shut"))
    + _switch("Lift", "move", 0.25, ("down", "up"))
    + """\
-- nurse.ascxml --
<ascxml name="Nurse" version="1.0" initial="wait">
    <ros_topic_subscriber name="delivered" topic="/delivered" type="std_msgs/Bool" />
    <state id="wait">
        <ros_topic_callback name="delivered" target="happy" />
    </state>
    <state id="happy" />
</ascxml>
-- properties.jani --
"""
    + PROPERTY
)
"""Eight machines. `Fetch` answers its tick when the pharmacy responds, which responds when time passes."""

_ANSWERS_AT_ONCE = """\
<ascxml name="Fetch" version="1.0" initial="ready">
    <ros_service_client name="prepare" service_name="/ward/prepare" type="std_srvs/Trigger" />
    <state id="ready">
        <bt_tick target="asked">
            <ros_service_send_request name="prepare" />
            <bt_return_status status="RUNNING" />
        </bt_tick>
        <bt_halt target="ready">
            <bt_return_halted />
        </bt_halt>
    </state>
    <state id="asked">
        <ros_service_handle_response name="prepare" target="fetched" />
        <bt_tick target="asked">
            <bt_return_status status="RUNNING" />
        </bt_tick>
        <bt_halt target="asked">
            <bt_return_halted />
        </bt_halt>
    </state>
    <state id="fetched">
        <bt_tick target="ready">
            <bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="fetched">
            <bt_return_halted />
        </bt_halt>
    </state>
</ascxml>
"""


def hospital(*, mended: bool = False) -> dict[str, str]:
    """File name -> text.

    Args:
        mended: whether `Fetch` returns RUNNING, and SUCCESS at a later tick.
    """
    files = split_files(HOSPITAL)
    return {**files, "fetch.ascxml": _ANSWERS_AT_ONCE} if mended else files


_PROPERTIES = '<properties><input type="jani" src="properties.jani" /></properties>'


def system(machines: dict[str, str], tree: str = "", more: str = "") -> dict[str, str]:
    """File name -> text of a system.

    Args:
        machines: name -> the content of its `<ascxml>`, preceded by the name of the initial state. The names of plugins
            are those in the tree.
        tree: the content of its `<BehaviorTree>`; "" for no tree.
        more: parameters besides `max_time`.
    """
    files = {}
    for name, inside in machines.items():
        initial, _, body = inside.partition("\n")
        files[f"{name}.ascxml"] = f'<ascxml name="{name}" version="1.0" initial="{initial}">\n{body}</ascxml>\n'
    plugins = [name for name in machines if f"<{name} " in tree or f"<{name}/" in tree]
    listed = "".join(f'<input type="bt-plugin-ascxml" src="{name}.ascxml" />' for name in plugins)
    if tree:
        files["tree.xml"] = f'<root BTCPP_format="4">\n<BehaviorTree ID="T">\n{tree}\n</BehaviorTree>\n</root>\n'
        listed = f'<behavior_tree><input type="bt.cpp-xml" src="tree.xml" />{listed}</behavior_tree>'
    nodes = "".join(f'<input type="node-ascxml" src="{name}.ascxml" />' for name in machines if name not in plugins)
    nodes = f"<node_models>{nodes}</node_models>" if nodes else ""
    parameters = f'<parameters><max_time value="5" unit="s" />{more}</parameters>'
    files["main.xml"] = f"<roaml>{parameters}{listed}{nodes}{_PROPERTIES}</roaml>\n"
    files["properties.jani"] = '{"properties": []}\n'
    return files


CROSSED = system(
    {
        name: f"""go
<ros_service_client name="ask" service_name="/{asked}" type="std_srvs/Empty" />
<ros_service_server name="serve" service_name="/{served}" type="std_srvs/Empty" />
<state id="go"><transition target="wait"><ros_service_send_request name="ask" /></transition></state>
<state id="wait"><ros_service_handle_response name="ask" target="free" /></state>
<state id="free">
<ros_service_handle_request name="serve" target="free"><ros_service_send_response name="serve" />
</ros_service_handle_request>
</state>
"""
        for name, asked, served in (("A", "b", "a"), ("B", "a", "b"))
    }
)
"""Each machine sends a request to the other one, and serves after it was answered. There is no clock."""
