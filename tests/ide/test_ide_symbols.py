# SPDX-License-Identifier: Apache-2.0
"""The outline: above `----` a file, below it each symbol as `name (kind): detail`."""

from __future__ import annotations

from collections.abc import Iterator
from textwrap import dedent

import pytest
from ide_case import one_file

from roaml.ide.navigation.document_symbol import DocumentSymbol
from roaml.ide.navigation.document_symbols import document_symbols

CASES = {
    "machine": """
        <ascxml name="Robot" initial="s">
            <datamodel><data id="x" type="int8" expr="0" /></datamodel>
            <bt_declare_port_in key="level" type="uint8" />
            <ros_topic_publisher name="🤖" topic="/t" type="std_msgs/UInt8" />
            <ros_service_server name="here" type="std_srvs/Empty">
                <service_name><bt_get_input key="level" /></service_name>
            </ros_service_server>
            <ros_time_rate name="clock" rate_hz="1" />
            <state id="s">
                <transition event="go" cond="x &lt;
                    1" target="s" />
                <transition target="s" />
                <ros_rate_callback name="clock" target="t" />
                <bt_tick><target prob="0.5" state="s" /><target prob="0.5" state="t" /></bt_tick>
            </state>
            <state />
        </ascxml>
        ----
        Robot (machine)
          datamodel (datamodel)
            x (variable): int8
          level (port): in uint8
          🤖 (ROS interface): publisher /t
          here (ROS interface): service-server from a port
          clock (ROS interface): timer
          s (state)
            go (transition): [x < 1] → s
            transition (transition): → s
            ros_rate_callback clock (transition): → t
            bt_tick (transition)
          <state> (state)
        """,
    "tree": """
        <root BTCPP_format="4">
            <BehaviorTree ID="🤖">
                <Sequence name="all">
                    <Action ID="Go" name="first" />
                    <Stop />
                    <SubTree ID="Other" />
                </Sequence>
            </BehaviorTree>
            <BehaviorTree>
        </root>
        ----
        🤖 (tree)
          all (inner node of a tree): Sequence
            first (leaf of a tree): Go
            Stop (leaf of a tree)
            Other (leaf of a tree)
        <BehaviorTree> (tree)
        """,
    "system": """
        <roaml>
            <parameters><max_time value="1" unit="s" /></parameters>
            <node_models><input type="node-ascxml" src="🤖.ascxml" /><input /></node_models>
        </roaml>
        ----
        roaml (system)
          parameters (section of a system file)
          node_models (section of a system file)
            🤖.ascxml (file of a system): node-ascxml
            <input> (file of a system)
        """,
    "structs": """
        <types>
            <struct id="Point"><member id="x" type="🤖" /><member id="y" /><member /></struct>
            <struct />
        </types>
        ----
        Point (struct)
          x (member of a struct): 🤖
          y (member of a struct)
        <struct> (struct)
        """,
    "properties": """
        {"properties": [
            {"name": "🤖", "comment": "why", "expression": 1}, {"name": 1}, {"name": "half
        ----
        🤖 (property): why
        half (property)
        """,
}


@pytest.mark.parametrize("name", CASES)
def test_symbols(name: str) -> None:
    text, expected = dedent(CASES[name]).strip().split("\n----\n")
    analysis, path = one_file(text)
    symbols = document_symbols(analysis, path)
    assert "\n".join(shown(symbols, "")) == expected
    check_spans(symbols, 0, len(text))


@pytest.mark.parametrize("name", CASES)
def test_every_beginning_of_a_file_has_an_outline(name: str) -> None:
    text = dedent(CASES[name]).strip().split("\n----\n")[0]
    for length in range(0, len(text), 3):
        analysis, path = one_file(text[:length])
        check_spans(document_symbols(analysis, path), 0, length)


def shown(symbols: tuple[DocumentSymbol, ...], indent: str) -> Iterator[str]:
    for symbol in symbols:
        detail = f": {symbol.detail}" if symbol.detail else ""
        yield f"{indent}{symbol.name} ({symbol.kind.value}){detail}"
        yield from shown(symbol.children, indent + "  ")


def check_spans(symbols: tuple[DocumentSymbol, ...], start: int, end: int) -> None:
    """Each symbol is inside its parent, and its name is inside the symbol."""
    for symbol in symbols:
        assert start <= symbol.span.start <= symbol.name_span.start <= symbol.name_span.end <= symbol.span.end <= end
        assert symbol.name
        check_spans(symbol.children, *symbol.span)
