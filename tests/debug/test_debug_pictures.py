# SPDX-License-Identifier: Apache-2.0
"""What a client shows beside the source: the timeline of the run, and the active parts of pictures."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from dap_client import Client

from roaml import api
from roaml.ide.diagrams import DiagramKind, picture_of

ROOT = Path(__file__).resolve().parents[2]
ROBOT = ROOT / "examples" / "assembly_robot"
BUG = ROBOT / "main_with_bug.xml"
CASE_STUDY = ROOT / "examples" / "case_study" / "main.xml"


@pytest.fixture
def client() -> Iterator[Client]:
    with Client() as client:
        yield client


def _begin(client: Client, path: Path, step: int) -> None:
    client.begin(path, seed=3)
    _go(client, step)


def _go(client: Client, step: int) -> None:
    client.ask("goToStep", step=step)
    client.event("stopped")


def test_the_timeline_follows_the_run(client: Client) -> None:
    _begin(client, BUG, 200)
    shown = client.ask("timeline", width=800, names=True)
    # The next step is known, too.
    assert (shown["step"], shown["steps"], shown["from"], shown["hasTime"]) == (200, 201, 0, True)
    assert 3 < shown["cursor"] <= shown["to"] == shown["extent"]
    assert "Arm.way" in shown["names"]
    assert ">moving<" in shown["scene"]
    _go(client, 50)
    assert 'class="coarse"' in client.ask("timeline", width=60, coarse=True)["scene"]
    assert 'class="coarse"' not in client.ask("timeline", width=60)["scene"]
    steps = client.ask("timeline", axis="steps", **{"from": 40, "to": 60})
    assert (steps["step"], steps["steps"], steps["cursor"], steps["extent"]) == (50, 201, 50, 201)
    assert "names" not in steps
    assert 'data-step="42"' in steps["scene"]
    for wrong in ({"width": 0}, {"width": 1e9}, {"from": 5, "to": 4}, {"from": "a"}):
        assert client.refusal("timeline", **wrong)


def test_a_stretch_is_exported(client: Client) -> None:
    _begin(client, BUG, 200)
    stretch: dict[str, Any] = {"axis": "steps", "from": 90, "to": 130}
    rows = client.ask("exportTimeline", format="csv", **stretch)["text"].splitlines()
    assert [row.split(",")[0] for row in rows] == ["step", *map(str, range(90, 131))]
    mermaid = client.ask("exportTimeline", format="mermaid", **stretch)["text"]
    assert mermaid.startswith("sequenceDiagram")
    assert "/arm/command (data#58; 2)" in mermaid
    assert "/arm/command (data#58; 1)" not in mermaid
    svg = ET.fromstring(client.ask("exportTimeline", format="svg", theme="dark", **stretch)["text"])
    assert {"Arm", "moving"} <= {text.text for text in svg.iter("{http://www.w3.org/2000/svg}text")}
    assert client.refusal("exportTimeline", format="pdf")
    assert client.step() == 200


def test_pictures_follow_the_run(client: Client) -> None:
    analysis = api.load(str(BUG)).analysis
    _begin(client, BUG, 42)
    activity = client.ask("pictures")
    looks = {(node["kind"], node["source"]["name"], node["node"]): node["look"] for node in activity["nodes"]}
    # The command to the arm has been sent; the arm is the next to act, and the node of the tree is running.
    assert looks["machine", "arm.ascxml", "/still"] == "next"
    assert looks["system", "main_with_bug.xml", f"{ROBOT / 'arm.ascxml'}#/still"] == "next"
    assert looks["tree", "main_with_bug.xml", "1003"] == "running"
    assert looks["tree", "main_with_bug.xml", "1007"] == "idle"
    (topic,) = (node["node"] for node in activity["nodes"] if node["kind"] == "ros")
    drawn = picture_of(DiagramKind.ROS, analysis, str(BUG))
    assert drawn is not None
    labels = {node.id: node.label for node in drawn.nodes}
    assert labels[topic] == "/arm/command"
    edges = [(labels[edge["from"]], labels[edge["to"]]) for edge in activity["edges"]]
    assert edges == [("PickUp", "/arm/command"), ("/arm/command", "Arm")]
    assert {(edge["from"], edge["to"]) for edge in activity["edges"]} <= {
        (edge.source, edge.target) for edge in drawn.edges
    }


def test_all_active_parts_are_in_the_pictures(client: Client) -> None:
    analysis = api.load(str(CASE_STUDY)).analysis
    ids: dict[tuple[str, str], set[str]] = {}
    looks = set()
    _begin(client, CASE_STUDY, 0)
    for step in range(0, 400, 7):
        _go(client, step)
        activity = client.ask("pictures")
        for node in activity["nodes"]:
            kind, path = node["kind"], node["source"]["path"]
            if (kind, path) not in ids:
                picture = picture_of(DiagramKind(kind), analysis, path)
                assert picture is not None
                ids[kind, path] = {drawn.id for drawn in picture.nodes}
            assert node["node"] in ids[kind, path], (step, node)
            looks.add(node["look"])
    assert {"active", "next", "message", "idle", "running"} <= looks
    assert {kind for kind, _ in ids} == {"machine", "tree", "ros", "system"}
