# SPDX-License-Identifier: Apache-2.0
"""The nodes of Nav2 agree with the model file that Nav2 ships: names, kinds, directions, types and defaults."""

from __future__ import annotations

from lxml import etree

import conformance
from roaml.libraries import Node, library

MODEL = conformance.ROOT / "trees" / "nav2" / "nav2_tree_nodes.xml"

EARLIER = {"IsPathValid"}
"""The nodes of earlier versions of Nav2, from Humble to Kilted, that the newest one does not have."""


def test_nav2_agrees_with_its_own_model() -> None:
    model = etree.parse(str(MODEL)).getroot().find("TreeNodesModel")
    assert model is not None
    theirs = {e.get("ID"): (e.tag, _ports(e)) for e in model if isinstance(e.tag, str)}
    ours = {node.name: (node.kind.value.capitalize(), _own_ports(node)) for node in library("nav2").nodes.values()}
    assert ours.keys() == theirs.keys() | EARLIER
    for name, facts in theirs.items():
        assert ours[name] == facts, name


def _ports(element: etree._Element) -> dict[str, tuple[str, str | None, str]]:
    directions = {"input_port": "in", "output_port": "out", "bidirectional_port": "inout"}
    return {
        port.get("name"): (
            directions[port.tag],
            port.get("type"),
            port.get("default", "").strip('"').replace("numeric_limits<double>::infinity()", "inf"),
        )
        for port in element
    }


def _own_ports(node: Node) -> dict[str, tuple[str, str, str]]:
    return {port.name: (port.direction.value, port.type, port.default or "") for port in node.ports}
