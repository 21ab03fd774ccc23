# SPDX-License-Identifier: Apache-2.0
"""Diagrams in all notations, as a whole for one small system."""

from __future__ import annotations

from pathlib import Path

import pytest

from fixture import split_files
from roaml import api
from roaml.project.settings import Settings
from roaml.views.graph import Graph, GraphLink, GraphNode, Kind
from roaml.views.machine import machine_graph
from roaml.views.network import network_graph
from roaml.views.notations import NOTATIONS
from roaml.views.tree import tree_graph

FILES = split_files(
    """\
-- main.xml --
<roaml>
    <parameters><max_time value="5" unit="s" /></parameters>
    <behavior_tree>
        <input type="bt.cpp-xml" src="tree.xml" />
        <input type="bt-plugin-ascxml" src="knock.ascxml" />
    </behavior_tree>
    <node_models><input type="node-ascxml" src="door.ascxml" /></node_models>
    <properties><input type="jani" src="properties.jani" /></properties>
</roaml>
-- tree.xml --
<root BTCPP_format="4">
    <BehaviorTree ID="Main">
        <Sequence name="enter"><Knock times="2" /><AlwaysSuccess /></Sequence>
    </BehaviorTree>
</root>
-- knock.ascxml --
<ascxml name="Knock" version="1.0" initial="ready">
    <bt_declare_port_in key="times" type="int8" />
    <datamodel><data id="n" type="int8"><expr><bt_get_input key="times" /></expr></data></datamodel>
    <state id="ready">
        <bt_tick target="ready" cond="n &gt; 0 &amp;&amp; n &lt; 9">
            <send event="knock" /><bt_return_status status="SUCCESS" />
        </bt_tick>
        <bt_halt target="ready"><bt_return_halted /></bt_halt>
    </state>
</ascxml>
-- door.ascxml --
<ascxml name="Door" version="1.0" initial="shut">
    <state id="shut">
        <transition event="knock"><target id="open" prob="0.9" /><target id="shut" /></transition>
    </state>
    <state id="open" />
</ascxml>
-- properties.jani --
{"properties": []}
"""
)


@pytest.fixture(scope="module")
def graphs() -> dict[str, Graph]:
    texts = {f"/views/{name}": text for name, text in FILES.items()}
    system = api.load("/views/main.xml", settings=Settings(), texts=texts)
    door = system.analysis.machine("/views/door.ascxml")
    linked = system.analysis.system(system.path)
    assert door is not None
    assert linked is not None
    return {
        "machine": machine_graph(door)[0],
        "tree": tree_graph(linked),
        "network": network_graph(api.to_jani(system), "main.xml"),
    }


@pytest.mark.parametrize("name", ["machine", "tree", "network"])
@pytest.mark.parametrize("notation", NOTATIONS)
def test_text(graphs: dict[str, Graph], name: str, notation: str) -> None:
    """The texts beside this file were looked at when they were written."""
    path = Path(__file__).parent / f"{name}.{NOTATIONS[notation].extension}"
    assert NOTATIONS[notation].render(graphs[name]) == path.read_text(encoding="utf-8")


HOSTILE = 'a"b\\c;d<e>{f}|g&h\u00e9'


@pytest.mark.parametrize("kind", Kind)
@pytest.mark.parametrize("notation", NOTATIONS)
def test_what_means_something_to_a_notation(notation: str, kind: Kind) -> None:
    """No name breaks out of its place: each line of the diagram keeps its form."""
    plain = Graph(kind, "t", (GraphNode("x", ("x",)), GraphNode("y", ("y",))), (GraphLink("x", "y", ("z",)),), "x")
    nodes = tuple(GraphNode(f"{HOSTILE}{n.id}", (f"{HOSTILE}{n.id}",)) for n in plain.nodes)
    hostile = Graph(kind, "t", nodes, (GraphLink(nodes[0].id, nodes[1].id, ("z",)),), nodes[0].id)
    render = NOTATIONS[notation].render
    assert render(hostile).count("\n") == render(plain).count("\n")
    assert all(line.count('"') % 2 == 0 for line in render(hostile).replace('\\"', "").splitlines())


TAGS = '<script>alert(1)</script>\n!include /etc/passwd\n    click n0 href "javascript:x"'


@pytest.mark.parametrize("kind", list(Kind))
@pytest.mark.parametrize("notation", ["mermaid", "plantuml"])
def test_names_end_neither_lines_nor_texts(notation: str, kind: Kind) -> None:
    def drawn(name: str) -> str:
        graph = Graph(kind, name, (GraphNode("a", (name,)),), (GraphLink("a", "a", (name,)),), "a")
        return NOTATIONS[notation].render(graph)

    text = drawn(TAGS)
    assert "<script" not in text
    assert text.count("\n") == drawn("name").count("\n")
