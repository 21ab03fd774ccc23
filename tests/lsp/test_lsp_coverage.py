# SPDX-License-Identifier: Apache-2.0
"""`as2fm/coverage`: what the traces of a verification have executed of a picture."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from client import Client, connect
from lsprotocol import types
from test_lsp_verify import EXAMPLE, QUICK, ask, verify

from as2fm_lsp.handlers.coverage import METHOD
from as2fm_lsp.handlers.pictures import METHOD as PICTURE

FETCH = Path(__file__).parents[2] / "examples" / "fetch_tree"
BUG = "main_with_bug.xml"


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    shutil.copytree(EXAMPLE, tmp_path / "robot")
    return tmp_path / "robot"


async def covered(client: Client, path: Path, kind: str) -> tuple[Any, Any]:
    """The picture of a file, and its coverage."""
    params = {"textDocument": {"uri": path.as_uri()}, "kind": kind, "collapsed": []}
    return await ask(client, PICTURE, params), await ask(client, METHOD, params)


def edges(picture: Any, coverage: Any) -> dict[str, int]:
    """The labels of the edges -> the traces."""
    pairs = zip(picture["edges"], coverage["edges"], strict=True)
    return {" ".join(edge["labels"]): traces for edge, traces in pairs}


def statuses(picture: Any, coverage: Any) -> dict[str, Any]:
    pairs = zip(picture["nodes"], coverage["nodes"], strict=True)
    return {node["label"]: None if row is None else set(row["statuses"]) for node, row in pairs}


async def test_transitions_that_no_trace_takes_have_no_traces(robot: Path) -> None:
    plugin = robot / "plugins" / "holds_block.ascxml"
    async with connect(robot) as client:
        assert (await covered(client, plugin, "machine"))[1] is None
        await verify(client, robot / BUG, [], QUICK)
        picture, coverage = await covered(client, plugin, "machine")
    assert coverage["system"] == (robot / BUG).as_uri()
    taken = edges(picture, coverage)
    # The condition is ticked only while the arm holds the block: the tree looks too early.
    assert taken["tick [holding] / return SUCCESS"] == coverage["traces"] > 0
    assert taken["tick [else] / return FAILURE"] == 0
    assert [node["traces"] for node in coverage["nodes"]] == [coverage["traces"]]


async def test_nodes_have_the_statuses_that_they_returned(robot: Path) -> None:
    async with connect(robot) as client:
        await verify(client, robot / BUG, [], QUICK)
        with_bug = await covered(client, robot / BUG, "tree")
        await verify(client, robot / "main.xml", [], QUICK)
        without = await covered(client, robot / "main.xml", "tree")
        system = await covered(client, robot / "main.xml", "system")
    assert statuses(*with_bug)["HoldsBlock"] == {"SUCCESS"}
    assert statuses(*without)["HoldsBlock"] == {"SUCCESS", "FAILURE"}
    by_chance = [n for n, edge in enumerate(system[0]["edges"]) if edge["probabilistic"]]
    dropped, kept = (system[1]["edges"][number] for number in by_chance)
    assert 0 < dropped <= system[1]["traces"]
    assert 0 < kept <= system[1]["traces"]


async def test_the_coverage_of_changed_files_is_stale(robot: Path) -> None:
    arm = robot / "arm.ascxml"
    text = arm.read_text(encoding="utf-8")
    async with connect(robot) as client:
        await verify(client, robot / BUG, ["block_placed"], QUICK)
        document = types.TextDocumentItem(arm.as_uri(), "ascxml", 1, text.replace("way == 1", "way == 2"))
        client.text_document_did_open(types.DidOpenTextDocumentParams(document))
        _, coverage = await covered(client, arm, "machine")
        assert coverage["isStale"]
        assert coverage["nodes"] == []
        change = types.TextDocumentContentChangeWholeDocument(text)
        changed = types.VersionedTextDocumentIdentifier(2, arm.as_uri())
        client.text_document_did_change(types.DidChangeTextDocumentParams(changed, [change]))
        _, coverage = await covered(client, arm, "machine")
        assert not coverage["isStale"]
        assert coverage["traces"] > 0


async def test_a_tree_without_a_system_has_coverage(tmp_path: Path) -> None:
    shutil.copytree(FETCH, tmp_path / "fetch")
    tree = tmp_path / "fetch" / "fetch.xml"
    async with connect(tmp_path) as client:
        await verify(client, tree, [], QUICK)
        picture, coverage = await covered(client, tree, "tree")
    leaves = [
        row
        for node, row in zip(picture["nodes"], coverage["nodes"], strict=True)
        if node["kind"] in ("action", "condition")
    ]
    assert leaves
    assert all(row["traces"] > 0 and row["statuses"] for row in leaves)
    assert max(row["traces"] for row in leaves) == coverage["traces"]
