# SPDX-License-Identifier: Apache-2.0
"""The machines of `Switch2` to `Switch6`. They tick the child whose case equals a variable; if no case does, the last
child."""

from __future__ import annotations


def switch(name: str, cases: int, type_: str) -> str:
    """The document for a switch with `cases` cases. Its ports have the HL-SCXML type `type_`, string or an integer
    type."""
    keys = ["variable", *(f"case_{i + 1}" for i in range(cases))]
    ports = "".join(f'<bt_declare_port_in key="{key}" type="{type_}"/>' for key in keys)
    initial = "''" if type_ == "string" else "0"
    data = "".join(f'<data id="{key}" type="{type_}" expr="{initial}"/>' for key in keys)
    fetch = "".join(f'<assign location="{key}"><expr><bt_get_input key="{key}"/></expr></assign>' for key in keys)
    choices = "".join(_choice(f'cond="variable == case_{i + 1}"', i) for i in range(cases)) + _choice("", cases)
    return f"""
<ascxml name="{name}" version="1.0" initial="init">
    <bt_declare_port_in key="CHILDREN_COUNT" type="int16"/>{ports}
    <datamodel>
        <data id="children_count" type="int16"><expr><bt_get_input key="CHILDREN_COUNT"/></expr></data>
        <data id="child" type="int16" expr="0"/>
        <data id="running" type="int16" expr="-1"/>
        {data}
    </datamodel>
    <state id="init">
        <transition cond="children_count != {cases + 1}" target="error"/>
        <transition target="waiting"/>
    </state>
    <state id="waiting">
        <bt_tick target="choosing">{fetch}</bt_tick>
        <bt_halt target="resetting">
            <assign location="child" expr="0"/>
            <bt_halt_child id="child"/>
        </bt_halt>
    </state>
    <state id="choosing">{choices}</state>
    <state id="chosen">
        <transition cond="running &gt;= 0 &amp;&amp; running != child" target="changing">
            <bt_halt_child id="running"/>
        </transition>
        <transition target="ticking"><bt_tick_child id="child"/></transition>
    </state>
    <state id="changing">
        <bt_child_halted id="running" target="ticking"><bt_tick_child id="child"/></bt_child_halted>
    </state>
    <state id="ticking">
        <bt_child_status id="child" cond="_bt.status == SUCCESS" target="waiting">
            <assign location="running" expr="-1"/>
            <bt_return_status status="SUCCESS"/>
        </bt_child_status>
        <bt_child_status id="child" cond="_bt.status == FAILURE" target="waiting">
            <assign location="running" expr="-1"/>
            <bt_return_status status="FAILURE"/>
        </bt_child_status>
        <bt_child_status id="child" cond="_bt.status == RUNNING" target="waiting">
            <assign location="running" expr="child"/>
            <bt_return_status status="RUNNING"/>
        </bt_child_status>
    </state>
    <state id="resetting">
        <bt_child_halted id="child" target="resetting">
            <assign location="child" expr="child + 1"/>
            <if cond="child &lt; children_count"><bt_halt_child id="child"/></if>
        </bt_child_halted>
        <transition cond="child &gt;= children_count" target="waiting">
            <assign location="running" expr="-1"/>
            <bt_return_halted/>
        </transition>
    </state>
    <state id="error"/>
</ascxml>
"""


def _choice(condition: str, child: int) -> str:
    return f'<transition {condition} target="chosen"><assign location="child" expr="{child}"/></transition>'
